"""Percolation on a periodic cell."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from scipy import ndimage

from contact_study.results.observables.percolation import goes_around, goes_through
from tests.results.test_contact_clusters import contact_map


@pytest.mark.parametrize(
    ("text", "around"),
    [
        ("..... ..... .....", False),
        ("##### ##### #####", True),
        ("##### ..... .....", True),
        (".#... .#... .#...", True),
        ("####. ..... .....", False),
        ("##.## ..... .....", False),  # over the edge, and ends
        ("#.... .#... ..#.. ...#. ....#", False),  # corners do not connect
        ("##... .##.. ..##. ...## #...#", True),  # the diagonal does, around both
        ("###.. ..### .....", False),  # a step whose ends do not meet over the edge
        ("###.. ..### #...#", True),  # there a third row joins them
        (".##.. ...## #....", False),
    ],
)
def test_by_hand(text, around):
    assert goes_around(contact_map(text)) is around
    assert goes_around(contact_map(text).T) is around


@pytest.mark.parametrize(
    ("text", "through"),
    [
        ("..... ..... .....", False),
        ("##### ..... .....", True),
        ("##.## ..... .....", False),
        ("###.. ..### .....", True),  # though its ends do not meet over the edge
        ("#.... .#... ..#.. ...#. ....#", False),  # corners do not connect
        ("#...# ..... .....", False),  # a patch at either rim
        ("##... #.... .....", False),  # neighbouring rims are not opposite
    ],
)
def test_free_boundaries_by_hand(text, through):
    assert goes_through(contact_map(text)) is through
    assert goes_through(contact_map(text).T) is through


@given(arrays.arrays(bool, st.tuples(st.integers(1, 7), st.integers(1, 7)), elements=st.booleans()))
@settings(max_examples=200, deadline=None)
def test_against_many_copies_of_the_map(points):
    """A patch that goes around has in a wide repetition of the map as many points as there is room for."""
    rows, columns = points.shape
    copies = 2 * points.size + 3  # no way around crosses more periods than the map has points
    tiled = np.tile(points, (copies, copies)) if points.size <= 12 else np.tile(points, (9, 9))
    labels, _ = ndimage.label(tiled)
    middle = (tiled.shape[0] // rows // 2 * rows, tiled.shape[1] // columns // 2 * columns)
    central = labels[middle[0] : middle[0] + rows, middle[1] : middle[1] + columns]
    around = False
    for down in range(tiled.shape[0] // rows):
        for across in range(tiled.shape[1] // columns):
            image = labels[down * rows : (down + 1) * rows, across * columns : (across + 1) * columns]
            same_place = (down * rows, across * columns) == middle
            around |= not same_place and bool(np.any((central > 0) & (central == image)))
    if points.size <= 12 or not goes_around(points):
        assert goes_around(points) is around


def test_stripes_and_their_gaps_both_go_around():
    stripes = np.zeros((6, 6), bool)
    stripes[::2] = True
    assert goes_around(stripes)
    assert goes_around(~stripes)
