"""Synthetic experiments of known constants, with noise: how often the 90 % intervals of an inference hold them.

python -m scripts.validate_inference spheres
    python -m scripts.validate_inference rough
    git clone https://github.com/AFM-analysis/nanite build/nanite
    python -m scripts.validate_inference published --folder build/nanite

The last compares with values of others: force curves of nanite (Müller et al. 2019, doi 10.1186/s12859-019-3010-3).
"""

import argparse
import json
import sys
import time
import warnings
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

import contact_study
from contact_study.inference.library import infer
from contact_study.inputs.units import stress
from contact_study.physics.spheres import JKR, MaugisDugdale, SphereTheory
from contact_study.plots.force_curves import force_states
from scripts.harness import Option, program, show

EXPERIMENTS = 50
TRUTHS = 10  # simulated probes of the rough experiments, each with several noises
START, DEPTH, LENGTH = 2.5e-8, 7e-9, 5e-10  # path of the rough probe (m); its noise in units of that of the force
LOOPS = "build/inference_loops"
STUDY: dict[str, dict[str, Any]] = {
    "form": {"kind": "paraboloid", "radii": 1e-6},
    "surface": {"kind": "self_affine", "size": 3.6e-7, "shape": [40, 40], "rms_height": 1e-9}
    | {"hurst_exponent": 0.8, "low_mode": 3, "roll_off_mode": 3, "cutoff_mode": 8},
    "material": {"youngs_modulus": 1e9, "poissons_ratio": 0.0},
    "elasticity": {"boundary": "free"},
    "interaction": {"law": "exponential", "work_of_adhesion": 0.05, "length": 2e-9},
}
POINTS = 150  # of a force curve on each way
_ABBREVIATED = {"work_of_adhesion": "w", "contact_modulus": "E*", "range": "range"}


class Experiment(NamedTuple):
    """A synthetic curve, its true constants, and what the inference is given."""

    curve: xr.Dataset
    truth: Mapping[str, float]
    options: Mapping[str, object]


class PublishedCurve(NamedTuple):
    """A force curve in the repository nanite, the radius (m) of its probe, and the modulus (Pa) that others found."""

    title: str
    path: str
    radius: float
    modulus: float
    found_by: str


PUBLISHED = (
    PublishedCurve(  # tests/test_model_hertz_parabol.py: "fit results in the JPK analysis software"
        "tip of 40 nm", "tests/data/fmt-jpk-fd_spot3-0192.jpk-force", 40e-9, 233.1e3, "software of the microscope"
    ),
    PublishedCurve(  # examples/fit_and_rate.py and its figure; points at the begin of contact count less there
        "bead of 18.6 µm on tissue",
        "examples/data/zebrafish-head-section-gray-matter.jpk-force",
        18.64e-6,
        77.0,
        "nanite",
    ),
)
_INCOMPRESSIBLE = 0.5  # Poisson's ratio of both


def run(given: argparse.Namespace) -> None:
    if given.what == "published":
        head = ("curve", "E by others", "of", "E, errors of both axes", "E, errors of the force alone")
        show(head, [compared(one, Path(given.folder)) for one in PUBLISHED])
        return
    rows = [row for name, make in KINDS[given.what].items() for row in covered(name, make, given.experiments)]
    show(("experiments", "parameter", "true value inside", "error", "half width of the interval", "seconds each"), rows)


