"""The contact atlas: a design of adhesive rough contacts, their loops, and one dataset with theories beside them.

python -m scripts.contact_atlas run --tenth            # what the folder lacks; again to resume
python -m scripts.contact_atlas collect --tenth -o data/contact_atlas_tenth.nc
python -m scripts.contact_atlas validate data/contact_atlas_tenth.nc
python -m scripts.contact_atlas areas data/contact_atlas_tenth.nc

Without --tenth it is the whole design. Each table (design, areas, hysteresis, grids, cost) can be printed alone.
"""

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from contact_study.atlas.collection import THEORIES, collect
from contact_study.atlas.design import SURFACES, TENTH, WHOLE, Condition, design
from contact_study.atlas.loops import REFINEMENTS, run_condition
from contact_study.atlas.validation import problems
from contact_study.campaign.store.files import write_aside
from contact_study.inputs.errors import InputError
from contact_study.physics.spheres.numbers import maugis_parameter
from contact_study.plots.style import DOUBLE, styled
from scripts.harness import FIGURE, Option, minus, program, save, show

DATA = Path("data/contact_atlas_tenth.nc")
SMALL_GRID = 128  # points a side up to which a condition is refined
LIGHTEST, HEAVIEST = 0.02, 1.2  # pressures of compared states, over half of modulus times rms slope
SHOWN = 0.2  # pressure of the figure's area
# Maugis' number at which the loop of one asperity opens under a given separation, by law.
OPENS = {"lennard_jones_10_4": 0.96, "exponential": 1.14, "dugdale": 0.89}
MARKERS = {"lennard_jones_10_4": "o", "exponential": "s", "dugdale": "^"}
NAMES = {"persson": "Persson", "gap_flow": "gap flow", "edge_flow": "edge flow"}


class Hysteresis(NamedTuple):
    """Measured and predicted apparent work of adhesion on unloading over that on loading, of one deepest loop."""

    condition: int
    surface: int
    law: str
    solid: str
    adhesion: float  # θ
    ratio: float  # x = λ/λ₁
    measured: float  # Γ_D = 1 + D/(Δγ ΔA)
    uncertain: float
    candidate: float
    quadratic: float


def run(given: argparse.Namespace) -> int:
    return ACTIONS[given.action](given)


def compute(given: argparse.Namespace) -> int:
    """Run the conditions, those of small grids first; --minutes ends before the next one."""
    began = time.monotonic()
    conditions = _conditions(given)
    refined = _refined(conditions, given.refined)
    for number, one in enumerate(sorted(conditions, key=lambda one: one.points), 1):
        if given.minutes and time.monotonic() - began > 60 * given.minutes:
            print(f"{len(conditions) - number + 1} conditions are left; run again to resume", file=sys.stderr)
            return 2
        factors = REFINEMENTS if one.number in refined else ()
        run_condition(one, Path(given.folder), given.surfaces, factors, given.workers)
        seconds = time.monotonic() - began
        words = f"{number} of {len(conditions)}: condition {one.number}, {one.points}², {seconds:.0f} s so far"
        print(words, file=sys.stderr, flush=True)
    return 0


def write(given: argparse.Namespace) -> int:
    if given.output is None:
        raise InputError("collect: missing -o FILE.nc")
    dataset = collect(_conditions(given), Path(given.folder), given.surfaces)
    coded = {
        name: {"zlib": True, "complevel": 9, "shuffle": True}
        for name, variable in dataset.variables.items()
        if variable.dtype.kind in "fi" and variable.ndim > 1
    }
    write_aside(given.output, lambda partial: dataset.to_netcdf(partial, encoding=coded))
    print(f"{dataset.sizes['condition']} conditions of {len(_conditions(given))}", file=sys.stderr)
    print(given.output)
    return 0


