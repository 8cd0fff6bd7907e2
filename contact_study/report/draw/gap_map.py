"""Figure 5: the gap fields of the simulations at one state."""

import matplotlib
from matplotlib.figure import Figure

from contact_study.plots.style import DOUBLE, SINGLE, styled
from contact_study.plots.units import length_unit
from contact_study.report.compute.gap_maps import GapMaps
from contact_study.report.draw.style import typeset
from contact_study.report.models import entry_of

_FRAME, _BAR = 0.75, 0.95  # inches around a map, and for the bar of colours


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
        axes.set_title(entry_of(model).label, fontsize=8.5)
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
