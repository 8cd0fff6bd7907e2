"""Merge of datasets of parts of one study into the dataset of the whole study.

The merged file equals that of one run bit for bit, but for wall times and attributes of origin; no case runs here.
"""
