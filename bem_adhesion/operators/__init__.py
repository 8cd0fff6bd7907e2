"""Elastic operators on a grid: periodic by Fourier transforms, free boundaries by padded convolution, and loads."""
