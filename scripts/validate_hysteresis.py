"""Both branches of the edge flow against the jumping conditions of the contact atlas, as Markdown.

The edge flow unloads with Γ = 1 + k (x² − 1)₊ times the work of adhesion. Every other condition chose k, the rest
judge it.

python -m scripts.validate_hysteresis fit          # errors of the chosen half by k
python -m scripts.validate_hysteresis branches     # errors of all theories on the other half
python -m scripts.validate_hysteresis losses       # Γ of the work that loops lose, on both
python -m scripts.validate_hysteresis preloads     # what a smaller preload changes on unloading, on both
python -m scripts.validate_hysteresis surfaces data/contact_atlas_surfaces.nc     # means of four surfaces
python -m scripts.validate_hysteresis branches --figure docs/images/edge_flow_branches.png
"""

import argparse
import itertools
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from contact_study.atlas.collection import THEORIES, WAYS
from contact_study.atlas.design import JUMPING, LEAST_JUMP, Condition, design
from contact_study.atlas.loops import CORES, seeds_of, theory_study_of
from contact_study.physics.laws import LAWS
from contact_study.physics.spheres.numbers import maugis_parameter
from contact_study.plots.style import DOUBLE, styled
from contact_study.study.case import realise
from contact_study.study.study import make_study
from scripts.contact_atlas import AREA, DATA, LIGHTEST, MARKERS, NAMES, compared, deepest, read, stress_of
from scripts.harness import FIGURE, Option, minus, program, save, show
from theory.edge_flow.apparent_adhesion import GROWTH, adhesion_ratio, stronger
from theory.edge_flow.flow import edge_flow
from theory.study.case_theories import roughness

JUMPING_DATA = DATA.with_name("contact_atlas_jumping.nc")
GROWTHS = 0.0, 0.04, 0.06, GROWTH, 0.1, 0.12, 0.16
RATIOS = 1.0, 1.1, 1.25, 1.5, 1.9  # of the work of adhesion, between which areas are interpolated
LEAST, LARGEST = 0.02, 0.98  # areas that are compared
SHOWN_STATES = 3  # compared states on unloading of a condition in the figure
STRONG = 0.5  # θ from which a surface of this size holds together by many asperities
ONSETS = 0.0, 1.1, 1.3, 1.5, 1.8, 2.3, 9.0  # bins of x


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
        curves = areas_at(condition, seed, pressure[there])
        for growth, sizes in found.items():
            ratio = adhesion_ratio(condition.jump_ratio, growth)
            theirs = [np.interp(np.log(ratio), np.log(RATIOS), curve) for curve in curves.T]
            sizes.append(float(np.nanmean(np.abs(np.array(theirs) / area[there] - 1))))
    rows = ((f"{growth:g}", len(sizes), f"{100 * np.nanmean(sizes):.1f} %") for growth, sizes in found.items())
    show(("k", "conditions", "mean size of the error of the unloading area"), rows)


def areas_at(condition: Condition, seed: int, pressures: np.ndarray) -> np.ndarray:
    """Areas of the edge flow at pressures (Pa) for each of the works of adhesion, shape (ratios, pressures)."""
    cores = CORES if condition.traction_law.has_wall else (0.0,)
    by_core = []
    for core in cores:
        case = make_study(theory_study_of(condition, seed, pressures.tolist(), core)).cases[0]
        spectrum = roughness(case, realise(case), "surface")
        by_ratio = []
        for ratio in RATIOS:
            flow = edge_flow(spectrum, case.solid, stronger(case.law, ratio), 1.1 * float(pressures.max()))
            states = [flow.at_pressure(float(pressure)) for pressure in pressures]
            by_ratio.append([each.fraction_below(case.contact_distance) for each in states])
        by_core.append(np.array(by_ratio))
    return 2 * by_core[0] - by_core[-1]


def losses(data: xr.Dataset) -> None:
    """Print Γ_D = 1 + D/(Δγ ΔA) by x, beside Γ; D is lost from the lightest pressure to the preload and back."""
    found = [pair for one in deepest(data) if (pair := measured_ratio(one)) is not None]
    number, ratio = np.array(found).T
    rows = []
    for low, high in itertools.pairwise(ONSETS):
        some = (number >= low) & (number < high)
        if some.any():
            words = f"{number[some].min():.2f} … {number[some].max():.2f}"
            medians = (np.median(values[some]) for values in (ratio, adhesion_ratio(number)))
            rows.append((words, some.sum(), *(f"{median:.3f}" for median in medians)))
    show(("x", "loops", "Γ_D: median", "Γ: median"), rows)


