"""Adhesive contact by Newton's method over several grids: energy, descent, corrections in subdomains, predictions.

Free boundaries, time and friction are added in :mod:`bem_adhesion.contacts`; linear solves are in
:mod:`bem_adhesion.linear`.
"""
