"""Measured force curves: columns of text and files of instruments, as a dataset with the signs of the simulations."""