def check(given: argparse.Namespace) -> int:
    found = problems(_read(given.file))
    for line in found:
        print(line)
    print(f"{given.file}: {len(found)} problems", file=sys.stderr)
    return 1 if found else 0


def numbers(given: argparse.Namespace) -> None:
    """Print numbers of the whole design and of its tenth."""
    rows = []
    for name, count in (("tenth", TENTH), ("whole", WHOLE)):
        conditions, refused = design(count)
        grids = np.percentile([one.points for one in conditions], (0, 50, 100))
        laws = "/".join(str(sum(one.law == law for one in conditions)) for law in OPENS)
        layers = sum(one.solid == "layer" for one in conditions)
        ranges = (
            f"{np.median(values):.2g} ({min(values):.2g}…{max(values):.2g})"
            for name in ("hurst_exponent", "cutoff_ratio", "relative_adhesion", "tabor_number")
            for values in [[getattr(one, name) for one in conditions]]
        )
        reasons = "; ".join(f"{number} {reason}" for reason, number in sorted(refused.items()))
        rows.append((name, count, reasons, "/".join(f"{points:.0f}" for points in grids), laws, layers, *ranges))
    show(
        ("", "conditions", "refused", "grid (min/median/max)", "10-4/exp./Dugdale", "layers", "H", "q₁/q₀", "θ", "μ"),
        rows,
    )


def areas(given: argparse.Namespace) -> None:
    """Print the errors of the theories' contact area and mean gap against loading, by adhesion."""
    data = _read(given.file)
    rows = []
    for theory in THEORIES:
        for words, low, high in (("all", 0.0, np.inf), ("θ < 0.3", 0.0, 0.3), ("θ ≥ 0.3", 0.3, np.inf)):
            rows += _errors(data, theory, words, (low, high))
    show(
        (
            "theory",
            "adhesion",
            "conditions",
            "states",
            "area: mean",
            "mean size",
            "worst",
            "ū/h_rms: mean size",
            "worst",
        ),
        rows,
    )


def _errors(data: xr.Dataset, theory: str, words: str, limits: tuple[float, float]) -> Iterator[tuple[object, ...]]:
    area, gap, conditions = [], [], set()
    for one in _deepest(data):
        if not limits[0] <= float(one["relative_adhesion"]) < limits[1]:
            continue
        by = one.sel(theory=theory)
        there = by["theory_relative_contact_area"].notnull() & _compared(one)
        if not there.any():
            continue
        conditions.add(int(one["condition"]))
        area += (by["theory_relative_contact_area"] / one["relative_contact_area"] - 1).values[there].tolist()
        gap += ((by["theory_mean_gap"] - one["mean_gap"]) / one["rms_height"]).values[there].tolist()
    if area:
        sizes, gaps = np.abs(area), np.abs(gap)
        cells = f"{100 * np.mean(area):+.0f} %", f"{100 * sizes.mean():.0f} %", f"{100 * sizes.max():.0f} %"
        gap_cells = f"{np.nanmean(gaps):.3f}", f"{np.nanmax(gaps):.2f}"
        yield NAMES[theory], words, len(conditions), len(area), *map(minus, cells), *gap_cells


def _compared(one: xr.Dataset) -> xr.DataArray:
    """Test which states are between the lightest and the heaviest pressure, and converged."""
    pressure = one["mean_pressure"] / (0.5 * one["contact_modulus"] * one["rms_slope"])
    return (pressure >= LIGHTEST) & (pressure <= HEAVIEST) & (one["converged"] == 1)


