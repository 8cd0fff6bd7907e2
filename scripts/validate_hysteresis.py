"""Both branches of the edge flow against the jumping conditions of the contact atlas, as Markdown.

The edge flow unloads with Γ = 1 + k (x² − 1)₊ times the work of adhesion. Every other condition chose k, the rest
judge it.

python -m scripts.validate_hysteresis fit          # errors of the chosen half by k
python -m scripts.validate_hysteresis branches     # errors of all theories on the other half
python -m scripts.validate_hysteresis surfaces data/contact_atlas_surfaces.nc       # means of four surfaces
python -m scripts.validate_hysteresis means data/contact_atlas.nc                   # the whole design, by group
python -m scripts.validate_hysteresis loads data/contact_atlas.nc                   # the whole design, by load
python -m scripts.validate_hysteresis distributions data/contact_atlas_surfaces.nc  # of local gap and pressure
python -m scripts.validate_hysteresis branches --figure docs/images/edge_flow_branches.png
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from contact_study.atlas.collection import THEORIES, WAYS
from contact_study.atlas.design import JUMPING, LEAST_JUMP, Condition, design
from contact_study.atlas.loops import seeds_of
from contact_study.numerics.distributions import moments
from contact_study.plots.style import DOUBLE, styled
from scripts.atlas_tables import (
    AREA,
    DATA,
    GROUPS,
    HEAVIEST,
    LIGHTEST,
    MARKERS,
    NAMES,
    by_number,
    compared,
    deepest,
    read,
    stress_of,
)
from scripts.edge_flow_areas import areas_at, theory_input
from scripts.harness import FIGURE, Option, minus, program, save, show
from theory.edge_flow.apparent_adhesion import GROWTH, adhesion_ratio
from theory.edge_flow.flow import edge_flow

JUMPING_DATA = DATA.with_name("contact_atlas_jumping.nc")
GROWTHS = 0.0, 0.04, 0.06, GROWTH, 0.1, 0.12, 0.16
RATIOS = 1.0, 1.1, 1.25, 1.5, 1.9  # of the work of adhesion, between which areas are interpolated
LEAST, LARGEST = 0.02, 0.98  # areas that are compared
SHOWN_STATES = 3  # compared states on unloading of a condition in the figure
FAR_OFF = 0.1  # error of an area whose states are counted
STRONG = 0.5  # θ from which a surface of this size holds together by many asperities
PRESSURES = np.geomspace(LIGHTEST, HEAVIEST, 12)  # at which means of surfaces are compared, over E* h'/2
EVENTS = (  # of a loop, the theory's, and its branch; on loading its work of separation is that of the approach
    ("pull_off_pressure", "pull_off_pressure", "unloading"),
    ("work_of_approach", "work_of_separation", "loading"),
    ("work_of_separation", "work_of_separation", "unloading"),
)
WORKS = "work of approach", "work of separation"

OfSurfaces = tuple[list[np.ndarray], list[tuple[float, float]]]  # errors of areas by way; ratios with their error


@dataclass(frozen=True)
class Errors:
    """Relative errors of one theory on one surface; areas of all states."""

    loading: np.ndarray
    unloading: np.ndarray
    pull_off: float
    work: float


def run(given: argparse.Namespace) -> None:
    data = read(given.file)
    if given.figure:
        save(picture(data), given.figure)
    else:
        ACTIONS[given.action](data)


def branches(data: xr.Dataset) -> None:
    """Print errors on the half that judges: of areas on both branches, pull-off and work of separation."""
    rows = []
    for words, holds in {"all": lambda one: True, f"θ ≥ {STRONG:g}": _strong}.items():
        loops = [one for one in deepest(data.isel(condition=slice(1, None, 2))) if holds(one)]
        for theory in THEORIES:
            errors = [errors_of(one, theory) for one in loops]
            cells = [
                *(_areas([getattr(one, way) for one in errors]) for way in WAYS),
                *(_events([getattr(one, name) for one in errors]) for name in ("pull_off", "work")),
            ]
            rows.append((NAMES[theory], words, len(loops), *cells))
    columns = (
        "area loading: mean size, 95 % below, worst",
        "unloading",
        "pull-off: median, mean size",
        "work of separation",
    )
    show(("theory", "conditions", "number", *columns), rows)


def _strong(one: xr.Dataset) -> bool:
    return float(one["relative_adhesion"]) >= STRONG


def _areas(errors: list[np.ndarray]) -> str:
    sizes = np.abs(np.concatenate(errors))
    sizes = sizes[np.isfinite(sizes)]
    if not sizes.size:
        return ""
    return "/".join(f"{100 * size:.0f}" for size in (sizes.mean(), np.quantile(sizes, 0.95), sizes.max())) + " %"


def _events(errors: list[float]) -> str:
    known = np.array(errors)[np.isfinite(errors)]
    if not known.size:
        return ""
    return minus(f"{100 * np.median(known):+.0f}/{100 * np.abs(known).mean():.0f} % of {known.size}")


def errors_of(one: xr.Dataset, theory: str) -> Errors:
    """Compare one theory with one loop; pull-off and work of separation are of the unloading branch."""
    by = one.sel(theory=theory)
    there = partial_contact(one) & (by["theory_converged"].values == 1)
    error = by["theory_relative_contact_area"].values / np.where(there, one[AREA].values, np.nan) - 1
    back = one["branch"].values == 1
    events = (
        float(by[f"theory_{name}"].sel(way="unloading") / one[name]) - 1
        for name in ("pull_off_pressure", "work_of_separation")
    )
    return Errors(error[~back & there], error[back & there], *events)


def partial_contact(one: xr.Dataset) -> np.ndarray:
    """Test which compared states have an area away from none and from full contact."""
    return (compared(one) & (one[AREA] > LEAST) & (one[AREA] < LARGEST)).values


def fit(data: xr.Dataset) -> None:
    """Print errors of the unloading area on the half that chooses, by k."""
    known = {one.number: one for one in design(JUMPING, least_jump=LEAST_JUMP)[0]}
    found: dict[float, list[float]] = {growth: [] for growth in GROWTHS}
    for one in deepest(data.isel(condition=slice(0, None, 2))):
        there = partial_contact(one) & (one["branch"].values == 1)
        area, pressure = one[AREA].values, one["mean_pressure"].values
        if not there.any():
            continue
        condition = known[int(one["condition"])]
        seed = seeds_of(condition, int(one["surface"]))[-1]
        curves = areas_at(condition, seed, pressure[there], RATIOS)
        for growth, sizes in found.items():
            ratio = adhesion_ratio(condition.jump_ratio, growth)
            theirs = [np.interp(np.log(ratio), np.log(RATIOS), curve) for curve in curves.T]
            sizes.append(float(np.nanmean(np.abs(np.array(theirs) / area[there] - 1))))
    rows = ((f"{growth:g}", len(sizes), f"{100 * np.nanmean(sizes):.1f} %") for growth, sizes in found.items())
    show(("k", "conditions", "mean size of the error of the unloading area"), rows)


def surfaces(data: xr.Dataset) -> None:
    """Print the edge flow against means of several surfaces by condition, then all theories by groups of them."""
    loops = [data.isel(condition=place, preload=-1) for place in range(data.sizes["condition"])]
    chose = choosing_half()
    judging = [int(one["condition"]) not in chose for one in loops]
    results = {theory: [of_surfaces(one, theory) for one in loops] for theory in THEORIES}
    rows = []
    for one, judge, (areas, events) in zip(loops, judging, results["edge_flow"], strict=True):
        head = int(one["condition"]), MARKERS[str(one["law"].values)][0], f"{float(one['relative_adhesion']):.2f}"
        ratios = (f"{ratio:.2f} ± {error:.2f}" for ratio, error in events)
        rows.append((*head, "judges" if judge else "", *(_areas([each]) for each in areas), *ratios))
    columns = "area loading: mean size, 95 % below, worst", "unloading", "tension on approach", "pull-off"
    show(("condition", "law", "θ", "half", *columns, *WORKS), rows)
    print()
    strong = [judge and _strong(one) for one, judge in zip(loops, judging, strict=True)]
    _show(_compared(results, {"judging": judging, f"judging, θ ≥ {STRONG:g}": strong}))


def means(data: xr.Dataset) -> None:
    """Print errors of all theories against means of surfaces by group, of conditions that have all and chose no k."""
    loops = _blind(data)
    results = {theory: [of_surfaces(one, theory) for one in loops] for theory in THEORIES}
    groups = {words: [GROUPS[words](one) for one in loops] for words in ("all", "half-spaces, θ ≥ 0.3")}
    laws = {words: [str(one["law"].values) == law for one in loops] for law, (words, _) in MARKERS.items()}
    _show(_compared(results, groups) + _compared({"edge_flow": results["edge_flow"]}, laws))


def _blind(data: xr.Dataset) -> list[xr.Dataset]:
    """Return the deepest loops of conditions that have all surfaces and chose no number of a theory."""
    there = data["mean_pressure"].isel(preload=-1).notnull().any("step").all("surface")
    there &= ~data["condition"].isin(list(choosing_half()))
    return [data.isel(condition=place, preload=-1) for place in np.flatnonzero(there)]


def loads(data: xr.Dataset) -> None:
    """Print errors of the edge flow's area by load, beside the standard error of the means that they are against."""
    loops = [_of_theory(one, "edge_flow") for one in _blind(data)]
    found = np.array([[area_errors(ones, way) for ones in loops] for way in range(len(WAYS))])
    found = found.reshape(len(WAYS), len(loops), 2, -1, 2)  # two neighbouring pressures
    rows = []
    for place, (light, heavy) in enumerate(PRESSURES.reshape(-1, 2)):
        cells = [_by_load(*np.moveaxis(found[way, :, :, place], 1, 0)) for way in range(len(WAYS))]
        rows.append((f"{light:.2g} … {heavy:.2g}", *(f"{one}/{other}" for one, other in zip(*cells, strict=True))))
    errors = "mean error, %", "its size (rms), %", "standard error, %", "size without scatter, %"
    beyond = f"beyond {100 * FAR_OFF:.0f} %"
    show(("p/(E*h′/2)", "states", *errors, beyond, f"{beyond} by two standard errors"), rows)


