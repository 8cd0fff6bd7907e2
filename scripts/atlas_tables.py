"""Tables and the figure of the contact atlas, of its dataset or another, as Markdown.

python -m scripts.atlas_tables areas
python -m scripts.atlas_tables maps --figure docs/images/contact_atlas.png
"""

import argparse
import itertools
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from contact_study.atlas.collection import THEORIES
from contact_study.atlas.design import JUMPING, LEAST_JUMP, Condition, design
from contact_study.atlas.loops import REFINEMENTS
from contact_study.inputs.errors import InputError
from contact_study.plots.style import DOUBLE, styled
from scripts.harness import FIGURE, Option, minus, program, save, show

DATA = Path("data/contact_atlas.nc")
LIGHTEST, HEAVIEST = 0.02, 1.2  # pressures of compared states, over half of modulus times rms slope
LARGEST_ERROR = 0.5  # of the figure's colours
AREA = "corrected_contact_area"  # that theories are compared with
SHOWN_LOADS = 0.05, 0.4  # of grids, over half of modulus times rms slope
SHOWN = 0.2  # pressure of the figure's area
ADHESIONS = 0.5, 1.0, 1.5, 2.0, 3.0  # ends of the ranges of relative adhesion for the works
MARKERS = {"lennard_jones_10_4": ("10-4 law", "o"), "exponential": ("exponential", "s"), "dugdale": ("Dugdale", "^")}
NAMES = {"persson": "Persson", "gap_flow": "gap flow", "edge_flow": "edge flow"}

GROUPS: dict[str, Callable[[xr.Dataset], bool]] = {  # of conditions
    "all": lambda one: True,
    "half-spaces, θ < 0.3": lambda one: solid_of(one) == "half_space" and float(one["relative_adhesion"]) < 0.3,
    "half-spaces, θ ≥ 0.3": lambda one: solid_of(one) == "half_space" and float(one["relative_adhesion"]) >= 0.3,
    "layers": lambda one: solid_of(one) == "layer",
}


def run(given: argparse.Namespace) -> None:
    ACTIONS[given.action](given)


def numbers(given: argparse.Namespace) -> None:
    """Print numbers of the whole design, of its conditions in a dataset, and of the jumping conditions."""
    (whole, refusals), jumping = design(), design(JUMPING, least_jump=LEAST_JUMP)
    there = set(read(given.file)["condition"].values.tolist())
    some = [one for one in whole if one.number in there]
    rows = []
    for name, conditions, refused in (
        ("whole", whole, refusals),
        (f"in {given.file.name}", some, {}),
        ("jumping", *jumping),
    ):
        if not conditions:
            continue
        grids = np.percentile([one.points for one in conditions], (0, 50, 100))
        laws = "/".join(str(sum(one.law == law for one in conditions)) for law in MARKERS)
        layers = sum(one.solid == "layer" for one in conditions)
        ranges = (
            f"{np.median(values):.2g} ({min(values):.2g}…{max(values):.2g})"
            for name in ("hurst_exponent", "cutoff_ratio", "relative_adhesion", "tabor_number")
            for values in [[getattr(one, name) for one in conditions]]
        )
        reasons = "; ".join(f"{number} {reason}" for reason, number in sorted(refused.items()))
        rows.append(
            (name, len(conditions), reasons, "/".join(f"{points:.0f}" for points in grids), laws, layers, *ranges)
        )
    show(
        ("", "conditions", "refused", "grid (min/median/max)", "10-4/exp./Dugdale", "layers", "H", "q₁/q₀", "θ", "μ"),
        rows,
    )


def areas(given: argparse.Namespace) -> None:
    """Print the errors of the theories' contact area and mean gap against loading, the edge flow's by adhesion, too."""
    data = read(given.file)
    rows = []
    for theory in THEORIES:
        for words in GROUPS if theory == THEORIES[-1] else ("all",):
            rows += _errors([one for one in deepest(data) if GROUPS[words](one)], theory, words)
    show(
        (
            "theory",
            "conditions",
            "number",
            "states",
            "area: mean",
            "mean size",
            "95 % below",
            "worst",
            "ū/h_rms: mean size",
            "worst",
        ),
        rows,
    )


