"""One dataset of all conditions of the atlas: states, loops, theories and criteria."""

import itertools
import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from contact_study.atlas.design import DESIGNED, SIZE, STRESS, Condition
from contact_study.atlas.joining import concatenated, sealed
from contact_study.atlas.loops import (
    AREA_POWER,
    CORES,
    REFINEMENTS,
    file_of,
    loading_states,
    loop_files,
    own_states,
    seeds_of,
    surface_of,
    theory_files,
    unloading_states,
    without_core,
)
from contact_study.inputs.errors import InputError
from contact_study.numerics.distributions import cumulative, moments
from contact_study.results.path_results import unaccounted
from contact_study.results.schema import CONVENTIONS, variable_of
from contact_study.version import __version__

STATES = (
    "mean_pressure",
    "mean_gap",
    "mean_separation",
    "relative_contact_area",
    "relative_repulsive_area",
    "corrected_contact_area",
    "corrected_repulsive_area",
    "elastic_energy",
    "interaction_energy",
    "dissipated_energy",
    "dissipated_energy_resolution_error",
    "contact_perimeter",
    "cluster_count",
    "mean_patch_diameter",
    "largest_cluster_area",
    "converged",
    "branch",
)
_EVENTS = (
    "pull_off_pressure",
    "jump_in_pressure",
    "jump_in_separation",
    "work_of_approach",
    "work_of_separation",
)
LOOPS = tuple(f"{name}{end}" for name in _EVENTS for end in ("", "_resolution_error"))
CONSTANTS = (
    "contact_modulus",
    "work_of_adhesion",
    "interaction_length",
    "contact_distance",
    "equilibrium_distance",
    "peak_tensile_stress",
    "process_zone",
    "pixel",
    "rms_height",
    "rms_slope",
    "rms_curvature",
)
CRITERIA = (
    "finest_tabor_number",
    "persson_tosatti_ratio",
    "pastewka_robbins_ratio",
    "dmt_tension_ratio",
    "apparent_adhesion_ratio",
    "bearing_area_ratio",
    "bearing_area_pull_off",
)
THEORIES = ("persson", "gap_flow", "edge_flow")
WAYS = ("loading", "unloading")
_OF_THEORIES = (
    "relative_contact_area",
    "mean_gap",
    "converged",
    "stress_balance",
    "pull_off_pressure",
    "work_of_separation",
)
_BOUNDS = {  # that an extrapolation may miss
    "relative_contact_area": (0.0, 1.0),
    "pull_off_pressure": (-np.inf, 0.0),
    "work_of_separation": (0.0, np.inf),
}
_OF_GRIDS = (
    "mean_pressure",
    "relative_contact_area",
    "corrected_contact_area",
    "mean_gap",
    "dissipated_energy",
    "pull_off_pressure",
)
# Distributions, with the name, in the dataset, of what is distributed, its unit and edges of coarse bins over the unit.
_DISTRIBUTED = {
    "gap_pdf": ("gap", "rms_height", (0.02, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0)),
    "pressure_pdf": ("pressure", "stress_unit", (-4.0, -2.0, -1.0, -0.5, -0.2, -0.05, 0.05, 0.2, 0.5, 1.0, 2.0, 4.0)),
}
_EDGES = {
    f"{what}_edge": (f"{what}_edge", list(edges), {"units": "1", "long_name": f"edges of coarse bins over {unit}"})
    for what, unit, edges in _DISTRIBUTED.values()
}


def collect(conditions: Sequence[Condition], folder: Path, surfaces: int = 1) -> xr.Dataset:
    """Join what a folder has of the conditions; surfaces without loops or theories are left out.

    Parameters
    ----------
    conditions : sequence of Condition
        The design.
    folder : pathlib.Path
        Where :func:`contact_study.atlas.loops.run_condition` has put its datasets.
    surfaces : int, optional
        Largest number of surfaces of each condition.

    Returns
    -------
    xarray.Dataset
        States on ``condition``, ``surface``, ``preload`` and ``step``; NaN where a loop has no further state.

    Raises
    ------
    InputError
        If the folder has no finished condition.
    """
    known = {one: seeds for one in conditions if (seeds := _finished(one, folder, surfaces))}
    if not known:
        raise InputError(f"{folder}: has no finished condition; run some first")
    finished = list(known)
    parts = [_condition(one, folder, seeds) for one, seeds in known.items()]
    found = concatenated(parts, xr.Variable("condition", [one.number for one in finished]))
    found["condition"].attrs = {"units": "1", "long_name": "number of the condition in the design"}
    for name, words in DESIGNED.items():
        found[name] = ("condition", [getattr(one, name) for one in finished], {"units": "1", "long_name": words})
    found.attrs = {
        "Conventions": CONVENTIONS,
        "title": "Contact atlas: adhesive rough contacts with loading and unloading",
        "source": f"bem-adhesion {__version__}",
        "stress_unit": STRESS,
        "comment": "preloads are over stress_unit (Pa), half of the contact modulus times the rms slope",
    }
    return sealed(found)


