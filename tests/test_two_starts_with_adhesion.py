"""Two starts under a short-ranged attraction: both states are in balance, and that of approach has more contact."""

import numpy as np
import pytest

from research import two_starts_with_adhesion
from research.two_starts_with_adhesion import CELL, RADIUS, rms_curvature, surface

pytestmark = pytest.mark.filterwarnings("ignore:grid too coarse")


def test_surface_has_the_radius_it_says():
    points = 128
    height = surface(points, 2)
    dx = CELL / points
    laplacian = sum(np.roll(height, step, axis) for step in (1, -1) for axis in (0, 1)) - 4 * height
    # Differences of the shortest wave, 3.2 points long, see 70 % of its curvature.
    assert 0.65 < np.std(laplacian) / dx**2 / 2 * RADIUS < 1
    wave = 1e-9 * np.cos(2 * np.pi * np.arange(points) / points) * np.ones((points, 1))
    assert rms_curvature(wave) == pytest.approx(1e-9 * (2 * np.pi / CELL) ** 2 / 2 / np.sqrt(2), rel=1e-9)


def test_both_states_are_in_balance_and_approach_goes_further(capsys):
    assert two_starts_with_adhesion.main(["--points", "128"]) == 0
    rows = [line.strip("| ").split(" | ") for line in capsys.readouterr().out.splitlines()[2:]]
    assert [row[2] for row in rows] == ["separation", "the hard wall"]
    approach, pressed = ([float(cell) for cell in row[3:]] for row in rows)
    for area, bare, _, residual, pairs in (approach, pressed):
        assert area > 1.1 * bare
        assert residual < 1e-8
        assert pairs > 10
    assert approach[0] > pressed[0]
    # Energies differ by a part of the adhesion of the area between the two, 5 mJ/m² of it.
    assert abs(approach[2] - pressed[2]) < 5.0 * (approach[0] - pressed[0])
