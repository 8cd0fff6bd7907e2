"""Loops of a condition: approach from separation, loading to a preload, retraction to pull-off; and its theories.

A stiff machine prescribes the approach. The preload is the force at which the way in ends, so that loops to several
preloads are one sweep. All runs are campaigns: they resume, and their cases run on processes.
"""

import json
import time
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.atlas.design import MODULUS, POISSONS_RATIO, SIZE, STRESS, Condition
from contact_study.campaign.library import run

PRELOADS = (0.1, 0.4, 2.0)  # over the stress E* h'/2
REFINEMENTS = (0.5, 2.0)  # of the grid, to extrapolate its error
# Decay lengths of repulsions from which the flows are extrapolated to a wall, over the rms height; and the longest over
# the law's range.
CORES = 0.002, 0.004
LONGEST_CORE = 0.02
# At the edge of a contact with a wall the gap rises with the power 3/2 of the distance. So the area of small gaps, such
# as count as contact with a core, falls with the power 2/3 of the decay length.
AREA_POWER = 2 / 3
# Approaches over the rms height: contact begins near zero and is full near four.
_APPROACHES = (0.0, 0.5, *np.arange(1.0, 4.1, 0.25).tolist(), 6.0)
_APART = 2.0, 3.0  # rms heights and lengths of the law between start and first touch
_STIFFNESS = 100.0  # of the machine, over E* L; that of the longest wave is π
_RESOLUTION = 0.05  # least step over five lengths of the law


def study_of(
    condition: Condition, seeds: Sequence[int], refinement: float = 1.0, preloads: Sequence[float] = PRELOADS
) -> dict[str, Any]:
    """Make the study of a condition's loops, on its grid or on another.

    Parameters
    ----------
    condition : Condition
        One of :func:`contact_study.atlas.design.design`.
    seeds : sequence of int
        Surfaces.
    refinement : float, optional
        Points a side over those of the condition.
    preloads : sequence of float, optional
        Rising, over the stress E* h'/2.

    Returns
    -------
    dict
        As for :func:`contact_study.run`.
    """
    points = round(condition.points * refinement / 2) * 2
    height = condition.spectrum.rms_height
    start = -(_APART[0] * height + _APART[1] * condition.length)
    forces = [preload * STRESS * SIZE**2 for preload in preloads]
    solid: dict[str, Any] = {"kind": condition.solid}
    if condition.solid == "layer":
        solid["thickness"] = condition.thickness
    return {
        "study": {"title": f"contact atlas, condition {condition.number}"},
        "surface": _surface(condition, points),
        "material": {"youngs_modulus": MODULUS * (1 - POISSONS_RATIO**2), "poissons_ratio": POISSONS_RATIO},
        "elasticity": solid,
        "interaction": _interaction(condition),
        "loading": {
            "control": "approach",
            "path": [start, *(share * height for share in _APPROACHES)],
            "unload": True,
            "adaptive": True,
            "resolution": _RESOLUTION,
            "machine_stiffness": _STIFFNESS * MODULUS * SIZE,
            "trigger_force": forces[-1],
        },
        "solver": {"threads": 1},
        "output": {"restart": False, "gap_bins": 1000, "pressure_bins": 1000},
        "sweep": {"surface.seed": list(seeds), "loading.trigger_force": forces},
    }


def theory_study_of(condition: Condition, seed: int, pressures: Sequence[float], core: float = 0.0) -> dict[str, Any]:
    """Make the study of every theory, fed with the spectrum of one surface, at the pressures of a loop (Pa).

    The flows go through no wall. A ``core``, over the law's range, replaces a wall by a repulsion of that decay length;
    at gaps within two of them points count as contact.
    """
    study = study_of(condition, [seed])
    del study["sweep"], study["output"]
    study["surface"]["seed"] = seed
    if core:
        given = study["interaction"]
        length = given["length"]
        contact = {"range": length, "core": core * length, "contact_distance": (1 + 2 * core) * length}
        study["interaction"] = {**given, "law": f"{given['law']}_core", **contact}
    return {**study, "loading": {"path": list(pressures)}, "theory": {"spectrum": "surface"}}


