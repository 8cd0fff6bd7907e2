"""Gap-flow theory: roughness added scale by scale to the adhesive law."""
