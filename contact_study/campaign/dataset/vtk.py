"""Fields of a case as files that ParaView opens as a time series: an image a step, and the list of them."""

from pathlib import Path

import numpy as np
import xarray as xr

from contact_study.campaign.store.files import named_file, writable_output
from contact_study.errors import InputError

# VTK has no units: the names of the arrays say them.
_FIELDS = {"gap": ("gap (nm)", 1e9), "pressure": ("pressure (MPa)", 1e-6), "height": ("height (nm)", 1e9)}
_LENGTH = 1e9  # positions in nm: a spacing in metres counts as zero there


def to_vtk(dataset: xr.Dataset, path: str | Path) -> list[Path]:
    """Write gap, pressure and height of one case along its path, for ParaView.

    Parameters
    ----------
    dataset : xarray.Dataset
        A dataset of a simulation that kept its fields (``output.fields = true``), of one point of its sweep:
        ``dataset.sel(seed=1)``.
    path : path-like
        The series, a name that ends in ``.pvd``; its images go into a folder of that name beside it. Its times are the
        numbers of the steps.

    Returns
    -------
    list of pathlib.Path
        The files, the series first.

    Raises
    ------
    ValueError
        If the dataset has no fields or more than one case, the name does not end in ``.pvd`` or cannot be written, or
        the extra ``vtk`` is not installed.
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
    """A field (y, x) as VTK has images, (x, y, 1); what is infinitely far apart has no number."""
    values = scale * field.transpose("x", "y").values.astype(float)
    return np.where(np.isfinite(values), values, np.nan)[:, :, None]