def theory_files(condition: Condition, folder: Path, seed: int) -> dict[float, Path]:
    """Return the files of a surface's theories by the core of the law, 0 for its own."""
    cores = dict.fromkeys((0.0, *cores_of(condition)))
    return {core: file_of(folder, condition, f"theory{seed}{f'core{core:.2g}' * bool(core)}") for core in cores}


def cores_of(condition: Condition) -> tuple[float, ...]:
    """Return the decay lengths, over the law's range, of the repulsions in place of a wall; 0 for a law without."""
    if not condition.traction_law.has_wall:
        return (0.0,)
    unit = min(condition.spectrum.rms_height / condition.length, LONGEST_CORE / CORES[-1])
    return tuple(core * unit for core in CORES)


def without_core(results: Sequence[np.ndarray], power: float = 1.0, cores: Sequence[float] = CORES) -> np.ndarray:
    """Extrapolate what all cores give to a wall, by the polynomial of their power; else the first result stands."""
    if len(results) != len(cores):
        return results[0]
    lengths = np.power(cores, power)
    weights = [np.prod([other / (other - own) for other in lengths if other != own]) for own in lengths]
    return sum(weight * result for weight, result in zip(weights, results, strict=True))


def _surface(condition: Condition, points: int) -> dict[str, Any]:
    low, roll_off, cutoff = condition.modes
    return {
        "kind": "self_affine",
        "size": SIZE,
        "shape": [points, points],
        "hurst_exponent": condition.hurst_exponent,
        "rms_height": condition.spectrum.rms_height,
        "low_mode": low,
        "roll_off_mode": roll_off,
        "cutoff_mode": cutoff,
        "normalisation": "realised",
    }


def _interaction(condition: Condition) -> dict[str, Any]:
    return {
        "law": condition.law,
        "work_of_adhesion": condition.work_of_adhesion,
        "length": condition.length,
    }


def seeds_of(condition: Condition, surfaces: int) -> list[int]:
    """Return seeds of a condition's surfaces, which no other condition has."""
    return [100 * condition.number + surface for surface in range(1, surfaces + 1)]


def surface_of(condition: Condition, seed: int) -> int:
    """Return the number of the surface of a seed."""
    return seed - 100 * condition.number


def file_of(folder: Path, condition: Condition, kind: str = "loops") -> Path:
    """Return the file of a condition's loops, refined loops or theories."""
    return folder / f"{condition.number:04d}_{kind}.nc"


def run_condition(
    condition: Condition,
    folder: Path,
    surfaces: int = 1,
    refinements: Sequence[float] = (),
    workers: int = 1,
    preloads: Sequence[float] = PRELOADS,
    first: int = 1,
) -> None:
    """Run what a folder lacks of a condition: its loops, those on other grids, and its theories.

    The first surface has loops to all preloads, further ones to the largest: on the way in that holds the others, and
    pull-off hardly depends on the preload.

    Parameters
    ----------
    condition : Condition
        One of :func:`contact_study.atlas.design.design`.
    folder : pathlib.Path
        Where its datasets and its processor time are kept.
    surfaces : int, optional
        Number of surfaces.
    refinements : sequence of float, optional
        Further grids of surface 1, for the loop to the largest preload; none where it is not run.
    workers : int, optional
        Number of processes.
    preloads : sequence of float, optional
        As for :func:`study_of`.
    first : int, optional
        First of the surfaces that are run.
    """
    folder.mkdir(parents=True, exist_ok=True)
    seeds = seeds_of(condition, surfaces)[first - 1 :]
    loops = []
    for path, some in loop_files(condition, folder, seeds).items():
        to = preloads if surface_of(condition, some[0]) == 1 else preloads[-1:]
        loops.append(_run(study_of(condition, some, preloads=to), "continuum", path, workers))
    for factor in refinements if first == 1 else ():
        study = study_of(condition, seeds[:1], factor, preloads[-1:])
        _run(study, "continuum", file_of(folder, condition, f"grid{factor:g}"), workers)
    for found in loops:
        for seed in found["seed"].values.tolist():
            pressures = theory_pressures(found.sel(seed=seed).isel(trigger_force=-1))
            run_theories(condition, folder, seed, pressures.tolist())


