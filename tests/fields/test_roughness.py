"""What a surface is like, against surfaces of which it is known."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contact_study.fields.grid import Grid
from contact_study.fields.roughness import roughness_of
from contact_study.problem.study import make_study
from contact_study.problem.surface import realise
from tests.problem.test_study import changed

UNIT = 2 * np.pi / 104e-9


def surface(**keys):
    return realise(make_study(changed("surface", **keys)).cases[0])


def test_moments_of_a_wave():
    grid = Grid((32, 40), (2.0, 3.0))
    y, x = grid.coordinates
    q = 2 * np.pi * np.hypot(3 / 2, 2 / 3)
    heights = 5 + 0.1 * np.cos(2 * np.pi * (3 * y[:, None] / 2 + 2 * x[None, :] / 3))
    found = roughness_of(heights, grid)
    amplitude = 0.1 / np.sqrt(2)
    # To rounding of transforms of heights of 5.
    assert found.rms_height == pytest.approx(amplitude, abs=0, rel=1e-12)
    assert found.rms_slope == pytest.approx(amplitude * q, abs=0, rel=1e-12)
    assert found.rms_curvature == pytest.approx(amplitude * q**2 / 2, abs=0, rel=1e-12)


def test_the_spectrum_integrates_to_the_heights():
    """Σ C (2π)²/A over all waves is h_rms², and of a sample of many waves C is its target's within their scatter."""
    found = surface(cutoff_mode=24, roll_off_mode=4, seed=5)
    spectrum = found.roughness.spectrum
    cell = UNIT**2
    assert np.sum(spectrum.density * spectrum.waves) * cell == pytest.approx(found.rms_height**2, abs=0, rel=1e-9)
    several = (spectrum.waves > 100) & (spectrum.wavevectors < 22 * UNIT)
    assert several.sum() >= 5
    ratio = spectrum.density[several] / found.spectrum.density(spectrum.wavevectors[several])
    # |h_q|² scatters by itself: a mean over n/2 pairs of waves by √(2/n); the mean square is that of the ensemble,
    # of which a sample's long waves are off by some ten per cent.
    assert np.all(np.abs(np.log(ratio)) < 4 * np.sqrt(2 / spectrum.waves[several]) + 0.02)


@pytest.mark.parametrize(("hurst", "roll_off", "cutoff"), [(0.8, 4, 64), (0.5, 8, 100), (0.2, 12, 90), (0.9, 1, 127)])
def test_the_law_of_a_self_affine_surface_is_found(hurst, roll_off, cutoff):
    fits = [
        surface(
            shape=[256, 256], hurst_exponent=hurst, roll_off_mode=roll_off, cutoff_mode=cutoff, seed=seed
        ).roughness.fit
        for seed in range(3)
    ]
    # Thousands of waves give H to a hundredth; roll-offs are ends of bands of an eighth of an octave (9 %) among
    # few waves, cutoffs end among many.
    assert np.mean([fit.hurst_exponent for fit in fits]) == pytest.approx(hurst, abs=0.03)
    assert np.median([fit.roll_off for fit in fits]) / UNIT == pytest.approx(roll_off, abs=0, rel=0.15)
    assert np.mean([fit.cutoff for fit in fits]) / UNIT == pytest.approx(cutoff, abs=0, rel=0.03)


def test_the_law_is_found_above_noise_which_is_told():
    clean = surface(shape=[256, 256], roll_off_mode=4, cutoff_mode=64)
    assert clean.roughness.noise[1] < 0.01
    noise = 5e-11 * np.random.default_rng(0).standard_normal((256, 256))
    noisy = roughness_of(clean.sampled + noise, clean.grid)
    power, share = noisy.noise
    assert abs(power) < 0.2  # white: C is flat
    assert share > 0.1
    # The floor of the noise adds to the law just below the cutoff, too, and flattens it a little.
    assert noisy.fit.hurst_exponent == pytest.approx(0.8, abs=0.07)


def test_too_narrow_or_flat_spectra_have_no_law():
    assert roughness_of(np.zeros((16, 16)), Grid((16, 16), (1.0, 1.0))).fit is None
    assert roughness_of(np.random.default_rng(1).standard_normal((4, 4)), Grid((4, 4), (1.0, 1.0))).fit is None


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 10**6), st.floats(0.1, 10), st.floats(1e-9, 1e3))
def test_turning_and_scaling(seed, stretch, scale):
    rough = np.random.default_rng(seed).standard_normal((12, 18)).cumsum(axis=0)
    grid, turned = Grid((12, 18), (1.0, stretch)), Grid((18, 12), (stretch * scale, scale))
    one, two = roughness_of(rough, grid), roughness_of(scale * rough.T, turned)
    # The same sums in another order.
    assert two.rms_height == pytest.approx(scale * one.rms_height, abs=0, rel=1e-10)
    assert two.rms_slope == pytest.approx(one.rms_slope, abs=0, rel=1e-10)
    assert two.rms_curvature == pytest.approx(one.rms_curvature / scale, abs=0, rel=1e-10)
    assert two.edge_jump == pytest.approx(scale * one.edge_jump, abs=0, rel=1e-10)
    assert two.edge_ratio == pytest.approx(one.edge_ratio, abs=0, rel=1e-10)


@pytest.mark.parametrize("axis", [0, 1])
def test_edges_that_jump(axis):
    periodic = surface(cutoff_mode=12, shape=[64, 64])
    assert periodic.roughness.edge_ratio < 2  # rows across the edge differ as any two do, but for scatter
    tilt = np.linspace(0, 1e-8, 64)
    tilted = roughness_of(periodic.sampled + (tilt[:, None] if axis == 0 else tilt[None, :]), periodic.grid)
    # 1e-8 across one edge, on heights that differ by far less from row to row.
    assert tilted.edge_jump == pytest.approx(1e-8, abs=0, rel=0.05)
    assert tilted.edge_ratio > 20


def test_a_flat_axis_has_no_jump():
    wave = surface(kind="wavy", amplitude="1 nm", modes=[0, 2])
    assert wave.roughness.edge_ratio < 2


def test_the_spectrum_ends_where_waves_of_all_directions_do():
    """Waves along the diagonals are shorter than two points; bands of them alone would be of one direction."""
    grid = Grid((32, 32), (1.0, 1.0))
    heights = np.random.default_rng(2).standard_normal(grid.shape)
    spectrum = roughness_of(heights, grid).spectrum
    assert spectrum.wavevectors[-1] <= 32 * np.pi
    assert spectrum.waves.sum() == np.sum(np.hypot(*np.meshgrid(*2 * [np.fft.fftfreq(32)])) <= 0.5) - 1
