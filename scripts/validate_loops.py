"""What loops of the contact atlas lose, and what they remember of their turning points, as Markdown.

x is Maugis' number of the mean asperity over that from which one jumps. `reloading` simulates, others read the atlas.

python -m scripts.validate_loops losses        # Γ of the work that loops lose
python -m scripts.validate_loops preloads      # what a smaller preload changes on unloading
python -m scripts.validate_loops reloading     # the way from a turning point on unloading back to loading
"""

import argparse
import itertools
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from scipy.optimize import minimize_scalar

from contact_study.atlas.design import JUMPING, LEAST_JUMP, STRESS, Condition, design
from contact_study.atlas.loops import file_of, run_under_pressures, seeds_of
from contact_study.physics.laws import LAWS
from contact_study.physics.spheres.numbers import maugis_parameter
from scripts.atlas_tables import AREA, LIGHTEST, MARKERS, by_number, deepest, lost_of, read, stress_of
from scripts.harness import Option, minus, program, show
from scripts.summit_losses import TABLE as SUMMITS_TABLE
from scripts.summit_losses import ratio_of_summits
from scripts.validate_hysteresis import JUMPING_DATA, LEAST, choosing_half
from theory.edge_flow.apparent_adhesion import adhesion_ratio

ONSETS = 0.0, 1.1, 1.3, 1.5, 1.8, 2.3, 9.0  # bins of x
RELOADED = 743, 889, 19, 1125, 127, 187, 577, 535  # conditions of small grids, by x
TURN, LOWEST, STEPS = 0.4, 0.04, 7  # turning points over E* h'/2, and states of a way between them
SHOWN = 1, 2, 3  # states after the turning point
ADHESIONS = 0.0, 0.5, 1.0, 2.0, 3.1  # bins of θ
LEAST_X = 1.2  # from which a loss over x² − 1 has a meaning
FIRST_JUMPS = {"dugdale": 0.55}  # λ₁ where it is not the law's: first jumps of a sharp end, from ``scripts.jump_onset``
SUMMITS = 1.66  # mean √(κ₁κ₂) of summits of a Gaussian surface over rms(∇²h)/2
OPEN = 0.004  # area between the branches where a share of it has a meaning


def of_mean_summit(x: np.ndarray) -> np.ndarray:
    """Return x² − 1 of the mean summit from x of the mean asperity, 0 below one."""
    return np.maximum(x**2 / SUMMITS ** (2 / 3) - 1, 0)


FORMS: dict[str, Callable[[np.ndarray, np.ndarray], np.ndarray]] = {  # of Γ − 1 over k, by x and θ
    "x² − 1": lambda x, adhesion: x**2 - 1,
    "x_s² − 1": lambda x, adhesion: of_mean_summit(x),
    "(x² − 1) min(1, 1/θ)": lambda x, adhesion: (x**2 - 1) * np.minimum(1, 1 / adhesion),
}


def run(given: argparse.Namespace) -> None:
    ACTIONS[given.action](given)


def losses(given: argparse.Namespace) -> None:
    """Print Γ_D = 1 + D/(Δγ ΔA) by x, beside Γ; D is lost from the lightest pressure to the preload and back.

    A second table has k by law: of the loss, in place of the area. A third has forms of Γ − 1 over k, with k of the
    half of the conditions that chooses, and beside them Γ of summits that lose what they lose alone. A fourth has its
    share of the loss by adhesion.
    """
    found = [(*pair, one) for one in deepest(read(given.file)) if (pair := measured_ratio(one))]
    number, ratio = np.array([each[:-1] for each in found]).T
    law = np.array([str(each[-1]["law"].values) for each in found])
    adhesion = np.array([float(each[-1]["relative_adhesion"]) for each in found])
    chose = choosing_half()
    chooses = np.array([int(each[-1]["condition"]) in chose for each in found])
    single = pd.read_csv(SUMMITS_TABLE)
    summits = np.array([_sum_of_summits(single, each[0], each[-1]) for each in found])
    rows = []
    for _, some in _binned(number):
        words = f"{number[some].min():.2f} … {number[some].max():.2f}"
        medians = (np.median(values[some]) for values in (ratio, adhesion_ratio(number), summits))
        rows.append((words, some.sum(), *(f"{median:.3f}" for median in medians)))
    show(("x", "loops", "Γ_D: median", "Γ: median", "Γ of summits: median"), rows)
    print()
    rows = []
    for name, onset in [*((name, LAWS[name].jump_onset) for name in MARKERS), *FIRST_JUMPS.items()]:
        own = number * LAWS[name].jump_onset / onset
        some = (law == name) & (own > LEAST_X)
        growth = (ratio[some] - 1) / (own[some] ** 2 - 1)
        rows.append((MARKERS[name][0], f"{onset:g}", some.sum(), _median_and_range(growth, 3, 3)))
    show(("law", "λ₁", "loops", "(Γ_D − 1)/(x² − 1): median (range)"), rows)
    print()
    rows = []
    for onset, (words, form) in itertools.product((LAWS["dugdale"].jump_onset, FIRST_JUMPS["dugdale"]), FORMS.items()):
        shape = form(np.where(law == "dugdale", number * LAWS["dugdale"].jump_onset / onset, number), adhesion)
        growth = _fitted(shape[chooses], ratio[chooses] - 1)
        errors = np.abs(1 + growth * shape - ratio)
        rows.append((words, f"{onset:g}", f"{growth:.3f}", *_of_halves(errors, chooses)))
    rows.append(("summits, nothing fitted", "–", "–", *_of_halves(np.abs(summits - ratio), chooses)))
    columns = "mean size of Γ − Γ_D, half that chooses", "half that judges"
    show(("(Γ − 1)/k", "λ₁ of Dugdale's law", "k", *columns), rows)
    print()
    rows = []
    for low, high in itertools.pairwise(ADHESIONS):
        some = (adhesion >= low) & (adhesion < high)
        if some.any():
            share = (summits[some] - 1) / (ratio[some] - 1)
            rows.append((f"{low:g} … {high:g}", some.sum(), _median_and_range(share, 2)))
    show(("θ", "loops", "(Γ of summits − 1)/(Γ_D − 1): median (range)"), rows)


