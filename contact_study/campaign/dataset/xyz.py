"""Export of the atoms of a case to extended XYZ, for OVITO and ASE: one frame per point of the path."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from scipy import constants

from contact_study.campaign.store.files import named_file, writable_output, write_aside
from contact_study.inputs.errors import InputError

if TYPE_CHECKING:
    from ase import Atoms

# No element: mass and springs of an atom are those of the study.
_UNKNOWN = "X"
_SUBSTRATE_LEVEL = -1

_ANGSTROM, _GIGAPASCAL, _ANGSTROM_PER_PICOSECOND = 1e-10, 1e9, 1e2
_UNITS = "positions angstrom, velo angstrom/ps, stresses GPa, masses u"


def to_xyz(dataset: xr.Dataset, path: str | Path) -> list[Path]:
    """Write the atoms of one case along its path, for OVITO and ASE.

    Columns beside the positions (Å): ``level`` (0: bottom layer, higher: nodes of an explicit block, −1: substrate);
    ``normal_stress``, compression positive, and ``shear_stress`` (x, y) of the substrate on the bottom layer (GPa);
    ``velo`` of atoms in motion (Å/ps); ``masses`` if the study has them (u), infinite for the substrate. The key
    ``step`` of a frame is the point of the path. All symbols are X, which is no element. Atoms are not folded back into
    the periodic cell.

    Parameters
    ----------
    dataset : xarray.Dataset
        Dataset of the atomistic model with ``output.atoms = "surface"`` or ``"block"``, at one point of its sweep:
        ``dataset.sel(seed=1)``.
    path : path-like
        File for the whole path as a trajectory; with ``*`` in its name one file per point, named by the step's number.

    Returns
    -------
    list of pathlib.Path
        The files that were written.

    Raises
    ------
    ValueError
        If the dataset has no atoms or more than one case, the name does not end in ``.xyz`` or cannot be written, or
        the extra ``xyz`` is not installed.

    Examples
    --------
    >>> import xarray as xr
    >>> from contact_study import to_xyz
    >>> to_xyz(xr.open_dataset("md.nc").sel(seed=1), "atoms.xyz")  # doctest: +SKIP
    """
    path = named_file(path)
    if path.suffix not in (".xyz", ".extxyz"):
        raise InputError(f"{path}: expected a name that ends in .xyz")
    if "atom_height" not in dataset:
        raise InputError('dataset: holds no atoms; run its study with output.atoms = "surface"')
    others = [str(dim) for dim in dataset["atom_height"].dims if dim not in ("step", "y", "x")]
    if others:
        raise InputError(f"dataset: choose one of each {', '.join(others)}, as by dataset.isel({others[0]}=0)")
    try:
        from ase.io import write
    except ImportError:
        raise InputError("XYZ files need pip install '.[xyz]'") from None
    path_points = dataset if "step" in dataset.dims else dataset.expand_dims("step")
    states = (_frame(path_points.isel(step=step)) for step in range(path_points.sizes["step"]))
    frames = [frame for frame in states if frame is not None]
    files: dict[Path, list[Any]] = {}
    for frame in frames:
        files.setdefault(path.with_name(path.name.replace("*", f"{frame.info['step']:04d}")), []).append(frame)
    for name, content in files.items():
        writable_output(name)
        write_aside(name, partial(write, images=content, format="extxyz"))
    return list(files)


def _frame(state: xr.Dataset) -> "Atoms | None":
    """Make the frame of a state; None beyond the end of a shorter path."""
    from ase import Atoms

    height = state["atom_height"].values
    if np.isnan(height).all():
        return None
    explicit = "node_z" in state
    block = _vectors(state, "node_x", "node_y", "node_z") if explicit else _surface(state)
    site_y, site_x = np.meshgrid(state["site_y"].values, state["site_x"].values, indexing="ij")
    sites = np.stack([site_x, site_y, state["substrate_height"].values], axis=-1).reshape(-1, 3)
    positions = np.concatenate([block, sites]) / _ANGSTROM
    lowest, highest = positions[:, 2].min(), positions[:, 2].max()
    periods = [
        state.sizes[axis] * float(state[axis].values[1] - state[axis].values[0]) / _ANGSTROM for axis in ("x", "y")
    ]
    atoms = Atoms(
        _UNKNOWN * (len(block) + len(sites)),
        positions,
        cell=(*periods, highest - lowest),
        pbc=(True, True, False),
        info={"step": int(state["step"]), "Origin": np.array([0.0, 0.0, lowest]), "units": _UNITS},
    )

    def column(name: str, values: np.ndarray, elsewhere: float = 0.0) -> None:
        whole = np.full((len(atoms), *values.shape[1:]), elsewhere, values.dtype)
        whole[: len(values)] = values
        atoms.new_array(name, whole)

    if "atom_mass" in state:
        mass = state["node_mass"].values if explicit else np.full(len(block), float(state["atom_mass"]))
        column("masses", mass / constants.atomic_mass, np.inf)
    levels = state["node_level"].values.astype(int) if explicit else np.zeros(len(block), int)
    column("level", levels, _SUBSTRATE_LEVEL)
    # The atoms of the surface are the first of the nodes.
    column("normal_stress", state["normal_stress"].values.ravel() / _GIGAPASCAL)
    column("shear_stress", _vectors(state, "shear_stress_x", "shear_stress_y") / _GIGAPASCAL)
    if "velocity_x" in state:
        prefix = "node_velocity" if explicit else "velocity"
        column("velo", _vectors(state, *(f"{prefix}_{axis}" for axis in "xyz")) / _ANGSTROM_PER_PICOSECOND)
    return atoms


def _surface(state: xr.Dataset) -> np.ndarray:
    """Positions of the bottom layer (m), shape (atoms, 3)."""
    x = state["x"].values[None, :] + state["lateral_displacement_x"].values
    y = state["y"].values[:, None] + state["lateral_displacement_y"].values
    return np.stack([x, y, state["atom_height"].values], axis=-1).reshape(-1, 3)


def _vectors(state: xr.Dataset, *names: str) -> np.ndarray:
    """Components side by side, one row per atom."""
    return np.stack([state[name].values.ravel() for name in names], axis=-1)
