"""The theories along the loading path of a case, as a campaign runs them, and the command ``persson-theory``.

The theories themselves, which take spectra and pressures and no study, are in the other folders.
"""
