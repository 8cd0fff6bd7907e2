"""Numbers of all models on common states; conclusions are drawn in ``facts``."""
