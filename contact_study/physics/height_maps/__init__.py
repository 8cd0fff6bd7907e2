"""Height maps of instruments: formats, units, grids and preparation; what a map becomes is in ``surfaces``."""