def hysteresis(given: argparse.Namespace) -> None:
    """Print the apparent work of adhesion of the deepest loops, and errors of two forms fitted to other loops."""
    found = loops_of(_read(given.file))
    groups: dict[str, Callable[[Hysteresis], bool]] = {
        "all": lambda one: True,
        "x < 1.14": lambda one: one.ratio < 1.14,
        "x ≥ 1.14": lambda one: one.ratio >= 1.14,
        "half-spaces, θ < 1": lambda one: one.solid == "half_space" and one.adhesion < 1,
        "θ ≥ 1": lambda one: one.adhesion >= 1,
    }
    rows = []
    for words, holds in groups.items():
        chosen = [one for one in found if holds(one)]
        if not chosen:
            continue
        measured, *others = np.array([(one.measured, one.candidate, one.quadratic, 1.0) for one in chosen]).T
        errors = (np.abs(other - measured) for other in others)
        cells = (f"{error.mean():.3f} ({error.max():.2f})" for error in errors)
        rows.append((words, len(chosen), f"{measured.min():.2f}…{measured.max():.2f}", *cells))
    show(("loops", "number", "Γ_D", "error of the cubic form: mean (worst)", "of the quadratic form", "of Γ = 1"), rows)
    print()
    shown = [one for one in found if max(one.measured, one.candidate, one.quadratic) > 1.02]
    show(
        ("condition", "law", "solid", "θ", "x", "Γ_D", "cubic", "quadratic"),
        (
            (
                one.condition,
                one.law,
                one.solid,
                f"{one.adhesion:.2f}",
                f"{one.ratio:.2f}",
                f"{one.measured:.3f} ± {one.uncertain:.3f}",
                f"{one.candidate:.3f}",
                f"{one.quadratic:.3f}",
            )
            for one in sorted(shown, key=lambda one: one.ratio)
        ),
    )


def loops_of(data: xr.Dataset) -> list[Hysteresis]:
    """Measure Γ_D = 1 + D/(Δγ ΔA) of the deepest loops, from the lightest pressure and back, and predict it.

    Both forms, ln Γ = 0.073 c^0.7 (x³ − 1.14³)₊ and Γ − 1 = 0.089 (x² − 1.28²)₊, were fitted to other loops.
    """
    found = []
    for one in _deepest(data):
        law, modulus, work = str(one["law"].values), float(one["contact_modulus"]), float(one["work_of_adhesion"])
        radius, slope = 1 / float(one["rms_curvature"]), float(one["rms_slope"])
        pressure = one["mean_pressure"].values / (0.5 * modulus * slope)
        there = np.flatnonzero(np.isfinite(pressure))
        pressure, turn = pressure[there], int(np.argmax(pressure[there]))
        ways = {
            name: one[name].values[there]
            for name in ("relative_contact_area", "dissipated_energy", "dissipated_energy_resolution_error")
        }
        start, end = _crossing(pressure[: turn + 1][::-1]), _crossing(pressure[turn:])
        if start is None or end is None:
            continue
        begun = {name: _at(values[: turn + 1][::-1], start) for name, values in ways.items()}
        back = {name: _at(values[turn:], end) for name, values in ways.items()}
        change = work * (ways["relative_contact_area"][turn] - begun["relative_contact_area"])
        lost = back["dissipated_energy"] - begun["dissipated_energy"]
        unknown = back["dissipated_energy_resolution_error"] - begun["dissipated_energy_resolution_error"]
        ratio = float(maugis_parameter(radius, modulus, work, float(one["peak_tensile_stress"]))) / OPENS[law]
        contact = np.cbrt(9 * np.pi * work * radius**2 / (2 * modulus))  # JKR radius at zero load (m)
        covered = 0.023 * (2 / (radius * slope)) ** 2 * np.pi * contact**2
        found.append(
            Hysteresis(
                int(one["condition"]),
                int(one["surface"]),
                law,
                str(one["solid"].values),
                float(one["relative_adhesion"]),
                ratio,
                1 + lost / change,
                unknown / change,
                float(np.exp(0.073 * covered**0.7 * max(ratio**3 - 1.14**3, 0.0))),
                1 + 0.089 * max(ratio**2 - 1.28**2, 0.0),
            )
        )
    return found


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


