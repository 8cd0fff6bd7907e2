"""Contact area, repulsive area, and the edge of contact: its length, and areas corrected for the grid.

A point in contact counts with its whole cell, so the area is too large by a share of the edge's length times the grid
spacing, at any resolution. V. A. Yastrebov, G. Anciaux & J.-F. Molinari, Tribol. Int. 114, 161 (2017),
arXiv:1701.02727, correct it by

    A' = A − (π − 1 + ln 2)/24 · S Δx,

where S is the length of the edge along the sides of the cells, 4/π of the edge's own length if that has no preferred
direction. S Δx is the number of sides between a point in contact and one that is not, times the area of a cell. The rim
of a surface with free boundaries is no such side.
"""

import numpy as np

from contact_study.numerics.distributions import Bins
from contact_study.results.state import InterfaceState, Observable, Value, Variable

OVERCOUNT = (np.pi - 1 + np.log(2)) / 24


def edge_sides(contact: np.ndarray, periodic: bool = True) -> tuple[int, int]:
    """Sides along x and along y between cells in contact and others, across the edges of a periodic map too."""
    first = 0 if periodic else 1
    along_x = int(np.count_nonzero((contact != np.roll(contact, 1, axis=0))[first:]))
    along_y = int(np.count_nonzero((contact != np.roll(contact, 1, axis=1))[:, first:]))
    return along_x, along_y


def _corrected(area: np.ndarray, sides: tuple[int, int]) -> float:
    return max(float(np.mean(area)) - OVERCOUNT * sum(sides) / area.size, 0.0)


def _read(state: InterfaceState, _: Bins) -> dict[str, Value]:
    pressed = state.pressure > 0
    along_x, along_y = edge_sides(state.contact, state.periodic)
    values: dict[str, Value] = {
        "relative_contact_area": float(np.mean(state.contact)),
        "relative_repulsive_area": float(np.mean(pressed)),
        "corrected_contact_area": _corrected(state.contact, (along_x, along_y)),
        "corrected_repulsive_area": _corrected(pressed, edge_sides(pressed, state.periodic)),
    }
    if state.spacing is not None:
        dy, dx = state.spacing
        values["contact_perimeter"] = np.pi / 4 * (along_x * dx + along_y * dy) / (state.contact.size * dy * dx)
    return values


AREA = Observable(
    {
        "relative_contact_area": Variable("1", "contact area over nominal area"),
        "relative_repulsive_area": Variable("1", "area under positive pressure over nominal area"),
        "corrected_contact_area": Variable("1", "contact area over nominal area, corrected for the grid at its edge"),
        "corrected_repulsive_area": Variable(
            "1", "area under positive pressure over nominal area, corrected for the grid at its edge"
        ),
        "contact_perimeter": Variable("m-1", "length of the contact's edge, assumed isotropic, over nominal area"),
    },
    _read,
)
