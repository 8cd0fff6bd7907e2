"""Two ways to write one load on the solid: its field, and the heights that it flattens."""

from dataclasses import replace

import numpy as np
import pytest

from bem_adhesion.kernels.law import blocks
from bem_adhesion.operators.fourier import periodic
from bem_adhesion.operators.load import Load
from contact_study.numerics.grid import Grid
from contact_study.physics.solids import HalfSpace

GRID = Grid((24, 30), (3.0, 5.0))
UNIT = 0.25


@pytest.fixture(params=[0.0, 0.7], ids=["free", "on a spring"])
def solid(request):
    return periodic(HalfSpace(2.0), request.param)(GRID, np.float64)


def both(solid, pressure):
    height = np.random.default_rng(0).standard_normal(GRID.shape)
    solid.field[...] = UNIT * height
    field = solid.apply(solid.stiffness).copy()
    return Load(field, pressure=pressure), replace(Load.of_heights(solid, height, UNIT), pressure=pressure)


def test_both_press_alike(solid):
    by_field, by_height = both(solid, 0.3)
    assert by_field.pressure == by_height.pressure == 0.3
    gap = np.random.default_rng(1).random(GRID.shape)
    expected = by_field.press(gap, solid).copy()
    solid.field[...] = gap
    assert not np.allclose(expected, solid.apply(solid.stiffness))
    np.testing.assert_allclose(by_height.press(gap, solid), expected, atol=1e-12)  # sums of 720 numbers of order 10


def test_both_have_the_energy_of_solid_and_field(solid, monkeypatch):
    monkeypatch.setattr("bem_adhesion.kernels.law.BLOCK", 200)
    gap = np.random.default_rng(1).random(GRID.shape)
    for load in both(solid, 0.3):
        solid.field[...] = gap
        elastic = solid.apply(solid.stiffness).copy()
        pressing = load.press(gap, solid).copy()
        rows = list(blocks(gap))
        assert len(rows) > 2
        rest = sum(load.rest_of_energy(pressing, gap, here) for here in rows)
        expected = np.vdot(gap, 0.5 * elastic + (pressing - elastic))
        assert load.energy + rest + 0.5 * np.vdot(pressing, gap) == pytest.approx(expected, rel=1e-12)


def test_the_heights_alone_press_what_flattens_them(solid):
    by_field, by_height = both(solid, 0.0)
    nothing = np.zeros(GRID.shape)
    np.testing.assert_allclose(by_height.press(nothing, solid), by_field.field, atol=1e-14)
    assert by_height.energy == pytest.approx(-0.5 * UNIT * np.vdot(by_field.field, by_height.field), rel=1e-14)