def _by_load(error: np.ndarray, spread: np.ndarray) -> list[str]:
    """Write what is known of errors and standard errors of areas on one way."""
    known = np.isfinite(error)
    if not known.any():
        return [""] * 7
    error, spread = error[known], spread[known]
    own, scatter = (float(np.mean(each**2)) for each in (error, spread))
    sizes = (f"{100 * np.sqrt(max(each, 0)):.1f}" for each in (own, scatter, own - scatter))
    off = (f"{np.sum(np.abs(error) - times * spread > FAR_OFF)}" for times in (0, 2))
    return [f"{error.size}", minus(f"{100 * error.mean():+.1f}"), *sizes, *off]


def _show(rows: list[Sequence[object]]) -> None:
    columns = "area loading: mean size, 95 % below, worst", "unloading", "tension on approach: mean size, worst"
    show(("theory", "conditions", "number", *columns, "pull-off", *WORKS), rows)


def _compared(results: dict[str, list[OfSurfaces]], groups: dict[str, list[bool]]) -> list[Sequence[object]]:
    """Write mean and worst errors of theories' areas, tensions and works by group of conditions."""
    rows: list[Sequence[object]] = []
    for words, some in groups.items():
        for theory, of_all in results.items() if any(some) else ():
            found = [each for each, holds in zip(of_all, some, strict=True) if holds]
            areas = [_areas([each[0][way] for each in found]) for way in range(len(WAYS))]
            errors = np.abs(np.array([each[1] for each in found])[..., 0] - 1).T
            sizes = [one[np.isfinite(one)] for one in errors]
            events = (f"{100 * one.mean():.0f}/{100 * one.max():.0f} %" if one.size else "" for one in sizes)
            rows.append((NAMES[theory], words, len(found), *areas, *events))
    return rows


