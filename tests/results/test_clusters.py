"""Contact clusters and percolation, by hand and against slow ways to find them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from contact_study.results.observables.contact_map import cluster_map, percolates


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
