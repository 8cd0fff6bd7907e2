"""Conclusions from the numbers, which tables, figures and text show."""