def _of_halves(errors: np.ndarray, chooses: np.ndarray) -> list[str]:
    return [f"{errors[some].mean():.3f}" for some in (chooses, ~chooses)]


def _sum_of_summits(single: pd.DataFrame, number: float, one: xr.Dataset) -> float:
    """Return Γ of the loop's summits, from x and the losses of single ones."""
    law, reduced = str(one["law"].values), float(one["work_of_adhesion"] / one["contact_modulus"])
    moments = float(one["rms_slope"]), float(one["rms_curvature"])
    return ratio_of_summits(single, law, number * LAWS[law].jump_onset, moments, reduced)


def _fitted(shape: np.ndarray, excess: np.ndarray) -> float:
    """Return the factor of a shape with the least mean size of errors."""
    return float(minimize_scalar(lambda k: np.abs(k * shape - excess).mean(), bounds=(0, 1), method="bounded").x)


def _binned(number: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    """Yield the bins of x that have members: their limits in words, and a mask of the members."""
    for low, high in itertools.pairwise(ONSETS):
        some = (number >= low) & (number < high)
        if some.any():
            yield f"{low:g} … {high:g}", some


def _median_and_range(values: np.ndarray, digits: int, of_range: int = 2) -> str:
    known = values[np.isfinite(values)]
    if not known.size:
        return ""
    return f"{np.median(known):.{digits}f} ({known.min():.{of_range}f} … {known.max():.{of_range}f})"


def preloads(given: argparse.Namespace) -> None:
    """Print how far unloading from a smaller preload reaches the branch of the largest, and the pull-off of both."""
    data, found = read(given.file), []
    for one in deepest(data):
        small = data.sel(condition=int(one["condition"]), surface=int(one["surface"])).isel(preload=0)
        if small["mean_pressure"].isnull().all():
            continue
        loads, places = zip(*(_ways(each) for each in (one, small)), strict=True)
        (load, back), (_, early) = places
        shared = loads[1] / 2  # where the early way out has come off its turning point
        if shared < LIGHTEST:
            continue
        rising, wide, narrow = (float(np.interp(np.log(shared), *way)) for way in (load, back, early))
        share = (narrow - rising) / (wide - rising) if wide - rising > LEAST else np.nan
        if measured := measured_ratio(one):
            found.append((measured[0], share, float(small["pull_off_pressure"] / one["pull_off_pressure"])))
    number, shares, ratios = np.array(found).T
    rows = [
        (words, some.sum(), _median_and_range(shares[some], 2), _median_and_range(ratios[some], 3))
        for words, some in _binned(number)
    ]
    show(("x", "loops", "share of the branch reached: median (range)", "ratio of pull-offs"), rows)


def reloading(given: argparse.Namespace) -> None:
    """Print how far reloading from a light load is from first loading, in parts of what unloading is, over the load."""
    pressures = np.geomspace(LOWEST, TURN, STEPS)
    rows = []
    for condition in by_number(design(JUMPING, least_jump=LEAST_JUMP)[0], given.numbers):
        first, back, again = turned(condition, pressures, given)
        opened = back - first
        shares = np.where(opened > OPEN, (again - first) / np.where(opened > OPEN, opened, 1.0), np.nan)
        cells = (f"{shares[place]:.2f}" if np.isfinite(shares[place]) else "" for place in SHOWN)
        head = condition.number, f"{condition.relative_adhesion:.2f}", f"{condition.jump_ratio:.2f}"
        rows.append((*head, f"{opened.max():.3f}", *cells, minus(f"{again[-1] / first[-1] - 1:+.4f}")))
    loads = (f"at {pressures[place] / LOWEST:.2g} times the lowest load" for place in SHOWN)
    show(("condition", "θ", "x", "largest opening", *loads, "change of the area at the turning point"), rows)


def turned(condition: Condition, pressures: np.ndarray, given: argparse.Namespace) -> np.ndarray:
    """Return mean areas on loading, unloading and reloading at rising pressures over E* h'/2, shape (3, pressures)."""
    seeds = seeds_of(condition, given.surfaces)
    path = np.concatenate([pressures, pressures[-2::-1], pressures[1:]])
    output = file_of(given.folder, condition, "reloading")
    found = run_under_pressures(condition, output, seeds, (path * STRESS).tolist())
    area = found[AREA].mean("seed").values
    count = pressures.size
    return np.stack([area[:count], area[2 * count - 2 : count - 2 : -1], area[2 * count - 2 :]])


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
    area, lost = one[AREA].values[there], lost_of(one).values[there]
    start, end = _crossing(pressure[: turn + 1][::-1]), _crossing(pressure[turn:])
    if start is None or end is None:
        return None
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


ACTIONS = {"losses": losses, "preloads": preloads, "reloading": reloading}

main = program(
    run,
    Option("action", str, "table", choices=tuple(ACTIONS)),
    Option("file", JUMPING_DATA, "dataset of the atlas", type=Path),
    Option("--folder", Path("build/reloading"), "folder of the runs of reloading", type=Path),
    Option("--surfaces", 4, "of each condition that is reloaded"),
    Option("--numbers", list(RELOADED), "conditions that are reloaded"),
    interrupted="finished runs are kept; run again to resume",
)

if __name__ == "__main__":
    sys.exit(main())