def covered(name: str, make: Callable[[int], Experiment], count: int) -> list[tuple[str, ...]]:
    """Rows of a table: how many intervals hold the true value, and medians of error and width."""
    inside: dict[str, list[bool]] = {}
    errors: dict[str, list[float]] = {}
    widths: dict[str, list[float]] = {}
    began = time.process_time()
    for seed in range(count):
        one = make(seed)
        found = infer(one.curve, **one.options).isel(model=0)
        for parameter, true in one.truth.items():
            low, high = (float(found[f"{parameter}_{end}"]) for end in ("lower", "upper"))
            inside.setdefault(parameter, []).append(not (low > true or high < true))  # NaN: open
            errors.setdefault(parameter, []).append(abs(float(found[parameter]) / true - 1))
            widths.setdefault(parameter, []).append(0.5 * (high - low) / true)
        print(f"{name} {seed}: {[(p, v[-1]) for p, v in inside.items()]}", file=sys.stderr)
    seconds = (time.process_time() - began) / count
    return [
        (
            name,
            _ABBREVIATED[parameter],
            f"{sum(held)} of {count}",
            f"{100 * np.median(errors[parameter]):.1f} %",
            _per_cent(widths[parameter]),
            f"{seconds:.1f}",
        )
        for parameter, held in inside.items()
    ]


def compared(one: PublishedCurve, folder: Path) -> tuple[str, ...]:
    """Row of a table: the modulus that others found, and that of Hertz' theory on the approach, with its interval."""
    whole = contact_study.read_force_curve(folder / one.path)
    approach = whole.isel(point=whole["branch"].values == 0)
    cells = []
    for noise in ({}, {"displacement": 0.0}):
        found = infer(approach, ["hertz"], fixed={"radius": one.radius}, noise=noise).isel(model=0)
        moduli = ((1 - _INCOMPRESSIBLE**2) * float(found[f"contact_modulus{end}"]) for end in ("", "_lower", "_upper"))
        value, low, high = (stress(modulus) for modulus in moduli)
        cells.append(f"{value} ({low} to {high})")
    return (one.title, stress(one.modulus), one.found_by, *cells)


def _per_cent(widths: list[float]) -> str:
    closed = np.isfinite(widths)
    if closed.mean() < 0.5:
        return "open"
    return f"{100 * np.median(np.array(widths)[closed]):.1f} %"


def jkr_probe(seed: int) -> Experiment:
    """A soft sphere on a cantilever."""
    random = np.random.default_rng(seed)
    theory = JKR(5e-6, 1e6 * random.lognormal(0, 0.3), 0.05 * random.lognormal(0, 0.3))
    pull = -theory.pull_off_force
    curve = on_spring(theory, 1.5 * pull, pull / 1e-6, random, 0.02 * pull, 2e-9)
    options = {"models": ["jkr"], "fixed": {"radius": 5e-6}, "spring_constant": pull / 1e-6}
    return Experiment(curve, _truth(theory), options)


def maugis_probe(seed: int) -> Experiment:
    """A sphere between JKR's and DMT's limits, on a stiff cantilever."""
    random = np.random.default_rng(seed)
    work, modulus, radius = 0.05 * random.lognormal(0, 0.2), 1e8 * random.lognormal(0, 0.2), 1e-6
    length = np.cbrt(radius * (work / modulus) ** 2)
    reach = length / random.uniform(0.5, 1.5)  # Tabor parameter
    theory = MaugisDugdale(radius, modulus, work, work / reach)
    pull = -theory.pull_off_force
    curve = on_spring(theory, 1.5 * pull, 10 * pull / length, random, 0.01 * pull, 0.005 * length)
    options = {"models": ["maugis"], "fixed": {"radius": radius}, "spring_constant": 10 * pull / length}
    return Experiment(curve, _truth(theory) | {"range": float(reach)}, options)


def jkr_test(seed: int) -> Experiment:
    """Contact radii under forces, with errors of the radius."""
    random = np.random.default_rng(seed)
    theory = JKR(1e-3, 1e6 * random.lognormal(0, 0.3), 0.05 * random.lognormal(0, 0.3))
    forces = np.linspace(-0.8, 4.0, 25) * -theory.pull_off_force
    radii = np.array([theory.at_force(force)[2] for force in forces])
    radii = radii + 0.01 * radii.max() * random.normal(size=radii.size)
    curve = xr.Dataset({"total_force": ("point", forces), "contact_radius": ("point", radii)})
    return Experiment(curve, _truth(theory), {"models": ["jkr"], "fixed": {"radius": 1e-3}})


