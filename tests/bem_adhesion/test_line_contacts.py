"""Surfaces that end along one axis and repeat along the other: cylinders of Hertz and of JKR, kernels and studies."""

import re

import numpy as np
import pytest

import contact_study
from bem_adhesion import Exponential, HardWall, rough_contact
from bem_adhesion.free_half_space import _cell_displacement, _row_displacement
from contact_study.inputs.errors import InputError

RADIUS = EXTENT = MODULUS = 1.0
BOTH = pytest.mark.parametrize("boundary", ["free_x", "free_y"])


def cylinder(points, boundary, rows=4):
    x = (np.arange(points) + 0.5) * EXTENT / points - EXTENT / 2
    height, size = np.tile(-(x**2) / (2 * RADIUS), (rows, 1)), (rows * EXTENT / points, EXTENT)
    return (height, size) if boundary == "free_x" else (np.ascontiguousarray(height.T), size[::-1])


@pytest.mark.validation
def test_rows_are_sums_over_their_cells_up_to_the_distance_that_they_count_from():
    y, x, period, reference, periods = 0.1 * np.arange(5), 0.1 * np.arange(9), 0.8, 3.0, 20_000
    cells = sum(_cell_displacement(y + m * period, x, 0.1, 0.1) for m in range(-periods, periods + 1))
    rest = cells - _row_displacement(y, x, 0.1, 0.1, period, reference)
    # The sum grows as 2 A/L ln; what is left out of the integral is 1e-7 of the largest, what is cut off 1e-9.
    grown = 2 * 0.01 / period * np.log((2 * periods + 1) * period / reference)
    np.testing.assert_allclose(rest, grown, atol=1e-7 * cells.max(), rtol=0)


@BOTH
def test_a_cylinder_on_a_wall_is_hertz_s_line_contact(boundary):
    """K. L. Johnson, Contact Mechanics, Cambridge 1985, ch. 4: a² = 4FR/(πE*), p₀ = 2F/(πa)."""
    points, force = 256, 0.02
    height, size = cylinder(points, boundary)
    contact = rough_contact(height, size, MODULUS, HardWall(), boundary=boundary)
    found = contact.step(contact.separated(), force / EXTENT)
    across = 1 if boundary == "free_x" else 0
    width = np.sqrt(4 * force * RADIUS / (np.pi * MODULUS))
    pressure = found.pressure.take(0, axis=1 - across)
    assert np.ptp(found.pressure, axis=1 - across).max() < 1e-12 * pressure.max()
    assert np.count_nonzero(pressure) * EXTENT / points / 2 == pytest.approx(width, abs=EXTENT / points)
    assert pressure.max() == pytest.approx(2 * force / (np.pi * width), rel=1e-3)  # spacing over width, squared
    # Hertz's pressures in the logarithm that is zero at the extent of the surface.
    approach = force / (np.pi * MODULUS) * (2 * np.log(2 * EXTENT / width) + 1)
    assert height.max() - found.plane == pytest.approx(approach, rel=1e-3)
    held = rough_contact(height, size, MODULUS, HardWall(), control="approach", boundary=boundary)
    steps = [held.step(held.separated(), height.max() - found.plane + shift) for shift in (-1e-4, 0.0, 1e-4)]
    assert steps[1].pressure.mean() == pytest.approx(force / EXTENT, rel=1e-8)
    # Force and energy agree: the central difference errs by the third derivative, 1e-6.
    slope = (steps[2].elastic_energy - steps[0].elastic_energy) / 2e-4
    assert slope == pytest.approx(force / EXTENT, rel=1e-5)


def test_a_cylinder_under_adhesion_pulls_off_at_the_force_of_jkr():
    """F = π E* a²/4R − √(2π E* w a) per length of the line; its least is −(3/4) (4π E* w² R)^(1/3).

    M. K. Chaudhury et al., J. Appl. Phys. 80, 30 (1996).
    """
    work, points = 1e-3, 512
    contact = rough_contact(
        *cylinder(points, "free_x"), MODULUS, Exponential(work, 2.8e-3), control="approach", boundary="free_x"
    )
    state, forces = contact.separated(), []
    for approach in (0.02, *np.linspace(0.01, -0.04, 41)):
        found = contact.step(state, approach)
        assert found.converged
        state = found.state
        forces.append(found.pressure.mean() * EXTENT)
    # A range of a quarter of (w²R/E*²)^(1/3) changes it by less than a hundredth, as do steps of the approach.
    assert min(forces) == pytest.approx(-0.75 * (4 * np.pi * MODULUS * work**2 * RADIUS) ** (1 / 3), rel=0.01)


def test_two_periods_carry_what_one_does():
    rng = np.random.default_rng(1)
    height, size = cylinder(64, "free_x", 16)
    height = height + 0.01 * rng.random(height.shape)
    for law in (HardWall(), Exponential(1e-4, 2.6e-3)):
        one, two = (
            rough_contact(np.tile(height, (n, 1)), (n * size[0], size[1]), MODULUS, law, boundary="free_x")
            for n in (1, 2)
        )
        states = [each.step(each.separated(), 0.01) for each in (one, two)]
        # Tolerances of both; the period's sum is known to 1e-7.
        expected = np.tile(states[0].pressure, (2, 1))
        np.testing.assert_allclose(states[1].pressure, expected, atol=1e-5 * expected.max())
        assert states[1].plane == pytest.approx(states[0].plane, abs=1e-7)


STUDY = {
    "surface": {"kind": "wavy", "size": ["1 um", "1 um"], "shape": [16, 16], "amplitude": "1 nm"},
    "material": {"youngs_modulus": "1 GPa", "poissons_ratio": 0.0},
    "elasticity": {"boundary": "free_x"},
    "interaction": {"law": "hard_wall"},
    "loading": {"path": ["0.1 MPa"]},
}


def test_a_study_of_a_strip_warns_of_its_free_ends_alone():
    with pytest.warns(UserWarning, match=r'elasticity.boundary = "free_x": at .* contact reaches the rim'):
        found = contact_study.run(STUDY)
    assert bool(found["converged"].all())


@pytest.mark.parametrize(
    ("section", "keys", "words"),
    [
        ("elasticity", {"kind": "layer", "thickness": "1 um", "boundary": "free_y"}, 'elasticity.boundary = "free_y"'),
        ("elasticity", {"boundary": "free_z"}, "expected one of periodic, free, free_x, free_y"),
        ("loading", {"control": "gap", "path": ["1 nm"]}, 'elasticity.boundary = "free_x" takes "pressure"'),
        ("solver", {"path": "overdamped"}, 'elasticity.boundary = "free_x"'),
    ],
)
def test_what_a_strip_cannot_be_is_one_line(section, keys, words):
    with pytest.raises(InputError, match=re.escape(words)):
        contact_study.run({**STUDY, section: keys})
