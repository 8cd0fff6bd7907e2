"""Boundary elements for a campaign: checks of a study, and the states along its loading path.

The contacts themselves are in :mod:`bem_adhesion.contacts`.
"""