def grids(given: argparse.Namespace) -> None:
    """Print differences between grids, and errors extrapolated from three of them, of the conditions that have them."""
    data = _read(given.file)
    if "refined_mean_pressure" not in data:
        raise InputError(f"{given.file}: no condition was run on other grids")
    rows = []
    for one in _deepest(data.isel(surface=[0])):
        if one["refined_pull_off_pressure"].isnull().any():
            continue
        way = _compared(one) & one["refined_mean_pressure"].notnull().all("refinement") & (one["branch"] == 0)
        coarse, fine = (one.sel(refinement=factor) for factor in REFINEMENTS)
        for words, name, scale in (
            ("area on loading", "relative_contact_area", None),
            ("pressure on loading", "mean_pressure", None),
            ("pull-off", "pull_off_pressure", None),
            ("dissipated, over Δγ", "dissipated_energy", float(one["work_of_adhesion"])),
        ):
            three = [
                np.asarray(values, float) for values in (coarse[f"refined_{name}"], one[name], fine[f"refined_{name}"])
            ]
            if name == "dissipated_energy":
                three = [np.nanmax(values) for values in three]
            elif np.ndim(three[0]):
                three = [values[way] for values in three]
            limit = extrapolated(*three)
            over = np.abs(limit) if scale is None else scale
            errors = [float(np.mean((values - limit) / over)) for values in three]
            rows.append(
                (
                    int(one["condition"]),
                    int(one["points"]),
                    words,
                    *(minus(f"{100 * error:+.2f} %") for error in errors),
                )
            )
    show(("condition", "points a side", "", "half the points", "atlas", "twice the points"), rows)


def extrapolated(coarse: np.ndarray, own: np.ndarray, fine: np.ndarray) -> np.ndarray:
    """Extrapolate values of three grids: by their own order where differences fall, else of first order."""
    first, second = np.asarray(own - coarse, float), np.asarray(fine - own, float)
    ratio = np.divide(first, second, out=np.full(np.shape(first), 2.0), where=second != 0)
    return fine + second / (np.clip(np.where(ratio > 0, ratio, 2.0), 2.0, None) - 1)


def cost(given: argparse.Namespace) -> None:
    """Print processor time by grid."""
    data = _read(given.file)
    points, seconds = data["points"].values, data["processor_time"].values
    rows = []
    for low, high in ((0, 100), (100, 200), (200, 300), (300, 513)):
        some = (points >= low) & (points < high)
        if some.any():
            rows.append(
                (
                    f"{points[some].min()}²…{points[some].max()}²",
                    some.sum(),
                    f"{seconds[some].mean():.0f}",
                    f"{seconds[some].max():.0f}",
                )
            )
    rows.append(("all", points.size, f"{seconds.mean():.0f}", f"{seconds.max():.0f}"))
    show(("grid", "conditions", "mean (s)", "largest (s)"), rows)


def maps(given: argparse.Namespace) -> None:
    save(picture(_read(given.file)), given.figure or Path("docs/images/contact_atlas.png"))


