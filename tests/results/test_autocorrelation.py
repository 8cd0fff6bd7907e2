"""Autocorrelation of the contact on patterns whose pairs can be counted."""

import numpy as np
import pytest

from contact_study.results.observables.contact_map import RING_EDGES, RINGS, contact_autocorrelation


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
    found = contact_autocorrelation(contact, spacing, periodic)
    np.testing.assert_allclose(found, counted(contact, spacing, periodic), atol=1e-14)  # rounding
