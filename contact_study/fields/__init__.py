"""Numerics on a periodic grid: grid, Fourier transforms, roughness spectra and observables."""