def _finished(condition: Condition, folder: Path, surfaces: int) -> list[int]:
    """Return the seeds of the surfaces that have loops and theories."""
    files = loop_files(condition, folder, seeds_of(condition, surfaces))
    needed = {seed: [path, *theory_files(condition, folder, seed).values()] for path in files for seed in files[path]}
    return [seed for seed, paths in needed.items() if all(path.exists() for path in paths)]


def _condition(condition: Condition, folder: Path, seeds: Sequence[int]) -> xr.Dataset:
    parts = []
    for path, some in loop_files(condition, folder, seeds).items():
        with xr.open_dataset(path) as opened:
            loops = opened.load()
        parts += [_surface(condition, folder, loops.sel(seed=seed)) for seed in some]
    found = concatenated(parts, xr.Variable("surface", [surface_of(condition, seed) for seed in seeds]))
    found = found.drop_vars([name for name in ("seed", "trigger_force") if name in found.variables])
    found["preload"].attrs = {"units": "1", "long_name": "largest pressure over half of modulus times rms slope"}
    found["surface"].attrs = {"units": "1", "long_name": "number of the surface"}
    times = [json.loads(path.read_text())["processor_time"] for path in folder.glob(f"{condition.number:04d}_*.json")]
    found["processor_time"] = xr.Variable(
        (), sum(times), {"units": "s", "long_name": "processor time of the condition"}
    )
    return found.merge(_grids(condition, folder))


def _surface(condition: Condition, folder: Path, loops: xr.Dataset) -> xr.Dataset:
    """Return the loops of one surface, its constants and its theories."""
    preloads = np.round(loops["trigger_force"].values / (STRESS * SIZE**2), 9)
    ways = [_loop(loops.isel(trigger_force=place)) for place in range(preloads.size)]
    found = xr.concat(ways, xr.Variable("preload", preloads), data_vars="all")
    for name in CONSTANTS:  # alike for all preloads
        found[name] = loops[name].isel(trigger_force=0) if "trigger_force" in loops[name].dims else loops[name]
    return found.merge(_theories(theory_files(condition, folder, int(loops["seed"])), loops.isel(trigger_force=-1)))


def _loop(loop: xr.Dataset) -> xr.Dataset:
    """States of one loop that are its own, and its events."""
    there = xr.DataArray(own_states(loop), dims="step")
    found = {name: loop[name].where(there, variable_of(name).empty).assign_attrs(loop[name].attrs) for name in STATES}
    for name in LOOPS:
        known = variable_of(name)
        given = loop[name] if name in loop else xr.DataArray(np.nan)
        found[name] = given.assign_attrs(units=known.units, long_name=known.long_name)
    units = {"rms_height": float(loop["rms_height"]), "stress_unit": STRESS}
    for name, (what, unit, edges) in _DISTRIBUTED.items():
        density = loop[name].transpose("step", f"{what}_bin")
        shapes = _moments(density, what) | _coarse(density, what, units[unit] * np.array(edges))
        found |= {key: value.where(there).assign_attrs(value.attrs) for key, value in shapes.items()}
    known = variable_of("unaccounted_work")
    attributes = {"units": known.units, "long_name": known.long_name}
    found["unaccounted_work"] = (_lost(loop) - loop["dissipated_energy"]).where(there).assign_attrs(attributes)
    bare = xr.Dataset({name: value.drop_vars(list(value.coords)) for name, value in found.items()})
    return bare.assign_coords(_EDGES)


def _lost(loop: xr.Dataset) -> xr.DataArray:
    """Work of the load minus energy up to each state (J/m²): adaptive steps enter small jumps into no ledger."""
    states = np.stack([loop[f"passed_{name}"].values for name in ("pressure", "separation", "energy")], axis=-1)
    there = np.isfinite(states).all(axis=-1)
    passed, last = states[there], np.cumsum(there.sum(axis=-1)) - 1
    lost, _ = unaccounted(passed[:-1], passed[1:])
    return xr.DataArray(np.append(0.0, np.cumsum(lost))[last], dims="step")


def _moments(density: xr.DataArray, what: str) -> dict[str, xr.DataArray]:
    """Standard deviation and skewness of a distribution."""
    at = density[f"{what}_bin"]
    words = {"standard_deviation": ("standard deviation", at.attrs["units"]), "skewness": ("skewness", "1")}
    found = moments(at.values, density.values)
    return {
        f"{what}_{name}": xr.DataArray(
            value, dims="step", attrs={"units": units, "long_name": f"{word} of the local {what}"}
        )
        for (name, (word, units)), value in zip(words.items(), found, strict=True)
    }


