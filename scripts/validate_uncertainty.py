"""Intervals and shares of variance from theory and few simulations, beside those of 200 simulations.

python -m scripts.validate_uncertainty
"""

import argparse
import copy
import sys
import time
import warnings
from pathlib import Path
from typing import Any

import xarray as xr

import contact_study
from bem_adhesion.study.sensitivity import sensitivity
from scripts.harness import Option, program, show

DRAWS = 200
STUDY: dict[str, dict[str, Any]] = {
    "surface": {"kind": "self_affine", "size": 1e-6, "shape": [64, 64], "rms_height": 5e-9, "hurst_exponent": 0.8}
    | {"roll_off_mode": 2, "cutoff_mode": 8, "seed": 1},
    "material": {"youngs_modulus": 50e6, "poissons_ratio": 0.49},
    "interaction": {"law": "exponential", "work_of_adhesion": 1e-3, "length": 3e-9},
    "loading": {"path": [1e5, 5e5]},
    "theory": {"flows": "none", "spectrum": "analytic"},
    "uncertainty": {
        "draws": DRAWS,
        "material.youngs_modulus": {"distribution": "lognormal", "relative_error": 0.2},
        "interaction.work_of_adhesion": {"distribution": "lognormal", "relative_error": 0.25},
        "interaction.length": {"distribution": "uniform", "low": 2e-9, "high": 4e-9},
        "surface.hurst_exponent": {"distribution": "normal", "error": 0.04},
        "surface.rms_height": {"distribution": "normal", "relative_error": 0.08},
    },
}
LOOP = {"control": "gap", "path": [2e-8, 8e-9, 6e-9, 4e-9], "unload": True, "adaptive": True}
PATH_ANSWERS = ["relative_contact_area", "mean_gap", "converged"]
LOOP_ANSWERS = ["pull_off_pressure", "work_of_separation"]
ANSWERS = {
    "relative_contact_area": ("area", 1.0),
    "mean_gap": ("gap (nm)", 1e-9),
    "pull_off_pressure": ("pull-off (kPa)", 1e3),
    "work_of_separation": ("work (mJ/m²)", 1e-3),
}


def run(given: argparse.Namespace) -> None:
    folder = Path(given.folder)
    folder.mkdir(parents=True, exist_ok=True)
    theory, found = computed(folder), dict[str, dict[str, xr.Dataset]]()
    for loop in (False, True):
        truth = simulated(folder, loop)
        whole = theory.drop_dims("step") if loop else theory[PATH_ANSWERS]
        for way, one in (ways(truth, whole, given.anchors) | ({} if loop else by_gradient(truth, whole))).items():
            for name in LOOP_ANSWERS if loop else PATH_ANSWERS[:2]:
                found.setdefault(way, {})[name] = one
    rows = [
        (way, *(cell for name in ANSWERS for cell in (cells(name, by[name]) if name in by else ("", ""))))
        for way, by in found.items()
    ]
    show(("from", *(word for title, _ in ANSWERS.values() for word in (title, "E/w/r/H/h"))), rows)


def ways(truth: xr.Dataset, theory: xr.Dataset, count: int) -> dict[str, xr.Dataset]:
    """Intervals and shares from all simulations, from theory, and from theory with few of the simulations."""
    few, bare = truth.isel(draw=slice(0, count)), truth.drop_vars([*truth.data_vars])
    return {
        "brute force": contact_study.uncertainty(truth),
        "theory": contact_study.uncertainty(theory),
        "theory, 1 sim.": contact_study.uncertainty(theory, truth.isel(draw=[0])),
        f"theory, {count} sim.": contact_study.uncertainty(theory, few),
        f"{count} sim.": contact_study.uncertainty(bare, few),
    }


def simulated(folder: Path, loop: bool) -> xr.Dataset:
    """All draws by simulation, under pressure or around a loop; kept in the folder."""
    study = copy.deepcopy(STUDY)
    if loop:
        study["loading"] = LOOP
    found = timed(study, "continuum", folder / ("loop.nc" if loop else "bem.nc"))
    if loop:
        return found[LOOP_ANSWERS]
    return found[PATH_ANSWERS]


def computed(folder: Path) -> xr.Dataset:
    """All draws by Persson's theory; kept in the folder."""
    found = timed(copy.deepcopy(STUDY), "theory", folder / "theory.nc").isel(theory=0)
    return found[[*PATH_ANSWERS, "pull_off_pressure"]]


def by_gradient(truth: xr.Dataset, theory: xr.Dataset) -> dict[str, xr.Dataset]:
    """Answers by the central simulation and its derivatives, alone, and by theory that they correct."""
    central = sensitivity(contact_study.make_study(copy.deepcopy(STUDY)))
    bare = truth.drop_vars([*truth.data_vars])
    return {
        "gradient": contact_study.uncertainty(bare, central),
        "theory, gradient": contact_study.uncertainty(theory, central),
    }


def timed(study: dict[str, Any], model: str, output: Path) -> xr.Dataset:
    began = time.time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the small grid
        found = contact_study.run(study, model, output=output, resume=output.exists())
    print(f"{output}: {time.time() - began:.0f} s", file=sys.stderr)
    return found


def cells(name: str, found: xr.Dataset) -> tuple[str, str]:
    """Quantiles of an answer, at the first load, and the shares of the keys in per cent."""
    if name not in found or found[name].isnull().any():
        return "", ""
    one = found.isel(step=0) if "step" in found[name].dims else found
    quantiles = (f"{float(value) / ANSWERS[name][1]:.3g}" for value in one[name].values)
    return " ".join(quantiles), "/".join(f"{100 * value:.0f}" for value in one[f"{name}_share"].values)


main = program(
    run,
    Option("--folder", "build/uncertainty", "folder of the datasets, continued if they are there"),
    Option("--anchors", 16, "number of simulations that correct the theory"),
)

if __name__ == "__main__":
    sys.exit(main())
