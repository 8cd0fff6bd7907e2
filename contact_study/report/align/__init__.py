"""Numbers of all models on common states: points of the sweep, means, deviations, regime numbers.

Nothing here is text or a picture; conclusions are drawn in ``facts``.
"""
