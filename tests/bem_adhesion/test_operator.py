import numpy as np
import pytest

from bem_adhesion.operator import HalfSpace, compliance, shifted_compliance, stiffness
from contact_study.fields.grid import Grid

E_STAR = 93.7348e9
GRIDS = [
    Grid((16, 16), (1e-7, 1e-7)),
    Grid((15, 21), (1e-7, 1.4e-7)),
    Grid((16, 9), (3e-8, 1e-7)),
    Grid((7, 32), (1e-3, 2e-3)),
]


@pytest.mark.parametrize("grid", GRIDS, ids=lambda grid: f"{grid.shape}")
@pytest.mark.parametrize("mode", [(1, 0), (0, 1), (2, 3), (-3, 2)])
def test_cosine_pressure_gives_cosine_displacement(grid, mode):
    y, x = grid.coordinates
    q_y, q_x = 2 * np.pi * mode[0] / grid.size[0], 2 * np.pi * mode[1] / grid.size[1]
    wave = np.cos(q_y * y[:, None] + q_x * x[None, :] + 0.3)
    half_space = HalfSpace(grid, E_STAR)
    half_space.field[...] = 1e9 * wave
    expected = 2 * 1e9 / (E_STAR * np.hypot(q_y, q_x))
    # Rounding: a transform of n points loses a few eps * log2(n).
    np.testing.assert_allclose(half_space.compliance() / expected, wave, atol=1e-14)
    np.testing.assert_allclose(half_space.stiffness() / 1e9, wave, atol=1e-14)
    assert half_space.pairs == 2


@pytest.mark.parametrize("grid", GRIDS, ids=lambda grid: f"{grid.shape}")
def test_stiffness_inverts_compliance_of_any_pressure_without_mean(grid):
    pressure = 1e9 * np.random.default_rng(0).standard_normal(grid.shape)
    half_space = HalfSpace(grid, E_STAR)
    half_space.field[...] = pressure
    half_space.compliance()
    assert abs(half_space.field.mean()) < 1e-15 * np.abs(half_space.field).max()
    np.testing.assert_allclose(half_space.stiffness(), pressure - pressure.mean(), atol=1e-13 * 1e9 * 4)


def test_mean_displacement_feels_only_the_spring():
    grid = GRIDS[1]
    half_space = HalfSpace(grid, E_STAR, mean_stiffness=5e17)
    half_space.field[...] = 2e-10
    np.testing.assert_allclose(half_space.stiffness(), 1e8, rtol=1e-13)


def test_shifted_compliance_is_the_inverse_of_half_space_and_springs():
    grid = GRIDS[1]
    product = shifted_compliance(grid, E_STAR, 1e18) * (stiffness(grid, E_STAR) + 1e18)
    np.testing.assert_allclose(product, 1.0, rtol=1e-14)
    assert compliance(grid, E_STAR)[0, 0] == 0.0


def test_energy_of_a_sinusoidal_displacement():
    # <u K u>/2 of u0 cos(qx) is E* q u0² / 8.
    grid = Grid((12, 10), (1e-7, 1e-7))
    q = 2 * np.pi / 1e-7
    wave = 2e-10 * np.cos(q * grid.coordinates[1])[None, :] * np.ones((12, 1))
    half_space = HalfSpace(grid, E_STAR)
    half_space.field[...] = wave
    assert np.mean(wave * half_space.stiffness()) / 2 == pytest.approx(E_STAR * q * 4e-20 / 8, rel=1e-13)


def test_single_precision_counts_half_and_coarser_grids_by_points():
    fine, coarse = Grid((16, 16), (1.0, 1.0)), Grid((8, 8), (1.0, 1.0))
    single = HalfSpace(coarse, 1.0, np.float32)
    single.field[...] = np.cos(2 * np.pi * coarse.coordinates[1])
    wave = single.field.copy()
    single.compliance()
    np.testing.assert_allclose(single.field, wave / np.pi, atol=1e-6)  # single rounding is 6e-8
    assert single.equivalent_pairs(fine) == 0.5 / 4


@pytest.mark.parametrize("grid", GRIDS, ids=lambda grid: f"{grid.shape}")
def test_sum_on_the_spectrum_is_the_scalar_product(grid):
    field = np.random.default_rng(1).standard_normal(grid.shape)
    half_space = HalfSpace(grid, 1.0, mean_stiffness=3.0 / grid.size[0])
    kernel = half_space.kernel(stiffness(grid, 1.0, 3.0 / grid.size[0]))
    half_space.field[...] = field
    total = half_space.apply_and_sum(kernel)
    assert total == pytest.approx(np.vdot(field, half_space.field), rel=1e-13)
