"""Hard wall on the paper's surface: published means, work and memory at sizes that matter."""

import tracemalloc

import numpy as np
import pytest

from bem_adhesion.hard_wall.contact import HardWallContact
from tests.bem_adhesion.rough_surfaces import CONTACT_MODULUS, at, self_affine, solve

pytestmark = pytest.mark.validation

PRESSURES = np.array([0.1, 0.5, 1, 2, 5, 10]) * 1e9
# An independent prototype's means over three other surfaces of 192² points.
REFERENCE_AREA = np.array([0.0112, 0.0494, 0.0953, 0.178, 0.387, 0.649])
REFERENCE_GAP = np.array([2.01, 1.36, 1.04, 0.717, 0.333, 0.115])


def test_paper_surface_has_the_reference_area_and_mean_gap():
    """Means over 12 surfaces against means over 3 others: within 3 standard errors of their difference."""
    seeds = 12
    states = []
    for seed in range(seeds):
        height, grid = self_affine(192, seed=seed)
        contact = HardWallContact(height, grid, CONTACT_MODULUS)
        solutions = [at(contact, pressure) for pressure in PRESSURES]
        states.append([(np.mean(found.pressure > 0), found.gap.mean() / 1e-9) for found in solutions])
    mean, scatter = np.mean(states, axis=0), np.std(states, axis=0, ddof=1)
    error = scatter * np.sqrt(1 / seeds + 1 / 3)
    assert np.all(np.abs(mean[:, 0] - REFERENCE_AREA) < 3 * error[:, 0])
    assert np.all(np.abs(mean[:, 1] - REFERENCE_GAP) < 3 * error[:, 1])


def test_memory_stays_within_eleven_arrays():
    """Numbers in double precision a point, the caller's heights and the returned fields included."""
    height, grid = self_affine(1024)
    solve(height, grid, CONTACT_MODULUS, 1e9)  # compiled and planned
    tracemalloc.start()
    copy = height.copy()
    found = solve(copy, grid, CONTACT_MODULUS, 1e9)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert found.converged
    assert peak <= 11 * height.nbytes
