"""Boundary elements for a campaign: checks of a study, and the states along its loading path."""
