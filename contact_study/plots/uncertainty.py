"""Uncertain answers: bands along the loading path, and what each uncertain key does to them."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from contact_study.plots import style
from contact_study.plots.selection import UNLOADING
from contact_study.plots.style import COLOURS, DOUBLE, SINGLE, Unit, styled
from contact_study.results.uncertainty import ANSWERS, uncertainty

_WORDS = {
    "relative_contact_area": "contact area $A/A_0$",
    "mean_gap": r"mean gap $\bar{u}$",
    "mean_pressure": "pressure $p$",
    "pull_off_pressure": "pull-off pressure",
    "work_of_separation": "work of separation",
}
_LOADS = {"applied_pressure": "pressure $p$", "applied_gap": r"mean gap $\bar{u}$", "applied_approach": "approach"}
_SHOWN = 8  # keys of a panel


@styled
def tornado(dataset: xr.Dataset) -> Figure:
    """Draw what each uncertain key does to each answer, the key with the largest share of the variance on top.

    A bar extends from the answer with the key at 5 % of its distribution to that at 95 %, the other keys at their
    medians; beside it is the key's share of the variance. Answers along a path are those of the largest contact area.

    Parameters
    ----------
    dataset : xarray.Dataset
        Dataset of a run of a study with ``[uncertainty]``, or of :func:`contact_study.uncertainty`; the first of
        several theories is shown.

    Returns
    -------
    matplotlib.figure.Figure
        A new figure.

    Raises
    ------
    ValueError
        If the dataset has no draws, or its draws determine no shares.

    Examples
    --------
    >>> from contact_study import plots
    >>> plots.tornado(contact_study.run("study.toml", "theory"))  # doctest: +SKIP
    """
    shown = _one_line(_answers(dataset))
    if "step" in shown.dims:
        shown = shown.isel(step=_fullest(shown))
    names = [name for name in ANSWERS if f"{name}_swing" in shown and np.isfinite(shown[f"{name}_swing"]).any()]
    if not names:
        raise ValueError("the draws determine no shares: give more uncertainty.draws")
    rows = (len(names) + 1) // 2 if len(names) > 1 else 1
    height = 0.3 + rows * (0.75 + 0.24 * min(shown.sizes["parameter"], _SHOWN))
    figure = Figure(figsize=(SINGLE if len(names) == 1 else DOUBLE, height), layout="constrained")
    every = np.atleast_1d(figure.subplots(rows, 2 if len(names) > 1 else 1)).ravel()
    for axes, name in zip(every, names, strict=False):
        _draw(axes, shown, name)
    for axes in every[len(names) :]:
        axes.set_axis_off()
    looks = ((COLOURS[5], "key at 5 %"), (COLOURS[0], "key at 95 %"), ("#eeeeee", "5 to 95 % of all draws"))
    handles = [Patch(color=colour, label=label) for colour, label in looks]
    figure.legend(handles=handles, loc="outside upper center", ncols=1 if len(names) == 1 else 3)
    return figure


def bands(dataset: xr.Dataset, axes: Axes, name: str) -> Axes:
    """Draw median and 5 to 95 % of an answer along the loading path, a colour for each branch and theory."""
    found = _answers(dataset)
    load = next((load for load in _LOADS if load in found.coords), None)
    if load is None or name not in found:
        raise ValueError(f"the dataset has no {name} against a load")
    others = [dim for dim in found[name].dims if dim not in ("quantile", "step")]
    stacked = found[[name]].stack(line=others) if others else found[[name]].expand_dims(line=[""])
    x_unit, unit = _unit_of(load, found[load].values), _unit_of(name, found[name].values)
    back = found["branch"].values == UNLOADING if "branch" in found else np.zeros(found.sizes["step"], bool)
    number = 0
    for line in stacked["line"].values:
        words = [str(part).replace("_", " ") for part in np.atleast_1d(np.array(line, dtype=object)) if str(part)]
        for own, branch in ((~back, ""), (back, "unloading")):
            if not own.any():
                continue
            values = stacked[name].sel(line=line).transpose("quantile", "step").values[:, own] / unit.size
            x = np.asarray(found[load].values)[own] / x_unit.size
            colour, label = COLOURS[number % len(COLOURS)], ", ".join([*words, *([branch] if branch else [])])
            axes.fill_between(x, values[0], values[-1], color=colour, alpha=0.2, lw=0)
            axes.plot(x, values[1], "v--" if branch else "o-", color=colour, ms=3, label=label or "median, 5 to 95 %")
            number += 1
    style.add_legend(axes)
    ylabel = f"{_WORDS[name]} ({unit.name})" if unit.name else _WORDS[name]
    axes.set(xlabel=f"{_LOADS[load]} ({x_unit.name})", ylabel=ylabel)
    return axes


def _answers(dataset: xr.Dataset) -> xr.Dataset:
    return dataset if "quantile" in dataset.dims else uncertainty(dataset)


def _one_line(found: xr.Dataset) -> xr.Dataset:
    others = [dim for dim in found.dims if dim not in ("quantile", "parameter", "end", "step")]
    return found.isel(dict.fromkeys(others, 0))


def _fullest(found: xr.Dataset) -> int:
    """Step of the largest median contact area."""
    area = (
        found["relative_contact_area"].sel(quantile=0.5).values if "relative_contact_area" in found else np.array([0])
    )
    return int(np.nanargmax(area)) if np.isfinite(area).any() else -1


def _draw(axes: Axes, shown: xr.Dataset, name: str) -> None:
    share, swing = shown[f"{name}_share"].values, shown[f"{name}_swing"].values
    reach = np.abs(swing[:, -1] - swing[:, 0])
    order = np.argsort(np.where(np.isfinite(share), share, reach / (reach.max() or 1)))[-_SHOWN:]
    low, _, high = shown[name].values
    unit = _unit_of(name, shown[name].values)
    axes.axvspan(low / unit.size, high / unit.size, color="#eeeeee", lw=0, zorder=0)
    for place, at in enumerate(order):
        middle = swing[at, 1] / unit.size
        for end, colour in ((0, COLOURS[5]), (2, COLOURS[0])):
            axes.barh(place, swing[at, end] / unit.size - middle, left=middle, height=0.6, color=colour, zorder=2)
        axes.plot([middle, middle], [place - 0.4, place + 0.4], color="#404040", lw=0.8, zorder=3)
    keys = [_words(str(shown["parameter"].values[at])) for at in order]
    shares = [f"  {100 * share[at]:.0f} %" if np.isfinite(share[at]) else "" for at in order]
    axes.set_yticks(range(len(order)), [f"{key}{part}" for key, part in zip(keys, shares, strict=True)])
    axes.grid(False, axis="y")
    axes.margins(y=0.04)
    axes.set_xlabel(f"{_WORDS[name]} ({unit.name})" if unit.name else _WORDS[name])


def _words(dotted: str) -> str:
    """A key for a label, with its section where the name alone says little."""
    section, _, name = dotted.partition(".")
    plain = name.replace("_", " ")
    for word in ("young", "poisson", "hurst"):
        plain = plain.replace(f"{word}s ", f"{word.title()}'s ").replace(f"{word} ", f"{word.title()} ")
    return plain if "_" in name else f"{section} {name}"


def _unit_of(name: str, values: Any) -> Unit:
    most = style.largest(values)
    if "pressure" in name:
        return style.pressure_unit(most)
    if name == "work_of_separation":
        return Unit("mJ/m²", 1e-3)
    return Unit("", 1.0) if name == "relative_contact_area" else style.length_unit(most)