def choosing_half() -> set[int]:
    """Return the numbers of the jumping conditions that chose k, the rows of the table of the fit; the rest judge."""
    return set(read(JUMPING_DATA)["condition"].values[::2].tolist())


def of_surfaces(loops: xr.Dataset, theory: str) -> OfSurfaces:
    """Return relative errors of mean areas on both ways, and ratios of tensions and works with their standard error."""
    ones = _of_theory(loops, theory)
    errors = (area_errors(ones, way)[0] for way in range(len(WAYS)))
    areas = [each[np.isfinite(each)] for each in errors]
    pairs = [[_approach(one) for one in ones]]
    for name, predicted, way in EVENTS:
        pairs.append([(float(one[name]), float(one[f"theory_{predicted}"].sel(way=way))) for one in ones])
    return areas, [ratio_of_means(*np.array(each).T) for each in pairs]


def _of_theory(loops: xr.Dataset, theory: str) -> list[xr.Dataset]:
    """Return the loops of each surface, with one theory beside them."""
    return [loops.sel(theory=theory).isel(surface=place) for place in range(loops.sizes["surface"])]


def area_errors(ones: Sequence[xr.Dataset], way: int) -> np.ndarray:
    """Return relative errors of the surfaces' mean area, and their standard errors, NaN away from partial contact."""
    both = np.array([curves(one, way) for one in ones])  # shape (surfaces, 2, pressures)
    ratios = np.array([ratio_of_means(*pair) for pair in np.moveaxis(both, 2, 0).swapaxes(1, 2)]).T
    simulated = both[:, 0].mean(axis=0)
    partial = (simulated > LEAST) & (simulated < LARGEST)
    return np.where(partial, ratios - [[1.0], [0.0]], np.nan)


