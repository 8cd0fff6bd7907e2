"""Persson's theory with adhesion, as Yang et al. 2008 used it: diffusion, fixed point, mean gap and pull-off.

What needs no adhesion is in :mod:`theory.non_adhesive`, what a loading path needs in :mod:`theory.study`.
"""
