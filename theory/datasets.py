"""A state of a theory as a dataset of the schema that ``theory.nc`` has, for those who work without study files."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_study.results.schema import COORDINATES, LABELS, variable_of

if TYPE_CHECKING:
    from xarray import Dataset
else:  # slow to import
    Dataset = "xarray.Dataset"

_BINS = 400  # of a distribution by default


def dataset_of(
    labels: tuple[str, ...],
    quantities: Mapping[str, Any],
    bins: Mapping[str, tuple[np.ndarray | None, tuple[float, float]]],
    further: Mapping[str, np.ndarray] | None = None,
) -> Dataset:
    """The dataset of one state.

    Quantities go by their names in the schema; distributions are functions from edges of bins to means, and ``bins``
    has their edges or None, and the range of even ones. ``further`` has other coordinates, such as ``wavevector``.
    """
    import xarray as xr

    coordinates: dict[str, Any] = dict(zip(LABELS, labels, strict=False)) | dict(further or {})
    content = {}
    for name, value in quantities.items():
        known = variable_of(name)
        dims = tuple(dim for dim in known.dims if dim != "step")
        if callable(value):
            given, ends = bins[name]
            asked = np.linspace(*ends, _BINS + 1) if given is None else np.asarray(given, dtype=float)
            if asked.ndim != 1 or asked.size < 2 or not np.all(np.diff(asked) > 0):
                raise ValueError(f"{name.removesuffix('pdf')}edges: must be rising numbers, two at least")
            coordinates[dims[-1]] = 0.5 * (asked[1:] + asked[:-1])
            value = value(asked)
        attributes = {"units": known.units, "long_name": known.long_name, **known.attrs}
        content[name] = xr.Variable(dims, np.asarray(value, dtype=known.dtype), attributes)
    held = {}
    for name, value in coordinates.items():
        known = COORDINATES[name]
        dims = () if np.ndim(value) == 0 else (name,)
        held[name] = xr.Variable(dims, value, {"units": known.units, "long_name": known.long_name})
    return xr.Dataset(content, held)