def _coarse(density: xr.DataArray, what: str, edges: np.ndarray) -> dict[str, xr.DataArray]:
    """Share of the surface below each edge of coarse bins (m, Pa)."""
    at = density[f"{what}_bin"].values
    fine = np.append(at, 2 * at[-1] - at[-2]) - 0.5 * (at[1] - at[0])
    below = cumulative(density.values, fine, edges)
    attributes = {"units": "1", "long_name": f"share of the surface whose {what} is below the edge of a bin"}
    return {f"{what}_below": xr.DataArray(below, dims=("step", f"{what}_edge"), attrs=attributes)}


def _theories(files: Mapping[float, Path], loop: xr.Dataset) -> xr.Dataset:
    """States of the theories at those of the deepest loop, events, and the criteria.

    On the way out the flows give their unloading branch. Results of flows for a law with a wall are extrapolated from
    two laws with a core to one without.
    """
    trees = [xr.load_datatree(path) for path in files.values()]
    own = trees[0].to_dataset()
    steps = [np.flatnonzero(way) for way in (loading_states(loop), unloading_states(loop))]
    pressures = loop["mean_pressure"].values[np.concatenate(steps)]
    for path, tree in zip(files.values(), trees, strict=True):
        there = tree["applied_pressure"].values
        if there.shape != pressures.shape or not np.allclose(there, pressures, rtol=1e-6):
            raise InputError(f"{path}: its pressures are not those of the loop; delete it and run its condition again")
    found: dict[str, xr.Variable] = {}
    for name in _OF_THEORIES:
        known = variable_of(name)
        by_step = any("step" in tree[name].dims for tree in trees if name in tree)
        dims = ("theory", "step") if by_step else ("way", "theory")
        values = np.full((len(THEORIES), loop.sizes["step"]) if by_step else (len(WAYS), len(THEORIES)), np.nan)
        for (number, label), back in itertools.product(enumerate(THEORIES), (False, True)):
            value = theory_values(trees, label, name, back)
            if value is not None and by_step:
                values[number, steps[back]] = value[len(steps[0]) :] if back else value[: len(steps[0])]
            elif value is not None:
                values[int(back), number] = value
        attributes = {"units": known.units, "long_name": f"by theory: {known.long_name}"}
        found[f"theory_{name}"] = xr.Variable(dims, values, attributes)
    found |= {name: own[name].variable for name in CRITERIA}
    named = {"units": "1", "long_name": "theory"}
    ways_named = {"units": "1", "long_name": "branch of the theory"}
    return xr.Dataset(found, {"theory": ("theory", list(THEORIES), named), "way": ("way", list(WAYS), ways_named)})


def theory_values(trees: Sequence[xr.DataTree], label: str, name: str, back: bool) -> np.ndarray | None:
    """Return a theory's values at all its states, on the unloading branch if it has one; None if it has none."""
    given = [value for tree in trees if (value := of_theory(tree, label, name, back)) is not None]
    if not given:
        return None
    if name == "converged":
        return np.minimum(*given) if len(given) == len(CORES) else given[0]
    power = AREA_POWER if name == "relative_contact_area" else 1.0
    return np.clip(without_core(given, power), *_BOUNDS.get(name, (-np.inf, np.inf)))


def of_theory(tree: xr.DataTree, label: str, name: str, back: bool) -> np.ndarray | None:
    """Return a theory's values in one dataset, on the way back of its unloading branch if it has one."""
    branches = tree["metastable"].to_dataset() if back and "metastable" in tree.children else None
    if branches is not None and name in branches and label in branches["theory"].values:
        found = branches[name].sel(theory=label, metastable_branch="unloading").values
        if not np.isnan(found).all():  # others share the dimension
            return found
    root = tree.to_dataset()
    return root[name].sel(theory=label).values if name in root and label in root["theory"].values else None


def _grids(condition: Condition, folder: Path) -> xr.Dataset:
    """The deepest loop of the first surface on coarser and finer grids; NaN where there is none."""
    files = [file_of(folder, condition, f"grid{factor:g}") for factor in REFINEMENTS]
    if not all(path.exists() for path in files):
        return xr.Dataset()
    found = {}
    loops = []
    for path in files:
        with xr.open_dataset(path) as opened:
            loops.append(_loop(opened.load().isel(seed=0, trigger_force=0)))
    words = {"units": "1", "long_name": "points of the grid along a side over those of the condition"}
    for name in _OF_GRIDS:
        one = xr.concat([loop[name] for loop in loops], xr.Variable("refinement", list(REFINEMENTS), words))
        found[f"refined_{name}"] = one.assign_attrs(long_name=f"on another grid: {loops[0][name].attrs['long_name']}")
    return xr.Dataset(found)
