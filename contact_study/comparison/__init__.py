"""Datasets in, answers out: deviations, figures and report."""