def solid_of(one: xr.Dataset) -> str:
    return str(one["solid"].values)


def _errors(loops: list[xr.Dataset], theory: str, words: str) -> Iterator[tuple[object, ...]]:
    area, gap, conditions = [], [], set()
    for one in loops:
        by = one.sel(theory=theory)
        there = (one["branch"] == 0) & compared(one)
        there &= by["theory_relative_contact_area"].notnull() & (by["theory_converged"] == 1)
        if not there.any():
            continue
        conditions.add(int(one["condition"]))
        area += (by["theory_relative_contact_area"] / one[AREA] - 1).values[there].tolist()
        gap += ((by["theory_mean_gap"] - one["mean_gap"]) / one["rms_height"]).values[there].tolist()
    if area:
        sizes, gaps = np.abs(area), np.abs(gap)
        shown = (
            f"{100 * np.mean(area):+.0f}",
            *(f"{100 * size:.0f}" for size in (sizes.mean(), np.quantile(sizes, 0.95), sizes.max())),
        )
        gap_cells = f"{np.nanmean(gaps):.3f}", f"{np.nanmax(gaps):.2f}"
        yield NAMES[theory], words, len(conditions), len(area), *(minus(f"{cell} %") for cell in shown), *gap_cells


def compared(one: xr.Dataset) -> xr.DataArray:
    """Test which states are between the lightest and the heaviest pressure, and converged."""
    pressure = one["mean_pressure"] / stress_of(one)
    return (pressure >= LIGHTEST) & (pressure <= HEAVIEST) & (one["converged"] == 1)


def grids(given: argparse.Namespace) -> None:
    """Print errors on half, all and twice the points against the extrapolation of the three, by law.

    Mean sizes, and with their sign and standard error those of the corrected area on all points.
    """
    data = read(given.file)
    if "refined_mean_pressure" not in data:
        raise InputError(f"{given.file}: no condition was run on other grids")
    by_law: dict[str, list[np.ndarray]] = {}
    for one in deepest(data.isel(surface=[0])):
        if one["refined_pull_off_pressure"].isnull().any():
            continue
        three = [_summary(one, factor) for factor in (REFINEMENTS[0], None, REFINEMENTS[1])]
        errors = []
        for words, (_, unit) in three[0].items():
            values = np.array([each[words][0] for each in three])
            limit = extrapolated(*values)
            errors.append(100 * (values - limit) / (unit or abs(limit)))
        by_law.setdefault(str(one["law"].values), []).append(np.array(errors))
    columns = list(three[0])
    signed = [place for place, words in enumerate(columns) if words.startswith("corrected")]
    rows = []
    for law, of_law in sorted(by_law.items()):
        found = np.array(of_law)  # shape (conditions, results, grids)
        sizes = (f"{'/'.join(f'{size:.1f}' for size in each)} %" for each in np.abs(found).mean(axis=0))
        own = found[:, signed, 1]
        pairs = zip(own.mean(axis=0), own.std(axis=0, ddof=1) / np.sqrt(len(own)), strict=True)
        rows.append(
            (MARKERS[law][0], len(found), *sizes, *(minus(f"{mean:+.1f} ± {error:.1f} %") for mean, error in pairs))
        )
    show(("law", "conditions", *columns, *(f"{columns[place]}, signed" for place in signed)), rows)


def _summary(one: xr.Dataset, factor: float | None) -> dict[str, tuple[float, float | None]]:
    """Return results of a loop on its own or another grid, and their units if errors are not relative."""
    loop = one if factor is None else one.sel(refinement=factor)
    prefix = "" if factor is None else "refined_"
    found: dict[str, tuple[float, float | None]] = {}
    way = one["branch"].values == 0
    pressure = loop[f"{prefix}mean_pressure"].values[way] / stress_of(one)
    rising = pressure > np.fmax.accumulate(np.append(0.0, pressure[:-1]))
    for name, words in (("relative_contact_area", "area"), (AREA, "corrected area")):
        values = loop[f"{prefix}{name}"].values[way][rising]
        for at in SHOWN_LOADS:
            there = float(np.exp(np.interp(np.log(at), np.log(pressure[rising]), np.log(values))))
            found[f"{words} at {at:g}"] = there, None
    found["pull-off"] = float(loop[f"{prefix}pull_off_pressure"]), None
    found["loss over Δγ"] = float(loop[f"{prefix}dissipated_energy"].max()), float(one["work_of_adhesion"])
    return found


