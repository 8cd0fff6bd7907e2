"""Persson's theory without adhesion: closed forms, corrections of its diffusion, distribution of the gap.

Adhesion is in :mod:`theory.persson`.
"""
