"""Inference: constants of a contact from measured force curves, by theories of a sphere or by simulated loops.

Measured curves go in, a dataset of estimates, intervals and residuals comes out. Drawing is in ``contact_study.plots``.
"""
