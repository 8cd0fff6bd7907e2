"""Contact clusters on a periodic cell."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from contact_study.results.observables.contact_clusters import cluster_sizes


def contact_map(text):
    return np.array([[mark == "#" for mark in line] for line in text.split()])


@pytest.mark.parametrize(
    ("text", "sizes"),
    [
        ("..... ..... .....", []),
        ("##### ##### #####", [15]),
        ("..... .#... .....", [1]),
        (".#.#. .#.#. .....", [2, 2]),
        ("#...# ..... .....", [2]),  # across the edge along x
        (".#... ..... .#...", [2]),  # across the edge along y
        ("#...# ..... #...#", [4]),  # across both: the four corners of the map are one patch
        ("#.... ..... ....#", [1, 1]),  # corners that meet only by a corner across both edges
        (".#... ..#.. .....", [1, 1]),  # a corner is no connection
        ("##.## ..... .#...", [5]),  # in three pieces of the map
        ("#..#. ###.. ....#", [4, 1, 1]),
        ("#.#.# #.#.# #.#.#", [6, 3]),  # stripes, one of them across the edge
    ],
)
def test_clusters_by_hand(text, sizes):
    assert sorted(cluster_sizes(contact_map(text)), reverse=True) == sizes


def test_with_free_boundaries_clusters_end_at_the_rim():
    assert cluster_sizes(contact_map("#...# ..... #...#"), periodic=False).tolist() == [1, 1, 1, 1]
    assert cluster_sizes(contact_map("#.#.# #.#.# #.#.#"), periodic=False).tolist() == [3, 3, 3]


@pytest.mark.parametrize("shape", [(1, 5), (5, 1), (1, 1)])
def test_cells_of_one_row(shape):
    assert cluster_sizes(np.ones(shape, bool)).tolist() == [max(shape)]


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


@settings(max_examples=200, deadline=None)
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
