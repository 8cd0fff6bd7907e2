"""The dataset of a study: assembly, attributes, file, restart states, and what is read from it or exported.

Files of a running campaign are in :mod:`contact_study.campaign.store`.
"""
