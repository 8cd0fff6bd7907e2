import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import gaussian_filter

from contact_study.numerics.grid import Grid
from contact_study.physics.height_maps.preparation import detrended, filled, lowpassed, mirrored, windowed

COEFFICIENT = st.floats(-3, 3)
SIDES = st.tuples(st.integers(6, 17), st.integers(6, 17))


def holes(shape, seed, share=0.4):
    noise = gaussian_filter(np.random.default_rng(seed).standard_normal(shape), 1)
    missing = noise < np.quantile(noise, share)
    missing[[0, -1]] = missing[:, [0, -1]] = False
    return missing


@settings(deadline=None, max_examples=25)
@given(SIDES, st.sampled_from([1, 2]), st.tuples(*[COEFFICIENT] * 6), st.integers(0, 99))
def test_a_polynomial_is_removed_and_nothing_else(shape, degree, c, seed):
    y, x = np.mgrid[: shape[0], : shape[1]]
    terms = [1 + 0 * y, y, x, y**2, x * y, x**2][: 3 * degree]
    rough = np.random.default_rng(seed).standard_normal(shape)
    rough[holes(shape, seed)] = np.nan
    left = detrended(rough + sum(a * term for a, term in zip(c, terms, strict=False)), degree)
    # Rounding of heights up to 3e3.
    np.testing.assert_allclose(left, detrended(rough, degree), atol=1e-10)
    assert [np.nansum(term * left) for term in terms] == pytest.approx([0.0] * len(terms), abs=1e-8)  # least squares


@settings(deadline=None, max_examples=25)
@given(SIDES, st.tuples(*[COEFFICIENT] * 5), st.tuples(st.floats(0.3, 3), st.floats(0.3, 3)), st.integers(0, 99))
def test_harmonic_heights_are_filled_exactly(shape, c, spacing, seed):
    y, x = spacing[0] * np.arange(shape[0])[:, None], spacing[1] * np.arange(shape[1])[None, :]
    harmonic = c[0] + c[1] * y + c[2] * x + c[3] * x * y + c[4] * (x**2 - y**2)
    torn = np.where(holes(shape, seed), np.nan, harmonic)
    # A direct solution: rounding of heights up to 3 * 50² times the condition of a hole of a few points.
    np.testing.assert_allclose(filled(torn, spacing), harmonic, atol=1e-9)
    # The maximum principle, also for holes at the edges and in the corners.
    rough = np.random.default_rng(seed).standard_normal(shape) + 5
    torn = np.where(np.random.default_rng(seed + 1).random(shape) < 0.5, np.nan, rough)
    torn[0, 0], torn[-1, -1] = np.nan, rough[-1, -1]
    whole, there = filled(torn, spacing), np.isfinite(torn)
    np.testing.assert_array_equal(whole[there], rough[there])
    assert np.nanmin(torn) - 1e-12 <= whole.min() <= whole.max() <= np.nanmax(torn) + 1e-12


def test_mirror_images_meet_and_a_window_leaves_the_middle_and_joins_the_edges():
    heights = np.random.default_rng(1).standard_normal((40, 60)) + 5
    rows = np.concatenate([heights, heights[::-1]])
    np.testing.assert_array_equal(mirrored(heights), np.concatenate([rows, rows[:, ::-1]], axis=1))
    faded = windowed(heights, 0.5)
    np.testing.assert_array_equal(faded[10:30, 15:45], heights.mean() + (heights - heights.mean())[10:30, 15:45])
    np.testing.assert_allclose(faded[0], heights.mean(), atol=1e-14)
    np.testing.assert_allclose(faded[:, 0], heights.mean(), atol=1e-14)
    # A cosine halfway down its slope is one half; rows and columns have their own.
    assert faded[5, 30] - heights.mean() == pytest.approx(0.5 * (heights[5, 30] - heights.mean()))


def test_lowpass_is_sharp_in_the_wavelength_whatever_the_direction():
    grid, rough = Grid((32, 48), (2.0, 3.0)), np.random.default_rng(1).standard_normal((32, 48))
    kept = np.hypot(np.fft.fftfreq(32, 2 / 32)[:, None], np.fft.fftfreq(48, 3 / 48)) < 2.001  # waves on the limit stay
    np.testing.assert_allclose(np.fft.fft2(lowpassed(rough, grid, 0.5)), np.fft.fft2(rough) * kept, atol=1e-11)
