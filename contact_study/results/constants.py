"""What does not change along the path of a case: interface, surface and grid, the same names for every model."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass

import numpy as np

from contact_study.numerics.grid import Grid
from contact_study.results.state import Value, Variable

CONSTANTS: dict[str, Variable] = {
    "contact_modulus": Variable("Pa", "contact modulus", ()),
    "work_of_adhesion": Variable("J m-2", "work of adhesion", ()),
    "equilibrium_distance": Variable("m", "distance of flat surfaces without load", ()),
    "peak_tensile_stress": Variable("Pa", "largest tensile stress of flat surfaces", ()),
    "peak_distance": Variable("m", "distance of flat surfaces at the largest tensile stress", ()),
    "rms_height": Variable("m", "root-mean-square height of the surface", ()),
    "rms_slope": Variable("1", "root-mean-square slope of the surface", ()),
    "interaction_length": Variable(
        "m", "length of the traction-separation law: zero stress, or range outside a wall", ()
    ),
    "contact_distance": Variable("m", "gaps below it count as contact", ()),
    "pixel": Variable("m", "largest grid spacing", ()),
    "process_zone": Variable("m", "length over which the law bridges the edge of a contact", ()),
    "height": Variable("m", "height of the rigid surface, toward the block", ("y", "x")),
}


@dataclass(frozen=True)
class InterfaceConstants:
    """Numbers of a case, given to a model or measured by it; None where it has no such thing.

    The names, units and meanings are those of :data:`CONSTANTS`.
    """

    contact_modulus: float
    work_of_adhesion: float
    equilibrium_distance: float
    peak_tensile_stress: float
    contact_distance: float
    rms_height: float
    rms_slope: float
    pixel: float | None = None
    peak_distance: float | None = None
    process_zone: float | None = None

    @property
    def values(self) -> Mapping[str, Value]:
        """The numbers by their names in a dataset."""
        return {name: value for name, value in asdict(self).items() if value is not None}


def heights_on(grid: Grid, heights: np.ndarray) -> Mapping[str, Value]:
    """Heights of the surface and where they stand, by their names in a dataset (m)."""
    y, x = grid.coordinates
    return {"y": y, "x": x, "height": heights}