def _truth(theory: JKR | MaugisDugdale) -> dict[str, float]:
    return {"work_of_adhesion": theory.work_of_adhesion, "contact_modulus": theory.contact_modulus}


def on_spring(
    theory: SphereTheory, force: float, stiffness: float, random: np.random.Generator, noise: float, jitter: float
) -> xr.Dataset:
    """Curve of a sphere on a spring (N/m) up to a force (N), with noise of force (N) and of the machine (m)."""
    states = theory.curve(force, points=20_000)
    at = states.displacement + states.force / stiffness
    fold = at.size - 1 - int(np.argmax(np.diff(at)[::-1] < 0)) if (np.diff(at) < 0).any() else 0
    tip = int(np.argmax(np.diff(at) < 0)) if fold else 0
    machine = np.linspace(at[fold] - 0.7 * (at[-1] - at[fold]), at[-1], POINTS)
    loose = np.interp(machine, at[: tip + 1], states.force[: tip + 1], left=0.0)
    pressed = np.interp(machine, at[fold:], states.force[fold:])
    way_in = np.where(machine > max(at[tip], states.displacement[0]), pressed, np.where(machine < at[0], 0.0, loose))
    way_out = np.where(machine > at[fold], pressed, loose)
    moved = np.concatenate([machine, machine[::-1]])
    forces = np.concatenate([way_in, way_out[::-1]])
    moved = moved + jitter * random.normal(size=moved.size)
    forces = forces + noise * random.normal(size=forces.size)
    branch = np.repeat([0, 1], POINTS)
    values = {"total_force": ("point", forces), "displacement": ("point", moved - forces / stiffness)}
    return xr.Dataset(values, {"branch": ("point", branch)}, {"title": "synthetic"})


def rough_probe(seed: int) -> Experiment:
    """A rough sphere, by a simulation at a w/E* between those of the loops."""
    random = np.random.default_rng(seed % TRUTHS)
    work, modulus = 0.05 * random.lognormal(0, 0.1), 1e9 * random.lognormal(0, 0.1)
    curve = measured_loop(STUDY, work, modulus, np.random.default_rng(1000 + seed), 0.02, 80)
    return Experiment(curve, {"work_of_adhesion": work, "contact_modulus": modulus}, {"study": STUDY, "loops": LOOPS})


def measured_loop(
    study: Mapping[str, Mapping[str, object]],
    work: float,
    modulus: float,
    random: np.random.Generator,
    noise: float,
    points: int = POINTS,
) -> xr.Dataset:
    """Curve of a simulated probe, with noise of the force over its largest tension."""
    moved, forces, outwards = _loop(json.dumps(study), work, modulus, points)
    forces = forces - noise * forces.min() * random.normal(size=forces.size)
    moved = moved + noise * LENGTH * random.normal(size=forces.size)
    variables = {"total_force": ("point", forces), "displacement": ("point", moved)}
    return xr.Dataset(variables, {"branch": ("point", outwards.astype(int))}, {"title": "rough probe"})


@cache
def _loop(study: str, work: float, modulus: float, points: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Displacements (m), forces (N) and directions of a loop through the measured displacements."""
    table = json.loads(study)
    table["material"]["youngs_modulus"], table["interaction"]["work_of_adhesion"] = modulus, work
    places = np.linspace(-START, DEPTH, points)
    loading = {"control": "approach", "path": [*places, *places[-2::-1]]}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the coarse grid
        return force_states(contact_study.run({**table, "loading": loading}))


KINDS = {
    "rough": {"rough probe, simulated loops": rough_probe},
    "spheres": {
        "soft probe on a cantilever, JKR": jkr_probe,
        "probe of Tabor parameter 0.5 to 1.5, Maugis": maugis_probe,
        "JKR test": jkr_test,
    },
}

main = program(
    run,
    Option("what", str, "which experiments", choices=(*KINDS, "published")),
    Option("--experiments", EXPERIMENTS, "number of each"),
    Option("--folder", "build/nanite", "clone of nanite, for published"),
)

if __name__ == "__main__":
    sys.exit(main())
