"""Export of the fields of a case to ParaView: one VTK image per step, and the series of them."""

from pathlib import Path

import numpy as np
import xarray as xr

from contact_study.campaign.store.files import named_file, writable_output
from contact_study.inputs.errors import InputError

# VTK has no units; the arrays have them in their names.
_FIELDS = {"gap": ("gap (nm)", 1e9), "pressure": ("pressure (MPa)", 1e-6), "height": ("height (nm)", 1e9)}
_LENGTH = 1e9  # positions in nm: VTK takes a spacing in metres for zero


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
    others = [str(dim) for dim in dataset["gap"].dims if dim not in ("step", "y", "x")]
    if others:
        raise InputError(f"dataset: choose one of each {', '.join(others)}, as by dataset.isel({others[0]}=0)")
    try:
        from pyevtk.hl import imageToVTK
        from pyevtk.vtk import VtkGroup
    except ImportError:
        raise InputError("VTK files need pip install '.[vtk]'") from None
    writable_output(path)
    folder = path.with_suffix("")
    folder.mkdir(exist_ok=True)
    images = []
    spacing = [_spacing(dataset[name].values) * _LENGTH for name in ("x", "y")]
    for step in range(dataset.sizes["step"]):
        fields = {
            title: _image(dataset[name].isel(step=step) if "step" in dataset[name].dims else dataset[name], scale)
            for name, (title, scale) in _FIELDS.items()
            if name in dataset
        }
        if np.all(np.isnan(fields[_FIELDS["pressure"][0]])):
            continue  # beyond the end of a path shorter than others
        written = imageToVTK(str(folder / f"step_{step:04d}"), spacing=(*spacing, max(spacing)), pointData=fields)
        images.append((step, Path(written)))
    series = VtkGroup(str(path.with_suffix("")))
    for step, image in images:
        series.addFile(str(image), step)
    series.save()
    return [path, *(image for _, image in images)]


def _spacing(coordinate: np.ndarray) -> float:
    return float(coordinate[1] - coordinate[0])


def _image(field: xr.DataArray, scale: float) -> np.ndarray:
    """A field (y, x) as an image (x, y, 1); infinite values become NaN."""
    values = scale * field.transpose("x", "y").values.astype(float)
    return np.where(np.isfinite(values), values, np.nan)[:, :, None]
