"""Panels of figures as the report puts them together."""

from contact_study.report.align.cases import sweep_points
from contact_study.report.align.curves import PathCurves, distributions
from contact_study.report.align.scales import scales
from contact_study.report.facts.shown_states import point_label


def density_panels(name, models, control, shown):
    """Curves of both panels of a figure of distributions."""
    over_sweep = [(point, shown.common, point.label) for point in sweep_points(models)]
    unit = scales(models, shown.case)
    over_path = [(shown.case, named, point_label(named, unit, control)) for named in shown.several]
    return tuple(distributions(models, control, name, states) for states in (over_sweep, over_path))


def areas(curves):
    """Curves of contact area alone."""
    return PathCurves(list(curves), [], [])


def at(shown, sample=None):
    """The state common to the figures, as arguments."""
    return shown.case, shown.common, sample
