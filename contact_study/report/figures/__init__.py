"""Figures of a comparison, composed of pictures that ``contact_study.plots`` draws.

Captions are facts and their templates.
"""
