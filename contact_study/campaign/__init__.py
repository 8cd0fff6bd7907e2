"""Campaigns: a study is checked, its cases run, every step goes to disk, and one dataset is assembled.

The way of a study: run → resume → worker → store → dataset. Physics, solvers and figures are in other packages.
"""
