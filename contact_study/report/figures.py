"""The figures of one comparison with their captions: states are chosen, read and drawn by ``contact_study.plots``."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from operator import attrgetter
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from contact_study import plots
from contact_study.plots import panels as composed
from contact_study.plots.panels import STATE_COLOURS, Panel, panels_figure, saved
from contact_study.plots.paths import Curve
from contact_study.plots.style import COLOURS, length_unit, pressure_unit
from contact_study.report.align import curves, states
from contact_study.report.align.cases import Scales, scales, sweep_points
from contact_study.report.facts import shown_states
from contact_study.report.facts.overview import cycles
from contact_study.report.facts.shown_states import PanelPoints, common_label, panel_points, point_label, state_label
from contact_study.report.models import entry_of
from contact_study.report.read.datasets import Inputs, Scatter

_ROW = 3  # states in compression from which a curve is worth logarithmic axes
_DENSITIES = {
    "pressure": ("stress_distribution", r"stress $\sigma", r"P(\sigma)"),
    "gap": ("gap_distribution", r"gap $u", "P(u)"),
}


@dataclass(frozen=True)
class Figures:
    """Figures of a report by name."""

    pages: dict[str, list[str]] = field(default_factory=dict)  # SVG: in physical and reduced units, or for both
    captions: dict[str, str] = field(default_factory=dict)
    files: dict[str, dict[str, bytes]] = field(default_factory=dict)  # by format


def draw(
    inputs: Inputs,
    wanted: float | None = None,
    formats: Sequence[str] = (),
    scatter: Scatter | None = None,
    page: bool = True,
) -> Figures:
    """Draw every figure that these datasets allow; theories are shown with the first spectrum of their study.

    The whole sweep is shown at the pressure of the path nearest to the one ``wanted`` (Pa). Files have contact areas in
    physical units, all else in reduced ones; elements of a page are drawn beside them if there is one.
    """
    inputs = inputs.with_first_spectra
    models, control = inputs.models, inputs.control
    shown, sample = panel_points(models, wanted), _first_sample(inputs)
    state = state_label(shown.case, point_label(shown.common, scales(models, shown.case), control))
    place = inputs, shown.case, shown.common, sample
    drawn: dict[str, list[Figure]] = {}
    for quantity, (name, *_) in _DENSITIES.items():
        panels = [_density_panels(inputs, shown, quantity, reduced) for reduced in (False, True)]
        if any(panel.curves for panel in panels[0]):
            drawn[name] = [panels_figure(own) for own in panels]
    drawn["contact_area"] = [_areas(inputs, scatter, reduced) for reduced in (False, True)]
    if any("mean_gap" in dataset and dataset["mean_gap"].notnull().any() for dataset in models.values()):
        drawn["mean_gap"] = [_gaps(inputs, scatter, reduced) for reduced in (False, True)]
    if maps := states.read_gaps(*place):
        drawn["gap_map"] = [composed.gap_maps({entry_of(name).label: own for name, own in maps.items()}, state)]
        if (interface := states.read_interface(*place)) is not None:
            drawn["interface"] = [composed.interface(interface, state)]
    if (zoomed := states.read_magnification(*place)) is not None:
        named = common_label(models, shown.common, control), shown.case.label
        drawn["magnification"] = [composed.magnification(*zoomed, *named)]
    if (atoms := states.read_atoms(*place)) is not None:
        drawn["atoms"] = [composed.wide(plots.atoms, atoms, 2.2, state)]
    if found := cycles(inputs):
        drawn["loop"] = [composed.loops(found)]
    if (probed := _probed(inputs, shown)) is not None:
        drawn["force"] = [composed.wide(plots.force_curve, probed, 3.2)]
    if (leaking := _first_of(inputs, shown, "hydraulic_gap_x")) is not None:
        drawn["leakage"] = [composed.wide(plots.leakage, leaking, 3.2)]
    theory = next((own for own in models.values() if "persson_tosatti_ratio" in own), None)
    if theory is not None and np.isfinite(theory["finest_tabor_number"]).any():
        drawn["criteria"] = [composed.wide(plots.criteria_map, theory, 3.2)]
    across = curves.pressure_axis(models, False)
    banded = {band.look.label for band in curves.path_bands(inputs.branches, models, across, curves.AREA)}
    files = {
        kind: {name: saved(own[0 if name == "contact_area" else -1], kind) for name, own in drawn.items()}
        for kind in formats
    }
    pages = {
        name: [saved(figure, "page", f"{name}{number}").decode() for number, figure in enumerate(own)]
        for name, own in (drawn if page else {}).items()
    }
    return Figures(pages, shown_states.captions(inputs, shown, sample, banded, scatter), files)


def _probed(inputs: Inputs, shown: PanelPoints) -> xr.Dataset | None:
    """Return the first simulation with a displacement of a body of finite extent or under a prescribed approach."""
    free = inputs.study.cases[0].elasticity.boundary != "periodic" or inputs.control == "approach"
    return _first_of(inputs, shown, "displacement") if free else None


def _first_of(inputs: Inputs, shown: PanelPoints, quantity: str) -> xr.Dataset | None:
    """Return the first simulation with a quantity: one sample; of many points of the sweep the one that is shown."""
    known = (inputs.models[name] for name in inputs.simulations)
    found = next((own for own in known if np.isfinite(own.get(quantity, np.nan)).any()), None)
    if found is None:
        return None
    if inputs.average in found.dims:
        found = found.isel({inputs.average: 0})
    many = len(sweep_points(inputs.models)) > len(COLOURS)
    return found.sel({key: value for key, value in shown.case.selection.items() if many and key in found.dims})


def _areas(inputs: Inputs, scatter: Scatter | None, reduced: bool) -> Figure:
    """Contact area against mean pressure, linear and logarithmic; no second panel without compression."""
    across = curves.pressure_axis(inputs.models, reduced)
    made = curves.path_curves(inputs.models, across, curves.AREA)
    pressed = (np.log10(curve.x[(curve.x > 0) & (curve.y > 0)]) for curve in made)
    compressed = any(np.unique(logarithms.round(4)).size >= _ROW for logarithms in pressed)
    panels = _panels(inputs, scatter, made, (across, curves.AREA), ("linear", "loglog")[: 1 + compressed])
    differ = len({law.counts_as_contact for law in inputs.laws}) > 1
    meanings = "; ".join(f"{law.title}: {law.counts_as_contact}" for law in inputs.laws)
    return panels_figure(panels, _strip_words(scatter), f"contact by {meanings}" if differ else "", height=4.2)


def _gaps(inputs: Inputs, scatter: Scatter | None, reduced: bool) -> Figure:
    """Pressure against mean gap: logarithmic where there is compression, linear where there is tension."""
    across, up = curves.gap_axis(inputs.models, reduced), curves.pressure_axis(inputs.models, reduced)
    made = curves.path_curves(inputs.models, across, up)
    kinds = ["log"] if any((curve.y[curve.finite] > 0).sum() >= _ROW for curve in made) else []
    if not kinds or any((curve.y[curve.finite] < 0).any() for curve in made):
        kinds.append("linear")
    panels = _panels(inputs, scatter, made, (across, up), kinds, upright=True)
    return panels_figure(panels, _strip_words(scatter), height=3.9)


def _panels(
    inputs: Inputs,
    scatter: Scatter | None,
    made: list[Curve],
    axes: tuple[curves.Axis, curves.Axis],
    kinds: Sequence[str],
    upright: bool = False,
) -> list[Panel]:
    """Curves over their bands and strips on several kinds of axes."""
    bands = curves.path_bands(inputs.branches, inputs.models, *(axes[::-1] if upright else axes))
    strips = curves.scatter_strips(inputs.models, scatter, *axes) if scatter else []
    across, up = axes
    return [Panel(made, across.label, up.label, kind, bands=bands, strips=strips, upright=upright) for kind in kinds]


def _strip_words(scatter: Scatter | None) -> str:
    return f"{entry_of(scatter.model).label}, {scatter.surfaces} surfaces" if scatter else ""


def _density_panels(inputs: Inputs, shown: PanelPoints, quantity: str, reduced: bool) -> list[Panel]:
    """Distributions over the sweep (a) and over the path of one of its points (b)."""
    models, control = inputs.models, inputs.control
    scale = scales(models, shown.case)
    _, symbol, density = _DENSITIES[quantity]
    if quantity == "pressure":
        unit, reference, own = pressure_unit(0.1 * scale.contact_modulus), "E^*", attrgetter("contact_modulus")
    else:
        unit, reference, own = length_unit(scale.rms_height), r"h_\mathrm{rms}", attrgetter("rms_height")
    unit_of: Callable[[Scales], float] = lambda scale: unit.size  # noqa: E731
    labels = f"{symbol}$ ({unit.name})", f"density ${density}$ (1/{unit.name})"
    if reduced and (scale.rough or quantity == "pressure"):
        labels = f"{symbol}/{reference}$", rf"density ${density}\,{reference}$"
        unit_of = own
    over_sweep = [(point, shown.common, point.label) for point in sweep_points(models)]
    over_path = [(shown.case, named, point_label(named, scale, control, reduced)) for named in shown.several]
    headings = common_label(models, shown.common, control, reduced), shown.case.label
    shows = (over_sweep, headings[0], COLOURS), (over_path, headings[1], STATE_COLOURS)
    panels = []
    for which, heading, colours in shows:
        made = curves.distributions(models, quantity, which, unit_of)
        panels.append(Panel(made, *labels, "log", heading, densities=True, colours=colours))
    return panels


def _first_sample(inputs: Inputs) -> Any:
    """The first seed, or value of what else is averaged over, that all models have which sweep it; None without."""
    name = inputs.average
    swept = [dataset[name].values.tolist() for dataset in inputs.models.values() if name in dataset.dims]
    return next((value for value in swept[0] if all(value in other for other in swept)), None) if swept else None
