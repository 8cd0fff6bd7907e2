"""Datasets in, answers out: deviations, figures and report.

Data flows ``read`` → ``compute`` → ``draw`` and ``say``; ``illustrations`` and ``tree`` put together what ``command``
writes. ``labels`` and ``wording`` are the words that all of them share.
"""
