"""Datasets in, answers out: deviations, figures and report.

read
    ``datasets`` with ``carried_study`` and ``differences``; ``path_points`` and ``cases`` find a state again in each.
computed
    ``deviations``, ``regime``, ``scales``; ``shown_states``, ``plotted`` and ``bands`` for the figures.
drawn
    ``figures`` and ``gap_map`` with ``style`` and ``legends``, all in ``illustrations``.
said
    ``findings``, ``description``, ``captions`` and the tables with ``labels`` and ``wording``, all in ``report``.
"""
