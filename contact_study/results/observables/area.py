"""Area and edge of the contact."""

import math

import numpy as np

from contact_study.numerics.distributions import Bins
from contact_study.results.state import InterfaceState, Observable, Value, Variable

# A point in contact counts with its whole cell. V. A. Yastrebov, G. Anciaux & J.-F. Molinari, Tribol. Int. 114, 161
# (2017), arXiv:1701.02727, correct that by A' = A − (π − 1 + ln 2)/24 · S Δx, where S is the length of the edge along
# the sides of the cells, 4/π of the edge's own if that has no preferred direction; a free rim is no such side. That is
# of contact with a wall, whose gap rises from zero: points in the level set of a smooth field have no such bias.
OVERCOUNT = (np.pi - 1 + np.log(2)) / 24


def edge_sides(contact: np.ndarray, periodic: bool = True) -> tuple[int, int]:
    """Sides along x and along y between cells in contact and others, across the edges of a periodic map too."""
    first = 0 if periodic else 1
    along_x = int(np.count_nonzero((contact != np.roll(contact, 1, axis=0))[first:]))
    along_y = int(np.count_nonzero((contact != np.roll(contact, 1, axis=1))[:, first:]))
    return along_x, along_y


def corrected_area(contact: np.ndarray, sides: tuple[int, int] | None = None) -> float:
    """Area of a contact map over the nominal one, corrected by the sides of its edge, by default a periodic map's."""
    return max(float(np.mean(contact)) - OVERCOUNT * sum(sides or edge_sides(contact)) / contact.size, 0.0)


def _area(state: InterfaceState, _: Bins) -> dict[str, Value]:
    areas = {"contact": state.contact, "repulsive": state.pressure > 0}
    sides = {kind: edge_sides(area, state.periodic) for kind, area in areas.items()}
    values: dict[str, Value] = {f"relative_{kind}_area": float(np.mean(area)) for kind, area in areas.items()}
    for kind, area in areas.items():
        whole = kind in state.wall_bounded
        values[f"corrected_{kind}_area"] = corrected_area(area, sides[kind] if whole else (0, 0))
    if state.spacing is not None:
        dy, dx = state.spacing
        along_x, along_y = sides["contact"]
        values["contact_radius"] = math.sqrt(np.count_nonzero(state.contact) * dy * dx / math.pi)
        values["contact_perimeter"] = np.pi / 4 * (along_x * dx + along_y * dy) / (state.contact.size * dy * dx)
    return values


_CORRECTED = "over nominal area, corrected for the grid at its edge"
AREA = Observable(
    {
        "relative_contact_area": Variable("1", "contact area over nominal area"),
        "relative_repulsive_area": Variable("1", "area under positive pressure over nominal area"),
        "corrected_contact_area": Variable("1", f"contact area {_CORRECTED}"),
        "corrected_repulsive_area": Variable("1", f"area under positive pressure {_CORRECTED}"),
        "contact_radius": Variable("m", "radius of a circle of the contact area"),
        "contact_perimeter": Variable("m-1", "length of the contact's edge, assumed isotropic, over nominal area"),
    },
    _area,
)
