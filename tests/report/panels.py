"""Curves and panels of figures as the report puts them together."""

import html
import re

from contact_study.plots.panels import Panel, panels_figure
from contact_study.report.align import curves
from contact_study.report.align.cases import scales, sweep_points
from contact_study.report.align.curves import AREA, gap_axis, pressure_axis
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


def reported(folder, *paths, options=()):
    """Exit status and words of the report."""
    status = run(*paths, "-o", folder / "out.nc", "--report", folder / "report.html", *options)
    return status, text_of((folder / "report.html").read_text(encoding="utf-8"))


def area_curves(models, reduced=False):
    return curves.path_curves(models, pressure_axis(models, reduced), AREA)


def gap_curves(models, reduced=True):
    return curves.path_curves(models, gap_axis(models, reduced), pressure_axis(models, reduced))


def bands(inputs, quantity=None):
    """Of areas in physical units, or of mean gaps in reduced ones."""
    along = pressure_axis(inputs.models, quantity == "gap")
    return curves.path_bands(
        inputs.branches, inputs.models, along, gap_axis(inputs.models, True) if quantity == "gap" else AREA
    )


def density_curves(name, models, shown):
    """Curves of both panels of a figure of distributions, in reduced units."""
    scale = scales(models, shown.case)
    over_sweep = [(point, shown.common, point.label) for point in sweep_points(models)]
    over_path = [(shown.case, named, point_label(named, scale, "pressure", True)) for named in shown.several]

    def unit_of(scale):
        return scale.contact_modulus if name == "pressure" else scale.rms_height

    return tuple(curves.distributions(models, name, states, unit_of) for states in (over_sweep, over_path))


def one(found, model, colour):
    (own,) = [curve for curve in found if (curve.model, curve.colour) == (model, colour)]
    return own


def figure_of(made, kind="linear", **options):
    return panels_figure([Panel(made, "x", "y", kind, **options)])


def at(shown, sample=None):
    """The state common to the figures, as arguments."""
    return shown.case, shown.common, sample
