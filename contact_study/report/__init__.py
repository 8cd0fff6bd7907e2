"""Datasets in, answers out: deviations, figures and report.

Data flows ``read`` → ``align`` → ``facts`` → ``figures`` and ``tables`` → ``page``; ``comparison`` puts together what
the command writes.
"""
