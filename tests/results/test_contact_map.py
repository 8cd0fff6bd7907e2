"""The map of contact: clusters and percolation by hand and against slow ways, its edge and area, pairs of points."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from bem_adhesion import HardWall, rough_contact
from contact_study.results import observables
from contact_study.results.observables import (
    AREA,
    CLUSTERS,
    OVERCOUNT,
    PATCH_EDGES,
    RING_EDGES,
    RINGS,
    cluster_map,
    corrected_area,
    edge_sides,
    percolates,
)
from tests.results.test_observables import BINS, state


def contact_map(text):
    return np.array([[mark == "#" for mark in line] for line in text.split()])


def sizes(contact, **options):
    return np.bincount(cluster_map(contact, **options).ravel())[1:].tolist()


def test_with_free_boundaries_clusters_end_at_the_rim():
    assert sizes(contact_map("#...# ..... #...#"), periodic=False) == [1, 1, 1, 1]
    assert sizes(contact_map("#.#.# #.#.# #.#.#"), periodic=False) == [3, 3, 3]


@pytest.mark.parametrize(
    ("text", "through"),
    [
        ("..... ..... .....", False),
        ("##### ..... .....", True),
        ("##.## ..... .....", False),
        ("###.. ..### .....", True),  # though its ends do not meet over the edge
        ("#.... .#... ..#.. ...#. ....#", False),  # corners do not connect
        ("##... #.... .....", False),  # neighbouring rims are not opposite
    ],
)
def test_percolation_with_free_boundaries_by_hand(text, through):
    assert percolates(contact_map(text), periodic=False) is through
    assert percolates(contact_map(text).T, periodic=False) is through


@given(arrays.arrays(bool, st.tuples(st.integers(1, 8), st.integers(1, 8))))
@settings(max_examples=100, deadline=None)
def test_clusters_are_those_of_walks_over_the_torus(contact):
    """From each point in turn; a walk that comes back to a point in another period goes around."""
    rows, columns = contact.shape
    reached, around, found = {}, False, []
    for start in map(tuple, np.argwhere(contact)):
        if start in reached:
            continue
        front, before = [start], len(reached)
        reached[start] = start
        while front:
            y, x = reached[front.pop()]
            for place in ((y + 1, x), (y - 1, x), (y, x + 1), (y, x - 1)):
                cell = place[0] % rows, place[1] % columns
                if contact[cell]:
                    around |= reached.get(cell, place) != place
                    if cell not in reached:
                        reached[cell] = place
                        front.append(cell)
        found.append(len(reached) - before)
    assert sizes(contact) == sorted(found, reverse=True)
    assert percolates(contact) is around


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


def test_sizes_of_patches():
    """A large patch counts by its area in the mean diameter, and once in the number density."""
    contact = contact_map("..... ##.#. ##... ..... .....")
    found = CLUSTERS.read(state(contact=contact, spacing=(2.0, 0.5)), BINS)
    large, small = (2 * np.sqrt(points * 2.0 * 0.5 / np.pi) for points in (4, 1))
    assert found["mean_patch_diameter"] == pytest.approx((4 * large + small) / 5)
    counts = found["patch_size_density"] * np.diff(PATCH_EDGES)
    octaves = [int(np.floor(np.log2(points / 25))) - 1 for points in (1, 4)]  # from the end
    assert [counts[octave + 1] for octave in octaves] == [1, 1]
    assert counts.sum() == 2


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


@pytest.mark.parametrize("kinds", [(), ("repulsive",), ("contact",)])
def test_only_edges_of_a_wall_are_corrected(kinds):
    contact = contact_map("..... .##.. .##.. .....")
    found = AREA.read(state(contact=contact, pressure=np.where(contact, 1e9, -1e6), wall_bounded=kinds), BINS)
    for kind in ("contact", "repulsive"):
        bias = OVERCOUNT * 8 / 20 if kind in kinds else 0.0
        assert found[f"corrected_{kind}_area"] == pytest.approx(4 / 20 - bias)


def test_a_level_set_is_counted_without_bias():
    """Points in a disc, on the mean over its places: within three standard errors of the area, unlike if corrected."""
    rng, radius, points = np.random.default_rng(1), 5.0, 16
    y, x = np.mgrid[:points, :points]
    centres = points / 2 + rng.uniform(-0.5, 0.5, (400, 2))
    discs = [(y - one) ** 2 + (x - other) ** 2 < radius**2 for one, other in centres]
    plain, corrected = ([each(disc) * points**2 for disc in discs] for each in (np.mean, corrected_area))
    error = np.std(plain, ddof=1) / np.sqrt(len(discs))
    assert abs(np.mean(plain) - np.pi * radius**2) < 3 * error
    assert abs(np.mean(corrected) - np.pi * radius**2) > 3 * error


def counted(contact, spacing, periodic=True):
    """The definition, pair by pair; inside the map alone once in either direction across is enough."""
    rows, columns = contact.shape
    side = min(rows * spacing[0], columns * spacing[1])
    sums, pairs = np.zeros(RINGS), np.zeros(RINGS)
    for down in range(rows) if periodic else range(1 - rows, rows):
        for across in range(columns):
            way = (min(down, rows - down), min(across, columns - across)) if periodic else (down, across)
            distance = np.hypot(way[0] * spacing[0], way[1] * spacing[1]) / side
            inside = [k for k in range(RINGS) if RING_EDGES[k] < distance * (1 - 1e-9) <= RING_EDGES[k + 1]]
            if inside:
                meet = contact & np.roll(contact, (down, across), (0, 1))
                if not periodic:
                    meet = meet[max(down, 0) : rows + min(down, 0), across:]
                # Without a step across, up and down are the same pairs.
                once = 0.5 if not periodic and across == 0 else 1.0
                sums[inside[0]] += once * np.sum(meet)
                pairs[inside[0]] += once * meet.size
    with np.errstate(invalid="ignore"):
        return sums / pairs


@pytest.mark.parametrize(("shape", "spacing"), [((9, 14), (1.0, 0.7)), ((12, 7), (0.2, 0.3))])
@pytest.mark.parametrize("periodic", [True, False])
def test_equals_the_count_of_pairs(shape, spacing, periodic):
    contact = np.random.default_rng(1).random(shape) < 0.4
    found = observables.contact_autocorrelation(contact, spacing, periodic)
    np.testing.assert_allclose(found, counted(contact, spacing, periodic), atol=1e-14)  # rounding
