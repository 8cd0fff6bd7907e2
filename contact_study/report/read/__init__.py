"""Datasets of the models as they stand in their files, with the studies that they carry.

What several datasets have in common is found in ``align``.
"""