def curves(one: xr.Dataset, way: int) -> np.ndarray:
    """Interpolate simulated area and a theory's at the compared pressures of one way, NaN beyond its states."""
    area = one["theory_relative_contact_area"]
    there = (one["mean_pressure"] > 0) & (one["converged"] == 1) & (one["branch"] == way) & area.notnull()
    pressure = (one["mean_pressure"] / stress_of(one)).values[there]
    order, ends = np.argsort(pressure), {"left": np.nan, "right": np.nan}
    given = (each.values[there][order] for each in (one[AREA], area))
    if not pressure.size:
        return np.full((2, PRESSURES.size), np.nan)
    return np.array([np.interp(np.log(PRESSURES), np.log(pressure[order]), each, **ends) for each in given])


def _approach(one: xr.Dataset) -> tuple[float, float]:
    """Return the lowest pressure of the way in, simulated and by a theory."""
    simulated = float(one["mean_pressure"].where(one["branch"] == 0).min())
    return simulated, float(one["theory_pull_off_pressure"].sel(way="loading"))


def ratio_of_means(simulated: np.ndarray, theory: np.ndarray) -> tuple[float, float]:
    """Return the ratio of means, and its standard error from the differences of a surface's two values."""
    ratio = float(theory.mean() / simulated.mean())
    rest = theory - ratio * simulated
    return ratio, float(rest.std(ddof=1) / np.sqrt(rest.size) / abs(simulated.mean()))


def distributions(data: xr.Dataset) -> None:
    """Print errors of the edge flow's deviations and skewness of local gap and pressure, on the half that judges."""
    chose, rows = choosing_half(), []
    for condition in by_number(design(JUMPING, least_jump=LEAST_JUMP)[0], data["condition"].values.tolist()):
        number = condition.number
        if number in chose or condition.traction_law.has_wall:
            continue  # no density of the pressure in the edge flow
        for place, way in enumerate(WAYS):
            errors = np.concatenate(
                [
                    _of_distributions(data.sel(condition=number, surface=surface).isel(preload=-1), condition, place)
                    for surface in data["surface"].values
                ]
            )
            if errors.size:
                cells = (f"{minus(f'{np.mean(each):+.2f}')} ± {np.std(each):.2f}" for each in errors.T)
                rows.append((condition.number, f"{condition.jump_ratio:.2f}", way, len(errors), *cells))
    moments = "deviation of u: relative error", "skewness of u", "deviation of σ: relative error", "skewness of σ"
    show(("condition", "x", "branch", "states", *moments), rows)