def extrapolated(coarse: np.ndarray, own: np.ndarray, fine: np.ndarray) -> np.ndarray:
    """Extrapolate values of three grids: by their own order where differences fall, else of first order."""
    first, second = np.asarray(own - coarse, float), np.asarray(fine - own, float)
    ratio = np.divide(first, second, out=np.full(np.shape(first), 2.0), where=second != 0)
    return fine + second / (np.clip(np.where(ratio > 0, ratio, 2.0), 2.0, None) - 1)


def works(given: argparse.Namespace) -> None:
    """Print what the works of both ways fall short of the work of adhesion by, over the energy of full contact."""
    data = read(given.file)
    some = data.isel(preload=-1, condition=np.flatnonzero(data["solid"] == "half_space")).mean("surface")
    of_theory = some["theory_work_of_separation"].sel(theory="edge_flow")
    lacking = {
        "simulated": (some["work_of_approach"], some["work_of_separation"]),
        "edge flow": (of_theory.sel(way="loading"), of_theory.sel(way="unloading")),
    }
    adhesion, intrinsic = some["relative_adhesion"].values, some["work_of_adhesion"]
    shares = [(1 - work / intrinsic).values * adhesion for both in lacking.values() for work in both]
    rows = []
    for low, high in itertools.pairwise(ADHESIONS):
        there = (adhesion >= low) & (adhesion < high)
        if not there.any():
            continue
        cells = ("{1:.2f} ({0:.2f}…{2:.2f})".format(*np.percentile(share[there], (0, 50, 100))) for share in shares)
        rows.append((f"{low:g} … {high:g}", there.sum(), *map(minus, cells)))
    show(("θ", "conditions", *(f"{name}: {way}" for name in lacking for way in ("approach", "separation"))), rows)


def cost(given: argparse.Namespace) -> None:
    """Print loops and processor time of a condition, theories and other grids included, by grid."""
    data = read(given.file)
    points, seconds = data["points"].values, data["processor_time"].values
    loops = data["mean_pressure"].notnull().any("step").sum(["surface", "preload"]).values
    rows = []
    for low, high in ((0, 100), (100, 200), (200, 300), (300, 513)):
        some = (points >= low) & (points < high)
        if some.any():
            rows.append((f"{points[some].min()}²…{points[some].max()}²", *_cost(loops[some], seconds[some])))
    rows.append(("all", *_cost(loops, seconds)))
    show(("grid", "conditions", "loops of each", "mean (s)", "largest (s)", "a loop (s)"), rows)


def _cost(loops: np.ndarray, seconds: np.ndarray) -> tuple[object, ...]:
    times = f"{seconds.mean():.0f}", f"{seconds.max():.0f}", f"{seconds.sum() / loops.sum():.0f}"
    return seconds.size, f"{loops.mean():.1f}", *times


def maps(given: argparse.Namespace) -> None:
    save(picture(read(given.file)), given.figure or Path("docs/images/contact_atlas.png"))


