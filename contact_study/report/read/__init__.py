"""Datasets of the models as their files hold them, with the studies that they carry."""
