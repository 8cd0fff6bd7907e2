"""Exports: a table of the steps; of one case along its path fields for ParaView, or atoms as extended XYZ."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from scipy import constants

from contact_study.campaign.store.files import named_file, writable_output, write_aside
from contact_study.inputs.errors import InputError

if TYPE_CHECKING:
    import pandas as pd
    from ase import Atoms

# VTK has no units; the arrays have them in their names.
_FIELDS = {"gap": ("gap (nm)", 1e9), "pressure": ("pressure (MPa)", 1e-6), "height": ("height (nm)", 1e9)}
_LENGTH = 1e9  # positions in nm: VTK takes a spacing in metres for zero

# No element: mass and springs of an atom are those of the study.
_UNKNOWN = "X"
_SUBSTRATE_LEVEL = -1

_ANGSTROM, _GIGAPASCAL, _ANGSTROM_PER_PICOSECOND = 1e-10, 1e9, 1e2
_UNITS = "positions angstrom, velo angstrom/ps, stresses GPa, masses u"


def to_vtk(dataset: xr.Dataset, path: str | Path) -> list[Path]:
    """Write gap, pressure and height of one case along its path, for ParaView.

    Parameters
    ----------
    dataset : xarray.Dataset
        Dataset of a simulation with ``output.fields = true``, at one point of its sweep: ``dataset.sel(seed=1)``.
    path : path-like
        The series, with the suffix ``.pvd``; its images go into a folder of that name. Its times are step numbers.

    Returns
    -------
    list of pathlib.Path
        The files that were written, the series first.

    Raises
    ------
    ValueError
        If the dataset has no fields or more than one case, the name does not end in ``.pvd`` or cannot be written, or
        the extra ``vtk`` is not installed.

    Examples
    --------
    >>> import xarray as xr
    >>> from contact_study import to_vtk
    >>> to_vtk(xr.open_dataset("bem.nc").sel(seed=1), "contact.pvd")  # doctest: +SKIP
    """
    path = named_file(path)
    if path.suffix != ".pvd":
        raise InputError(f"{path}: expected a name that ends in .pvd")
    if "gap" not in dataset or "pressure" not in dataset:
        raise InputError("dataset: holds no fields; run its study with output.fields = true")
    _require_one_case(dataset["gap"])
    try:
        from pyevtk.hl import imageToVTK
        from pyevtk.vtk import VtkGroup
    except ImportError:
        raise InputError("VTK files need pip install '.[vtk]'") from None
    writable_output(path)
    folder = path.with_suffix("")
    folder.mkdir(exist_ok=True)
    spacing = [float(dataset[name].values[1] - dataset[name].values[0]) * _LENGTH for name in ("x", "y")]
    series, written = VtkGroup(str(folder)), [path]
    for step in range(dataset.sizes["step"]):
        fields = {
            title: scale * dataset[name].isel(step=step, missing_dims="ignore").transpose("x", "y").values.astype(float)
            for name, (title, scale) in _FIELDS.items()
            if name in dataset
        }
        # Images have the shape (x, y, 1); infinite values become NaN.
        fields = {title: np.where(np.isfinite(field), field, np.nan)[:, :, None] for title, field in fields.items()}
        if np.all(np.isnan(fields[_FIELDS["pressure"][0]])):
            continue  # beyond the end of a path shorter than others
        image = imageToVTK(str(folder / f"step_{step:04d}"), spacing=(*spacing, max(spacing)), pointData=fields)
        series.addFile(image, step)
        written.append(Path(image))
    series.save()
    return written


def table_of(dataset: xr.Dataset, cases: Sequence[str] = ()) -> "pd.DataFrame":
    """Return what a dataset has for each case, on these dimensions, and load step: a row each, units in the names."""
    from contact_study.plots.selection import LOADING, UNLOADING  # brings SciPy's images

    dims = [*cases, *(["step"] if "step" in dataset.dims else [])]
    names = [name for name in dataset.variables if name not in dims and set(dataset[name].dims) <= {*dims}]
    varying = [name for name in names if "step" in dataset[name].dims or "step" not in dims]
    frame = dataset[varying].reset_coords().to_dataframe().reset_index()
    # A path shorter than others is filled up.
    frame = frame.dropna(subset=["mean_pressure"], how="all") if "mean_pressure" in frame else frame
    if "branch" in frame:
        frame["branch"] = frame["branch"].map({LOADING: "loading", UNLOADING: "unloading"})
    applied = [name for name in frame if str(name).startswith("applied_")]
    frame = frame[[name for name in dict.fromkeys([*dims, *applied, "branch", *frame]) if name in frame]]
    units = {name: dataset[name].attrs.get("units", "1") for name in frame if name in dataset.variables}
    return frame.rename(columns={name: f"{name} ({unit})" for name, unit in units.items() if unit not in ("", "1")})


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
    _require_one_case(dataset["atom_height"])
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
    if not explicit:
        x, y = state["x"] + state["lateral_displacement_x"], state["y"] + state["lateral_displacement_y"]
        state = state.assign(node_x=x.transpose("y", "x"), node_y=y.transpose("y", "x"), node_z=state["atom_height"])
    block = _vectors(state, "node_x", "node_y", "node_z")
    site_y, site_x = np.meshgrid(state["site_y"].values, state["site_x"].values, indexing="ij")
    sites = np.stack([site_x, site_y, state["substrate_height"].values], axis=-1).reshape(-1, 3)
    positions = np.concatenate([block, sites]) / _ANGSTROM
    lowest, highest = positions[:, 2].min(), positions[:, 2].max()
    periods = [state.sizes[axis] * float(state[axis][1] - state[axis][0]) / _ANGSTROM for axis in ("x", "y")]
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


def _vectors(state: xr.Dataset, *names: str) -> np.ndarray:
    """Components side by side, one row per atom."""
    return np.stack([state[name].values.ravel() for name in names], axis=-1)


def _require_one_case(field: xr.DataArray) -> None:
    others = [str(dim) for dim in field.dims if dim not in ("step", "y", "x")]
    if others:
        raise InputError(f"dataset: choose one of each {', '.join(others)}, as by dataset.isel({others[0]}=0)")