def preloads(data: xr.Dataset) -> None:
    """Print how far unloading from a smaller preload reaches the branch of the largest, and the pull-off of both."""
    pairs = []
    for one in deepest(data):
        small = data.sel(condition=int(one["condition"]), surface=int(one["surface"])).isel(preload=0)
        loads, places = zip(*(_ways(each) for each in (one, small)), strict=True)
        (load, back), (_, early) = places
        shared = loads[1] / 2  # where the early way out has come off its turning point
        if shared < LIGHTEST:
            continue
        rising, wide, narrow = (float(np.interp(np.log(shared), *way)) for way in (load, back, early))
        share = (narrow - rising) / (wide - rising) if wide - rising > LEAST else np.nan
        pairs.append((measured_ratio(one), share, float(small["pull_off_pressure"] / one["pull_off_pressure"])))
    rows = []
    for low, high in itertools.pairwise(ONSETS):
        some = np.array([pair[1:] for pair in pairs if pair[0] is not None and low <= pair[0][0] < high])
        if some.size:
            known = some[np.isfinite(some[:, 0]), 0]
            shares = f"{np.median(known):.2f} ({known.min():.2f} … {known.max():.2f})" if known.size else ""
            ratios = some[:, 1]
            rows.append(
                (
                    f"{low:g} … {high:g}",
                    len(some),
                    shares,
                    f"{np.median(ratios):.3f} ({ratios.min():.2f} … {ratios.max():.2f})",
                )
            )
    show(("x", "loops", "share of the branch reached: median (range)", "ratio of pull-offs"), rows)


def surfaces(data: xr.Dataset) -> None:
    """Print pull-off and work of separation by the edge flow over the simulated ones, as means of several surfaces."""
    rows, every = [], []
    for number in range(data.sizes["condition"]):
        one = data.isel(condition=number, preload=-1)
        cells = []
        for name in ("pull_off_pressure", "work_of_separation"):
            simulated = one[name].values
            theory = one[f"theory_{name}"].sel(theory="edge_flow", way="unloading").values
            ratio, scatter = theory.mean() / simulated.mean(), simulated.std(ddof=1) / abs(simulated.mean())
            every.append(abs(ratio - 1))
            cells += [f"{100 * scatter:.0f} %", f"{ratio:.2f}"]
        law = MARKERS[str(one["law"].values)][0]
        rows.append((int(one["condition"]), law, f"{float(one['relative_adhesion']):.2f}", *cells))
    sizes = np.reshape(every, (-1, 2))
    worst = [text for size in sizes.T for text in ("", f"±{100 * size.mean():.0f} %, worst {100 * size.max():.0f} %")]
    rows.append(("all", "", "", *worst))
    columns = "pull-off: scatter", "theory/simulated", "work of separation: scatter", "theory/simulated"
    show(("condition", "law", "θ", *columns), rows)


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


def _ways(one: xr.Dataset) -> tuple[float, list[tuple[np.ndarray, np.ndarray]]]:
    """Return the largest pressure of a loop, and logarithm of positive pressures with areas of both ways, rising."""
    pressure, area = one["mean_pressure"].values / stress_of(one), one[AREA].values
    there = np.flatnonzero(np.isfinite(pressure))
    turn = there[int(np.argmax(pressure[there]))]
    found = []
    for way in (there[there <= turn], there[there >= turn]):
        held = way[pressure[way] > 0]
        order = held[np.argsort(pressure[held])]
        found.append((np.log(pressure[order]), area[order]))
    return float(pressure[turn]), found


def measured_ratio(one: xr.Dataset) -> tuple[float, float] | None:
    """Return x and Γ_D of a deepest loop; None if it does not reach the lightest pressure on both ways."""
    work, law = float(one["work_of_adhesion"]), str(one["law"].values)
    pressure = one["mean_pressure"].values / stress_of(one)
    there = np.flatnonzero(np.isfinite(pressure))
    pressure, turn = pressure[there], int(np.argmax(pressure[there]))
    names = (AREA, "dissipated_energy", "unaccounted_work")
    area, jumps, small = (one[name].values[there] for name in names)
    start, end = _crossing(pressure[: turn + 1][::-1]), _crossing(pressure[turn:])
    if start is None or end is None:
        return None
    lost = jumps + small
    change, loss = area[turn] - _at(area, turn - start), _at(lost, turn + end) - _at(lost, turn - start)
    radius, modulus = 1 / float(one["rms_curvature"]), float(one["contact_modulus"])
    number = maugis_parameter(radius, modulus, work, float(one["peak_tensile_stress"])) / LAWS[law].jump_onset
    return float(number), 1 + loss / (work * change)


def _crossing(pressure: np.ndarray) -> float | None:
    """Find the place, counted from the turning point, where a falling pressure passes the lightest one."""
    below = np.flatnonzero(pressure < LIGHTEST)
    if not below.size or not below[0]:
        return None
    after = int(below[0])
    share = (pressure[after - 1] - LIGHTEST) / (pressure[after - 1] - pressure[after])
    return float(after - 1 + share)


def _at(values: np.ndarray, place: float) -> float:
    return float(np.interp(place, np.arange(values.size), values))


ACTIONS = {
    "fit": fit,
    "branches": branches,
    "losses": losses,
    "preloads": preloads,
    "surfaces": surfaces,
}

main = program(
    run,
    Option("action", str, "table", choices=tuple(ACTIONS)),
    Option("file", JUMPING_DATA, "dataset of the atlas", type=Path),
    FIGURE,
)

if __name__ == "__main__":
    sys.exit(main())
