"""Statements of the report as objects: numbers, models and states, computed from the datasets.

No sentence is written here; the templates turn facts into text.
"""
