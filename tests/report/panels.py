"""Curves and panels of figures as the report puts them together."""

import html
import re

from contact_study.plots.panels import Panel, panels_figure
from contact_study.report.align.cases import sweep_points
from contact_study.report.align.curves import (
    AREA,
    distributions,
    gap_axis,
    path_bands,
    path_curves,
    pressure_axis,
    scatter_strips,
)
from contact_study.report.align.scales import scales
from contact_study.report.facts.shown_states import point_label
from contact_study.start import contact_compare


def run(*arguments):
    """Exit status of the command."""
    return contact_compare([str(argument) for argument in arguments])


def text_of(page):
    """Words of a page in physical units, without its style and script."""
    body = page[page.index("<main>") : page.index("<script>\n")]
    body = re.sub(r'<span class="rd">.*?</span>', "", re.sub(r"<su([bp])>(.*?)</su\1>", r"\2", body))
    body = re.sub(r"<svg.*?</svg>", "", body, flags=re.DOTALL)
    return re.sub(r"\s+", " ", html.unescape(re.sub(r"<[^>]+>", "", body)).replace("\u00a0", " "))


def area_curves(models, control="pressure", reduced=False):
    return path_curves(models, control, pressure_axis(models, reduced), AREA)


def gap_curves(models, control="pressure", reduced=True):
    return path_curves(models, control, gap_axis(models, reduced), pressure_axis(models, reduced))


def area_bands(inputs, reduced=False):
    return path_bands(inputs.branches, inputs.models, pressure_axis(inputs.models, reduced), AREA)


def gap_bands(inputs, reduced=True):
    axes = pressure_axis(inputs.models, reduced), gap_axis(inputs.models, reduced)
    return path_bands(inputs.branches, inputs.models, *axes)


def area_strips(models, scatter):
    return scatter_strips(models, scatter, "pressure", pressure_axis(models, False), AREA)


def density_curves(name, models, control, shown, reduced=True):
    """Curves of both panels of a figure of distributions, in reduced units."""
    over_sweep = [(point, shown.common, point.label) for point in sweep_points(models)]
    unit = scales(models, shown.case)
    over_path = [(shown.case, named, point_label(named, unit, control, reduced)) for named in shown.several]

    def unit_of(scale):
        return scale.contact_modulus if name == "pressure" else scale.rms_height

    return tuple(distributions(models, control, name, states, unit_of) for states in (over_sweep, over_path))


def figure_of(curves, kind="linear", **options):
    return panels_figure([Panel(curves, "x", "y", kind, **options)])


def at(shown, sample=None):
    """The state common to the figures, as arguments."""
    return shown.case, shown.common, sample
