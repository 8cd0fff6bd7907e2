"""Contact clusters and percolation, by hand and against slow ways to find them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from contact_study.results.observables.clusters import cluster_sizes, percolates


def contact_map(text):
    return np.array([[mark == "#" for mark in line] for line in text.split()])


@pytest.mark.parametrize(
    ("text", "sizes"),
    [
        ("..... ..... .....", []),
        ("##### ##### #####", [15]),
        (".#.#. .#.#. .....", [2, 2]),
        ("#...# ..... .....", [2]),  # across the edge along x
        ("#...# ..... #...#", [4]),  # across both: the four corners of the map are one patch
        ("#.... ..... ....#", [1, 1]),  # corners that meet only by a corner across both edges
        (".#... ..#.. .....", [1, 1]),  # a corner is no connection
        ("##.## ..... .#...", [5]),  # in three pieces of the map
        ("#.#.# #.#.# #.#.#", [6, 3]),  # stripes, one of them across the edge
    ],
)
def test_clusters_by_hand(text, sizes):
    assert sorted(cluster_sizes(contact_map(text)), reverse=True) == sizes


def test_with_free_boundaries_clusters_end_at_the_rim():
    assert cluster_sizes(contact_map("#...# ..... #...#"), periodic=False).tolist() == [1, 1, 1, 1]
    assert cluster_sizes(contact_map("#.#.# #.#.# #.#.#"), periodic=False).tolist() == [3, 3, 3]


def flooded(contact):
    """Sizes by flooding from each point in turn, the slow way."""
    rows, columns = contact.shape
    left, sizes = {tuple(point) for point in np.argwhere(contact)}, []
    while left:
        front, size = [left.pop()], 0
        while front:
            y, x = front.pop()
            size += 1
            for beside in ((y + 1, x), (y - 1, x), (y, x + 1), (y, x - 1)):
                beside = beside[0] % rows, beside[1] % columns
                if beside in left:
                    left.remove(beside)
                    front.append(beside)
        sizes.append(size)
    return sorted(sizes)


@settings(max_examples=60, deadline=None)
@given(
    arrays.arrays(bool, arrays.array_shapes(min_dims=2, max_dims=2, min_side=1, max_side=9)),
    st.integers(-9, 9),
    st.integers(-9, 9),
)
def test_clusters_are_those_of_the_torus(contact, down, right):
    """Whatever the map: as flooding finds them, and the same wherever its edges are laid or its axes are swapped."""
    sizes = sorted(cluster_sizes(contact))
    assert sizes == flooded(contact)
    assert sizes == sorted(cluster_sizes(np.roll(contact, (down, right), axis=(0, 1))))
    assert sizes == sorted(cluster_sizes(contact.T))


@pytest.mark.parametrize(
    ("text", "around"),
    [
        ("..... ..... .....", False),
        ("##### ##### #####", True),
        ("##### ..... .....", True),
        ("##.## ..... .....", False),  # over the edge, and ends
        ("#.... .#... ..#.. ...#. ....#", False),  # corners do not connect
        ("##... .##.. ..##. ...## #...#", True),  # the diagonal does, around both
        ("###.. ..### .....", False),  # a step whose ends do not meet over the edge
        ("###.. ..### #...#", True),  # there a third row joins them
    ],
)
def test_percolation_by_hand(text, around):
    assert percolates(contact_map(text)) is around
    assert percolates(contact_map(text).T) is around


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


@given(arrays.arrays(bool, st.tuples(st.integers(1, 7), st.integers(1, 7)), elements=st.booleans()))
@settings(max_examples=100, deadline=None)
def test_percolation_is_that_of_walks_over_many_copies(points):
    """Every walk over the periodic cell that comes back to a point in another period goes around."""
    rows, columns = points.shape
    reached, around = {}, False
    for start in map(tuple, np.argwhere(points)):
        front = [] if start in reached else [start]
        reached.setdefault(start, start)
        while front:
            place = front.pop()
            y, x = reached[place]
            for down, right in ((y + 1, x), (y - 1, x), (y, x + 1), (y, x - 1)):
                cell = down % rows, right % columns
                if points[cell]:
                    around |= reached.get(cell, (down, right)) != (down, right)
                    if cell not in reached:
                        reached[cell] = down, right
                        front.append(cell)
    assert percolates(points) is around