@styled
def picture(data: xr.Dataset) -> Figure:
    """Draw area, hysteresis, pull-off and the theories' errors over relative adhesion and Tabor number."""
    figure = Figure(figsize=(DOUBLE, 4.4), layout="constrained")
    panels = figure.subplots(2, 3, sharex=True, sharey=True)
    found = list(_deepest(data))
    loss = {(one.condition, one.surface): one.measured - 1 for one in loops_of(data)}
    columns = {
        f"area at {SHOWN:g} E*h′/2": [_area(one) for one in found],
        "Γ_D − 1": [loss.get((int(one["condition"]), int(one["surface"])), np.nan) for one in found],
        "pull-off over E*h′/2": [
            float(-one["pull_off_pressure"] / (0.5 * one["contact_modulus"] * one["rms_slope"])) for one in found
        ],
        **{f"error of area: {NAMES[theory]}": [_mean_error(one, theory) for one in found] for theory in THEORIES},
    }
    for axes, (words, values) in zip(panels.flat, columns.items(), strict=True):
        signed = words.startswith("error")
        largest = np.nanmax(np.abs(values), initial=0.0) or 1.0
        for law, marker in MARKERS.items():
            some = [number for number, one in enumerate(found) if str(one["law"].values) == law]
            drawn = axes.scatter(
                [float(found[number]["relative_adhesion"]) for number in some],
                [float(found[number]["tabor_number"]) for number in some],
                c=[values[number] for number in some],
                marker=marker,
                s=26,
                edgecolors="#404040",
                linewidths=0.4,
                cmap="RdBu_r" if signed else "viridis",
                vmin=-largest if signed else 0.0,
                vmax=largest,
                label=law.replace("_", " ").replace("10 4", "10-4"),
                plotnonfinite=False,
            )
        axes.set(xscale="log", yscale="log")
        axes.set_title(words, fontsize=8.5)
        figure.colorbar(drawn, ax=axes)
    for axes in panels[-1]:
        axes.set_xlabel("θ = Δγ/U_full")
    for axes in panels[:, 0]:
        axes.set_ylabel("Tabor number")
    panels[0, 0].legend(fontsize=6)
    return figure


def _area(one: xr.Dataset) -> float:
    """Interpolate the contact area on loading at the figure's pressure."""
    way = (one["branch"] == 0).values & np.isfinite(one["mean_pressure"].values)
    pressure = one["mean_pressure"].values[way] / float(0.5 * one["contact_modulus"] * one["rms_slope"])
    return float(np.interp(SHOWN, np.maximum.accumulate(pressure), one["relative_contact_area"].values[way]))


def _mean_error(one: xr.Dataset, theory: str) -> float:
    values = one["theory_relative_contact_area"].sel(theory=theory) / one["relative_contact_area"] - 1
    values = values.where(_compared(one))
    return float(values.mean()) if values.notnull().any() else np.nan


def _deepest(data: xr.Dataset) -> Iterator[xr.Dataset]:
    """Yield the loop to the largest preload of each condition and surface."""
    for condition in range(data.sizes["condition"]):
        for surface in range(data.sizes["surface"]):
            yield data.isel(condition=condition, surface=surface, preload=-1)


def _conditions(given: argparse.Namespace) -> list[Condition]:
    return design(TENTH if given.tenth else WHOLE)[0]


def _refined(conditions: list[Condition], count: int) -> set[int]:
    """Choose conditions of small grids for finer ones: those of the largest Tabor numbers, where grids matter most."""
    small = [one for one in conditions if one.points <= SMALL_GRID]
    return {one.number for one in sorted(small, key=lambda one: -one.tabor_number)[:count]}


def _read(path: Path) -> xr.Dataset:
    try:
        return xr.load_dataset(path)
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as a dataset ({type(error).__name__})") from None


ACTIONS = {
    "run": compute,
    "collect": write,
    "validate": check,
    "design": numbers,
    "areas": areas,
    "hysteresis": hysteresis,
    "grids": grids,
    "cost": cost,
    "maps": maps,
}

main = program(
    run,
    Option("action", str, "step or table", choices=tuple(ACTIONS)),
    Option("file", DATA, "dataset to validate, or of the tables", type=Path),
    Option("--tenth", False, "first tenth of the design"),
    Option("--folder", "build/atlas", "folder of the runs"),
    Option("--surfaces", SURFACES, "surfaces of each condition"),
    Option("--workers", 1, "processes for loops of a condition"),
    Option("--refined", 3, "conditions that run on half and twice the points, too"),
    Option("--minutes", 0.0, "time after which no further condition begins; 0: none"),
    Option("-o, --output", Path, "dataset that collect writes"),
    FIGURE,
    interrupted="finished states are kept; run again to resume",
)

if __name__ == "__main__":
    sys.exit(main())
