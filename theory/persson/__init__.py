"""Persson's theory with adhesion, as Yang et al. 2008 used it: diffusion, fixed point, mean gap and pull-off."""
