"""Elastic solids on a grid: periodic by Fourier transforms, with free boundaries by padded convolution; and loads.

No law and no solver: what acts on the interface is in :mod:`bem_adhesion.kernels`.
"""
