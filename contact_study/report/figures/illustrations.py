"""The figures of one comparison with their captions: states are chosen, read and drawn."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from contact_study.report.align.cases import sweep_points
from contact_study.report.align.curves import distributions, path_bands, path_curves, scatter_strips
from contact_study.report.align.scales import mean_pressure_unit, scales
from contact_study.report.align.states import read_atoms, read_gaps, read_interface, read_magnification
from contact_study.report.facts.captions import captions
from contact_study.report.facts.shown_states import common_label, panel_points, point_label, state_label
from contact_study.report.figures import panels, states
from contact_study.report.figures.style import png, saved
from contact_study.report.read.datasets import Inputs
from contact_study.report.read.scatter import Scatter


@dataclass(frozen=True)
class Figures:
    """Figures as PNG files with their captions, by name, and as files of other formats, by format and name."""

    images: dict[str, bytes] = field(default_factory=dict)
    captions: dict[str, str] = field(default_factory=dict)
    others: dict[str, dict[str, bytes]] = field(default_factory=dict)

    def files(self, kind: str) -> dict[str, bytes]:
        """The files of one format."""
        return self.images if kind == "png" else self.others.get(kind, {})


def draw(
    inputs: Inputs, wanted: float | None = None, formats: Sequence[str] = (), scatter: Scatter | None = None
) -> Figures:
    """Draw every figure that these datasets allow; theories are shown with the first spectrum of their study.

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
    shown = panel_points(models, control, wanted)
    scale, pressure = scales(models, shown.case), mean_pressure_unit(models)
    curves, bands = path_curves(models, control), path_bands(inputs.branches, models)
    strips = None if scatter is None else scatter_strips(models, scatter, control)
    headings = common_label(models, shown.common, control), shown.case.label
    over_sweep = [(point, shown.common, point.label) for point in sweep_points(models)]
    over_path = [(shown.case, named, point_label(named, scale, control)) for named in shown.several]
    drawn = {}
    stresses, gaps = (
        (distributions(models, control, name, over_sweep), distributions(models, control, name, over_path))
        for name in ("pressure", "gap")
    )
    if any(stresses):
        drawn["stress_distribution"] = panels.stress_distribution_figure(*stresses, headings)
    if any(gaps):
        drawn["gap_distribution"] = panels.gap_distribution_figure(*gaps, scale.height_symbol, headings)
    drawn["contact_area"] = panels.contact_area_figure(curves, pressure.name, bands, strips)
    if curves.gap_panels:
        drawn["mean_gap"] = panels.mean_gap_figure(curves, scale.height_symbol, bands, strips)
    state = state_label(shown.case, point_label(shown.common, scale, control))
    place = inputs, shown.case, shown.common, (sample := _first_sample(inputs))
    if maps := read_gaps(*place):
        drawn["gap_map"] = states.gap_map_figure(maps, state)
        interface = read_interface(*place)
        if interface is not None:
            drawn["interface"] = states.interface_figure(interface, state)
    zoomed = read_magnification(*place)
    if zoomed is not None:
        drawn["magnification"] = states.magnification_figure(*zoomed, *headings)
    atoms = read_atoms(*place)
    if atoms is not None:
        drawn["atoms"] = states.atoms_figure(atoms, state)
    words = captions(inputs, shown, curves, sample, bands.models, strips)
    others = {kind: {name: saved(figure, kind) for name, figure in drawn.items()} for kind in formats if kind != "png"}
    return Figures({name: png(figure) for name, figure in drawn.items()}, words, others)


def _first_sample(inputs: Inputs) -> Any:
    """The first seed, or value of what else is averaged over, that all models have which sweep it; None without."""
    name = inputs.average
    swept = [dataset[name].values.tolist() for dataset in inputs.models.values() if name in dataset.dims]
    return next((value for value in swept[0] if all(value in other for other in swept)), None) if swept else None
