"""Physics of contact: adhesive laws, elastic solids, rough surfaces and their spectra, height maps.

No study files and no solvers: classes here are made from numbers in SI.
"""