def _of_distributions(one: xr.Dataset, condition: Condition, place: int) -> np.ndarray:
    """Compare states of one way of a loop with the edge flow's of that branch, shape (states, moments)."""
    pressure = one["mean_pressure"].values
    there = np.flatnonzero(partial_contact(one) & (one["branch"].values == place))
    if not there.size:
        return np.empty((0, 4))
    case, spectrum = theory_input(condition, seeds_of(condition, int(one["surface"]))[-1], pressure[there])
    flow = edge_flow(spectrum, case.solid, case.law, 1.1 * float(pressure[there].max()), branch=WAYS[place])
    errors = []
    for step in there:
        state = flow.at_pressure(float(pressure[step]))
        gap = moments(state.gaps * state.length, state.weights)
        local = moments(-state.law.traction(state.gaps) * state.contact_modulus, state.weights)
        pairs = []
        for name, (deviation, skewness) in (("gap", gap), ("pressure", local)):
            pairs += [deviation / float(one[f"{name}_standard_deviation"][step]) - 1]
            pairs += [skewness - float(one[f"{name}_skewness"][step])]
        errors.append(pairs)
    return np.array(errors)


@styled
def picture(data: xr.Dataset) -> Figure:
    """Draw area over pressure on both ways, simulated and by the flows, for conditions that did not choose k."""
    figure = Figure(figsize=(DOUBLE, 2.6), layout="constrained")
    judging = [one for one in deepest(data.isel(condition=slice(1, None, 2))) if _strong(one)]
    several = [one for one in judging if errors_of(one, "edge_flow").unloading.size >= SHOWN_STATES]
    shown = sorted(several, key=lambda one: float(one["apparent_adhesion_ratio"]))
    panels = figure.subplots(1, 3, sharey=True)
    for axes, one in zip(panels, (shown[0], shown[len(shown) // 2], shown[-1]), strict=True):
        pressure = one["mean_pressure"].values / stress_of(one)
        for way, (marker, dash) in enumerate((("o", "-"), ("v", "--"))):
            held = (one["branch"].values == way) & (pressure > 0)
            axes.plot(
                pressure[held], one[AREA].values[held], marker, color="0.4", mfc="w", label=f"simulated, {WAYS[way]}"
            )
            for theory, colour in (("gap_flow", "#009E73"), ("edge_flow", "#CC79A7")):
                area = one["theory_relative_contact_area"].sel(theory=theory).values[held]
                axes.plot(pressure[held], area, dash, color=colour, label=f"{NAMES[theory]}, {WAYS[way]}")
        ratio, adhesion = float(one["apparent_adhesion_ratio"]), float(one["relative_adhesion"])
        law = MARKERS[str(one["law"].values)][0]
        axes.set_title(rf"{law}, $\theta$ = {adhesion:.2f}, $\Gamma$ = {ratio:.2f}", fontsize=8.5)
        axes.set(xscale="log", xlabel="p / (E*h′/2)", ylim=(0, 1))
    panels[0].set_ylabel("A / A₀")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return figure


ACTIONS = {
    "fit": fit,
    "branches": branches,
    "surfaces": surfaces,
    "means": means,
    "loads": loads,
    "distributions": distributions,
}

main = program(
    run,
    Option("action", str, "table", choices=tuple(ACTIONS)),
    Option("file", JUMPING_DATA, "dataset of the atlas", type=Path),
    FIGURE,
)

if __name__ == "__main__":
    sys.exit(main())