@styled
def picture(data: xr.Dataset) -> Figure:
    """Draw area, hysteresis, pull-off and the theories' errors over relative adhesion and Tabor number."""
    figure = Figure(figsize=(DOUBLE, 4.6), layout="constrained")
    panels = figure.subplots(2, 3, sharex=True, sharey=True)
    surfaces: dict[int, list[xr.Dataset]] = {}
    for one in deepest(data):
        surfaces.setdefault(int(one["condition"]), []).append(one)
    some = [each[0] for each in surfaces.values()]
    place = np.array([(float(one["relative_adhesion"]), float(one["tabor_number"])) for one in some])
    laws = np.array([str(one["law"].values) for one in some])
    columns: dict[str, Callable[[xr.Dataset], float]] = {
        f"area at {SHOWN:g} E*h′/2": _area,
        r"loss of the loop / $\Delta\gamma$": lambda one: float(
            lost_of(one).dropna("step")[-1] / one["work_of_adhesion"]
        ),
        "pull-off / (E*h′/2)": lambda one: float(-one["pull_off_pressure"]) / stress_of(one),
        **{f"error of area: {NAMES[theory]}": partial(_mean_error, theory=theory) for theory in THEORIES},
    }
    for axes, (words, value) in zip(panels.flat, columns.items(), strict=True):
        values = np.array([_mean([value(one) for one in each]) for each in surfaces.values()])
        signed = words.startswith("error")
        largest = LARGEST_ERROR if signed else np.nanmax(values)
        colours = {"cmap": "RdBu_r" if signed else "viridis", "vmin": -largest if signed else 0.0, "vmax": largest}
        for law, (label, marker) in MARKERS.items():
            some = laws == law
            edges = {"edgecolors": "#404040", "linewidths": 0.3, "s": 13, "marker": marker, "zorder": 3}
            drawn = axes.scatter(*place[some].T, c=values[some], label=label, **edges, **colours)
        axes.set(xscale="log", yscale="log")
        axes.set_title(words, fontsize=8.5)
        figure.colorbar(drawn, ax=axes, extend="both" if signed else "neither")
    for axes in panels[-1]:
        axes.set_xlabel(r"$\theta = \Delta\gamma/U_\mathrm{full}$")
    for axes in panels[:, 0]:
        axes.set_ylabel(r"Tabor number $\mu$")
    handles, labels = panels[0, 0].get_legend_handles_labels()
    legend = figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    for handle in legend.legend_handles:
        handle.set_array(None)
        handle.set_facecolor("white")
    return figure


def stress_of(one: xr.Dataset) -> float:
    """Return half of modulus times rms slope of a surface (Pa)."""
    return float(0.5 * one["contact_modulus"] * one["rms_slope"])


def lost_of(one: xr.Dataset) -> xr.DataArray:
    """Return the loss up to each state (J/m²); errors near full contact balance at the end of the loop."""
    return one["dissipated_energy"] + one["unaccounted_work"]


def _mean(values: list[float]) -> float:
    """Average what is known; NaN if nothing is."""
    known = [value for value in values if np.isfinite(value)]
    return float(np.mean(known)) if known else np.nan


def _area(one: xr.Dataset) -> float:
    """Interpolate the contact area on loading at the figure's pressure."""
    way = (one["branch"] == 0).values & np.isfinite(one["mean_pressure"].values)
    pressure = one["mean_pressure"].values[way] / stress_of(one)
    return float(np.interp(SHOWN, np.maximum.accumulate(pressure), one[AREA].values[way]))


def _mean_error(one: xr.Dataset, theory: str) -> float:
    values = one["theory_relative_contact_area"].sel(theory=theory) / one[AREA] - 1
    values = values.where((one["branch"] == 0) & compared(one))
    return float(values.mean()) if values.notnull().any() else np.nan


def deepest(data: xr.Dataset) -> Iterator[xr.Dataset]:
    """Yield the loop to the largest preload of each condition and surface that it has."""
    there = data["mean_pressure"].isel(preload=-1).notnull().any("step")
    for condition, surface in np.argwhere(there.transpose("condition", "surface").values):
        yield data.isel(condition=condition, surface=surface, preload=-1)


def by_number(conditions: list[Condition], numbers: list[int]) -> list[Condition]:
    """Choose conditions by their numbers; InputError for a number that none has."""
    known = {one.number: one for one in conditions}
    if lacking := [number for number in numbers if number not in known]:
        raise InputError(f"--numbers {lacking[0]}: is no condition of the design; see the dataset's condition")
    return [known[number] for number in numbers]


def read(path: Path) -> xr.Dataset:
    try:
        return xr.load_dataset(path)
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as a dataset ({type(error).__name__})") from None


ACTIONS = {
    "design": numbers,
    "areas": areas,
    "grids": grids,
    "works": works,
    "cost": cost,
    "maps": maps,
}

main = program(
    run,
    Option("action", str, "table, or the figure", choices=tuple(ACTIONS)),
    Option("file", DATA, "dataset of the atlas", type=Path),
    FIGURE,
)

if __name__ == "__main__":
    sys.exit(main())
