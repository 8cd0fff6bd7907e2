"""Figure 5: the gap fields of the simulations at one state, read one at a time from their files and drawn."""

from dataclasses import dataclass

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from contact_study.comparison.compute.cases import case_points, first_constant, select
from contact_study.comparison.compute.shown_states import PanelPoints
from contact_study.comparison.draw.style import DOUBLE, MODEL_NAMES, SINGLE, styled, typeset
from contact_study.comparison.read.datasets import Inputs, field_at
from contact_study.comparison.read.path_points import AVERAGED
from contact_study.comparison.wording import length_unit

_FRAME, _BAR = 0.75, 0.95  # inches around a map, and for the bar of colours


@dataclass(frozen=True)
class GapMaps:
    """Gap of each simulation that kept it, at one state.

    Attributes
    ----------
    gaps : dict
        Gap (y, x) of each model (m), masked where there is contact.
    size : tuple of float
        Lateral periods along y and x (m).
    contact_distance : float
        Where the colours of the gap begin (m): zero for a hard wall.
    """

    gaps: dict[str, np.ma.MaskedArray]
    size: tuple[float, float]
    contact_distance: float


def read_gap_maps(inputs: Inputs, shown: PanelPoints, seed: int | None) -> GapMaps | None:
    """The maps at the state common to the figures; None where no simulation kept its fields or is in contact."""
    hard_wall = not any(case.law.attracts for case in inputs.cases_at(shown.case.selection))
    distance = 0.0 if hard_wall else first_constant(inputs.models, shown.case, "contact_distance")
    gaps, size = {}, (0.0, 0.0)
    for model in ("atomistic", "continuum"):
        part = select(inputs.models[model], shown.case) if model in inputs.models else None
        if part is None or shown.common not in (path := case_points(part, inputs.control)):
            continue
        step = path.index(shown.common)
        selection = dict(shown.case.selection)
        if AVERAGED in part.dims:
            if seed is None:
                continue
            selection[AVERAGED] = seed
        # Smaller cells of a sweep are padded to the points of the largest.
        y, x = (part[axis].values[np.isfinite(part[axis].values)] for axis in ("y", "x"))
        stored = field_at(inputs.paths[model], "gap", selection, step)
        if stored is None or not np.isfinite(gap := stored[: y.size, : x.size]).all():
            continue
        pressure = field_at(inputs.paths[model], "pressure", selection, step) if hard_wall else None
        touching = gap <= distance if pressure is None else pressure[: y.size, : x.size] > 0
        gaps[model] = np.ma.masked_array(gap, touching)
        size = y.size * float(y[1] - y[0]), x.size * float(x[1] - x[0])
    return GapMaps(gaps, size, distance) if gaps else None


@styled
def gap_map_figure(maps: GapMaps, state: str = "") -> Figure:
    """Local gap of each simulation on one state, contact in black, at the true proportions of the cell."""
    rows, columns, width = _arrangement(len(maps.gaps), maps.size[0] / maps.size[1])
    height = width * maps.size[0] / maps.size[1]
    figure = Figure(
        figsize=(columns * width + _FRAME + _BAR, max(rows * (height + 0.25) + _FRAME, 2.2)), layout="constrained"
    )
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    across = length_unit(max(maps.size))
    along = length_unit(max(float(gap.data.max()) for gap in maps.gaps.values()))
    bottom = maps.contact_distance / along.size
    top = max(float(gap.data.max()) for gap in maps.gaps.values()) / along.size
    colours = matplotlib.colormaps["cividis"].with_extremes(under="black", bad="black")
    for axes, (model, gap) in zip(panels.ravel(), maps.gaps.items(), strict=True):
        image = axes.imshow(
            gap / along.size,
            origin="lower",
            extent=(0, maps.size[1] / across.size, 0, maps.size[0] / across.size),
            cmap=colours,
            vmin=bottom,
            vmax=top if top > bottom else bottom + 1,
            interpolation="nearest",
        )
        axes.set_title(MODEL_NAMES[model], fontsize=8.5)
        axes.grid(False)
    for axes in panels[-1]:
        axes.set_xlabel(rf"$x$ ({across.name})")
    for axes in panels[:, 0]:
        axes.set_ylabel(rf"$y$ ({across.name})")
    touching = any(gap.mask.any() for gap in maps.gaps.values())
    words = f"gap ({along.name})" + (", contact black" if touching else "")
    figure.colorbar(image, ax=panels, label=words, extend="min" if touching else "neither", aspect=25)
    if state:
        figure.suptitle(typeset(state), fontsize=8.5)
    return figure


def _arrangement(count: int, aspect: float) -> tuple[int, int, float]:
    """Rows and columns of the maps and the width of one (inches): side by side, wide cells above one another."""
    if count > 1 and aspect < 0.5:
        return count, 1, DOUBLE - _FRAME - _BAR
    across = DOUBLE if count > 1 else SINGLE + 1.2
    return 1, count, min((across - _FRAME - _BAR) / count, 5.5 / aspect)
