"""The study file: read, checked and expanded into cases. A case is one parameter set in SI units."""
