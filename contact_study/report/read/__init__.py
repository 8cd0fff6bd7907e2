"""Datasets of the models as their files hold them, with the studies that they carry.

What several datasets have in common is found in ``align``.
"""
