"""The figures of one comparison with their captions: what is shown is chosen, read and drawn."""

from collections.abc import Sequence
from typing import Any

from contact_study.report.compute import bands, plotted
from contact_study.report.compute.atom_state import read_atoms
from contact_study.report.compute.cases import sweep_points
from contact_study.report.compute.curves import mean_gap_panels
from contact_study.report.compute.gap_maps import read_gap_maps
from contact_study.report.compute.interface_state import read_interface_state
from contact_study.report.compute.magnification import read_magnification
from contact_study.report.compute.scales import mean_pressure_unit, scales
from contact_study.report.compute.scatter import scatter_strips
from contact_study.report.compute.shown_states import common_label, panel_points, point_label, state_label
from contact_study.report.draw import figures
from contact_study.report.draw.atoms import atoms_figure
from contact_study.report.draw.gap_map import gap_map_figure
from contact_study.report.draw.interface import interface_figure
from contact_study.report.draw.magnification import magnification_figure
from contact_study.report.draw.style import png, saved
from contact_study.report.read.datasets import Inputs
from contact_study.report.read.scatter import Scatter
from contact_study.report.text.captions import captions
from contact_study.report.text.report import Figures


def draw(
    inputs: Inputs, wanted: float | None = None, formats: Sequence[str] = (), scatter: Scatter | None = None
) -> Figures:
    """Every figure that these datasets allow; theories are shown with the first spectrum of their study.

    Parameters
    ----------
    inputs : Inputs
        What is compared.
    wanted : float, optional
        Pressure (Pa) at which the whole sweep is shown; the nearest one of the path is taken.
    formats : sequence of str
        Formats besides PNG.
    scatter : Scatter, optional
        Realisations whose scatter is shown behind the models.
    """
    inputs = inputs.with_first_spectra
    models, control = inputs.models, inputs.control
    points = sweep_points(models)
    shown = panel_points(models, control, wanted)
    units = {point.label: scales(models, point) for point in points}
    scale, pressure = units[shown.case.label], mean_pressure_unit(models)
    curves = plotted.path_curves(models, control)
    strips = None if scatter is None else scatter_strips(models, scatter, control)
    area_bands = bands.contact_area_bands(inputs.branches, points, pressure.size)
    states = common_label(models, shown.common, control), shown.case.label
    drawn = {}
    stresses = plotted.stress_distribution_data(models, control, shown)
    if any(stresses):
        drawn["stress_distribution"] = figures.stress_distribution_figure(*stresses, states)
    distances = plotted.gap_distribution_data(models, control, shown)
    if any(distances):
        drawn["gap_distribution"] = figures.gap_distribution_figure(*distances, scale.height_symbol, states)
    drawn["contact_area"] = figures.contact_area_figure(curves.areas, pressure.name, area_bands, strips)
    logarithmic, linear = (bands.mean_gap_bands(inputs.branches, points, units, linear=it) for it in (False, True))
    if mean_gap_panels(curves.gaps, curves.linear_gaps):
        drawn["mean_gap"] = figures.mean_gap_figure(
            curves.gaps, curves.linear_gaps, scale.height_symbol, (logarithmic, linear), strips
        )
    seed = _first_sample(inputs)
    maps = read_gap_maps(inputs, shown, seed)
    if maps is not None:
        state = state_label(shown.case, point_label(shown.common, scale, control))
        drawn["gap_map"] = gap_map_figure(maps, state)
        interface = read_interface_state(inputs, shown, seed)
        if interface is not None:
            drawn["interface"] = interface_figure(interface, state)
    zoomed = read_magnification(inputs, shown, seed)
    if zoomed is not None:
        drawn["magnification"] = magnification_figure(*zoomed, *states)
    atoms = read_atoms(inputs, shown, seed)
    if atoms is not None:
        drawn["atoms"] = atoms_figure(atoms, state_label(shown.case, point_label(shown.common, scale, control)))
    banded = dict.fromkeys(band.model for found in (area_bands, logarithmic, linear) for band in found)
    words = captions(inputs, shown, curves, seed, list(banded), strips)
    others = {kind: {name: saved(figure, kind) for name, figure in drawn.items()} for kind in formats if kind != "png"}
    return Figures({name: png(figure) for name, figure in drawn.items()}, words, others)


def _first_sample(inputs: Inputs) -> Any:
    """The first seed, or value of what else is averaged over, that all models have which sweep it; None without."""
    name = inputs.average
    swept = [dataset[name].values.tolist() for dataset in inputs.models.values() if name in dataset.dims]
    return next((value for value in swept[0] if all(value in other for other in swept)), None) if swept else None