def loop_files(condition: Condition, folder: Path, seeds: Sequence[int]) -> dict[Path, list[int]]:
    """Return the seeds whose loops are in each file: the first surface, with all preloads, has its own."""
    first = seeds_of(condition, 1)
    own, further = ([seed for seed in seeds if (seed in first) == holds] for holds in (True, False))
    files = {file_of(folder, condition): own, file_of(folder, condition, "further"): further}
    return {path: some for path, some in files.items() if some}


def run_theories(condition: Condition, folder: Path, seed: int, pressures: Sequence[float]) -> list[Path]:
    """Run what a folder lacks of the theories of one surface at pressures (Pa), and return their files."""
    files = theory_files(condition, folder, seed)
    for core, path in files.items():
        _run(theory_study_of(condition, seed, pressures, core), "theory", path, 1)
    return list(files.values())


def run_under_pressures(
    condition: Condition, output: Path, seeds: Sequence[int], pressures: Sequence[float], workers: int = 1
) -> xr.Dataset:
    """Run, or read, a condition's surfaces under a path of pressures (Pa) in place of loops; it resumes."""
    study = study_of(condition, seeds)
    study |= {"loading": {"path": list(pressures)}, "sweep": {"surface.seed": list(seeds)}}
    output.parent.mkdir(parents=True, exist_ok=True)
    return run(study, output=output, resume=True, workers=workers)


def _run(study: dict[str, Any], model: str, output: Path, workers: int) -> xr.Dataset:
    """Run a study, or read what is there; the processor time of its runs goes beside it."""
    before, began = _changed(output), _processor_time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of states that did not converge: the dataset has flags
        found = run(study, model, output=output, resume=True, workers=workers)
    beside = output.with_suffix(".json")
    if _changed(output) != before or not beside.exists():
        known = json.loads(beside.read_text())["processor_time"] if beside.exists() else 0.0
        beside.write_text(json.dumps({"processor_time": known + _processor_time() - began}))
    return found


def _changed(path: Path) -> int:
    """Return when a file was changed (ns), 0 if there is none."""
    return path.stat().st_mtime_ns if path.exists() else 0


def _processor_time() -> float:
    """Return the processor time of this process and of those that it has waited for (s)."""
    import resource

    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + used.ru_utime + used.ru_stime


def theory_pressures(loop: xr.Dataset) -> np.ndarray:
    """Return pressures of one loop at which theories are evaluated (Pa): rising on the way in, falling on that out."""
    pressure = loop["mean_pressure"].values
    return np.concatenate([pressure[loading_states(loop)], pressure[unloading_states(loop)]])


def loading_states(loop: xr.Dataset) -> np.ndarray:
    """Tell which steps of a loop are states of the way in under a pressure above all before."""
    pressure = loop["mean_pressure"].values
    highest = np.maximum.accumulate(np.append(0.0, np.nan_to_num(pressure[:-1])))
    return (loop["branch"].values == 0) & own_states(loop) & (pressure > highest * (1 + 1e-6))


def unloading_states(loop: xr.Dataset) -> np.ndarray:
    """Tell which steps of a loop are states of the way out under a positive pressure below all before."""
    pressure = loop["mean_pressure"].values
    back = (loop["branch"].values == 1) & own_states(loop) & np.isfinite(pressure)
    lowest = np.minimum.accumulate(np.append(np.inf, np.where(back, pressure, np.inf)[:-1]))
    return back & (pressure > 0) & (pressure < lowest * (1 - 1e-6))


def own_states(loop: xr.Dataset) -> np.ndarray:
    """Tell which steps of a loop are not the repeated state at the preload."""
    area = SIZE**2
    at_preload = np.isclose(loop["mean_pressure"].values * area, float(loop["trigger_force"]), rtol=1e-4)
    return ~(at_preload & np.append(False, at_preload[:-1]))
