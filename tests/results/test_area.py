"""The edge of contact: sides by hand, the area of discs, Hertz's sphere."""

import numpy as np
import pytest

from bem_adhesion import HardWall, rough_contact
from contact_study.results.observables.contact_map import AREA, OVERCOUNT, edge_sides
from tests.results.test_clusters import contact_map
from tests.results.test_observables import BINS, state


@pytest.mark.parametrize(
    ("text", "sides", "free"),
    [
        ("##### ##### #####", (0, 0), (0, 0)),
        ("#...# ..... .....", (4, 2), (2, 2)),  # one patch across the edge, or two whose other sides are the rim
        ("##### ..... .....", (10, 0), (5, 0)),
        (".#... ..... .....", (2, 2), (1, 2)),
    ],
)
def test_sides_by_hand(text, sides, free):
    assert edge_sides(contact_map(text)) == sides
    assert edge_sides(contact_map(text), periodic=False) == free


def test_perimeter_and_areas_of_cells_of_any_proportions():
    contact = contact_map("....... .##.... .##.... .##.... .......")
    pressure = np.where(contact_map("....... .#..... ....... ....... ......."), 1e9, -1e6)  # with an edge of its own
    found = AREA.read(state(contact=contact, pressure=pressure, spacing=(2.0, 0.5)), BINS)
    assert found["contact_perimeter"] == pytest.approx(np.pi / 4 * (2 * 3 * 2.0 + 2 * 2 * 0.5) / (35 * 2.0 * 0.5))
    assert found["corrected_contact_area"] == pytest.approx((6 - OVERCOUNT * 10) / 35)
    assert found["corrected_repulsive_area"] == pytest.approx((1 - OVERCOUNT * 4) / 35, abs=1e-15)


def test_the_corrected_area_is_hertzs():
    """The sphere's area is too large in first order of the spacing; corrected it is several times nearer."""
    radius, contact_radius, size, points = 1.0, 0.1, 0.3, 64
    force = 4 * contact_radius**3 / (3 * radius)
    rng, plain, corrected = np.random.default_rng(1), [], []
    for _ in range(4):
        axis = (np.arange(points) - points / 2) * size / points
        y, x = rng.uniform(-0.5, 0.5, 2) * size / points
        height = -((axis[:, None] - y) ** 2 + (axis - x) ** 2) / (2 * radius)
        contact = rough_contact(height, size, 1.0, HardWall(), boundary="free")
        touching = contact.step(contact.separated(), force / size**2).pressure > 0
        found = AREA.read(state(contact=touching), BINS)
        plain.append(np.mean(touching))
        corrected.append(found["corrected_contact_area"])
    expected = np.pi * contact_radius**2 / size**2
    assert np.mean(plain) / expected - 1 > 0.01
    assert abs(np.mean(corrected) / expected - 1) < 0.004
