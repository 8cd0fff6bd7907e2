"""Physics of contact from numbers in SI: laws, solids, surfaces and their spectra; no study files, no solvers."""
