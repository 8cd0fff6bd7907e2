"""The edge of contact: its length, and the areas freed of what whole points add along theirs.

A point counts whole, and the points along the edge whose surroundings are touched in part only make the sum of them too
large by a share of the edge's length times the spacing, at any resolution. V. A. Yastrebov, G. Anciaux & J.-F.
Molinari, Tribol. Int. 114, 161 (2017), arXiv:1701.02727 (the tests hold the constant to Hertz), take it off,

    A' = A − (π − 1 + ln 2)/24 · S Δx,

S being the length of the edge along the sides of the points' cells, 4/π of the edge's own length where that has no
preferred direction. On cells of any proportions S Δx is the number of sides between a point in contact and one that is
not, times the area of a cell. Where the surface itself ends, with free boundaries, its rim is no such side: it is where
it is, and nothing is to be taken off along it.
"""

import numpy as np

from contact_study.numerics.distributions import Bins
from contact_study.results.state import InterfaceState, Observable, Value, Variable

OVERCOUNT = (np.pi - 1 + np.log(2)) / 24


def edge_sides(contact: np.ndarray, periodic: bool = True) -> tuple[int, int]:
    """Sides along x and along y of cells between contact and none, over the edges of a periodic map too."""
    first = 0 if periodic else 1
    along_x = int(np.count_nonzero((contact != np.roll(contact, 1, axis=0))[first:]))
    along_y = int(np.count_nonzero((contact != np.roll(contact, 1, axis=1))[:, first:]))
    return along_x, along_y


def _corrected(area: np.ndarray, sides: tuple[int, int]) -> float:
    """Share of the points that are of an area, freed of what whole points add along its sides."""
    return max(float(np.mean(area)) - OVERCOUNT * sum(sides) / area.size, 0.0)


def _read(state: InterfaceState, _: Bins) -> dict[str, Value]:
    pressed = state.pressure > 0
    along_x, along_y = edge_sides(state.contact, state.periodic)
    values: dict[str, Value] = {
        "corrected_contact_area": _corrected(state.contact, (along_x, along_y)),
        "corrected_repulsive_area": _corrected(pressed, edge_sides(pressed, state.periodic)),
    }
    if state.spacing is not None:
        dy, dx = state.spacing
        values["contact_perimeter"] = np.pi / 4 * (along_x * dx + along_y * dy) / (state.contact.size * dy * dx)
    return values


CONTACT_EDGE = Observable(
    {
        "corrected_contact_area": Variable(
            "1", "contact area over nominal area, without what whole points add along its edge"
        ),
        "corrected_repulsive_area": Variable(
            "1", "area under positive pressure over nominal area, without what whole points add along its edge"
        ),
        "contact_perimeter": Variable(
            "m-1", "length of the contact's edge over nominal area, of an edge without preferred direction"
        ),
    },
    _read,
)
