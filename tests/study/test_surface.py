import numpy as np
import pytest

from contact_study.study.case import realise
from contact_study.study.study import make_study
from tests.study.test_study import changed


def case(**keys):
    return make_study(changed("surface", **keys)).cases[0]


def test_more_points_refine_the_same_surface():
    size = ["1040 angstrom", "520 angstrom"]
    surface = realise(case(size=size, cutoff_mode=5))
    coarse = surface.heights((64, 62))
    # Shared points agree to rounding of heights of order rms_height = 1e-9.
    np.testing.assert_allclose(surface.heights((128, 186))[::2, ::3], coarse, atol=1e-22)
    assert surface.heights((33, 35)).std() == pytest.approx(coarse.std(), abs=0, rel=1e-12)
    assert coarse.mean() == pytest.approx(0, abs=1e-22)
    # Whatever the shape, but not the seed.
    same, other = (realise(case(size=size, cutoff_mode=5, shape=[81, 100], seed=seed)) for seed in (1, 2))
    np.testing.assert_array_equal(same.heights((64, 62)), coarse)
    assert not np.allclose(other.heights((64, 62)), coarse, atol=1e-11)
    # A larger cutoff keeps the long waves, but for the common factor of the normalisation.
    heights = [realise(case(cutoff_mode=mode)).heights((64, 64)) for mode in (8, 16)]
    short, long = (np.abs(np.fft.rfft2(one))[:6, :6].ravel()[1:] for one in heights)
    np.testing.assert_allclose(long / short, long[0] / short[0], rtol=1e-9)


def test_ensemble_has_the_spectrum_asked_for():
    """Mean square height and slope over seeds against expectation, within four standard errors."""
    assert realise(case(normalisation="realised")).rms_height == pytest.approx(10e-10, abs=0, rel=1e-12)
    surfaces = [realise(case(seed=seed)) for seed in range(200)]
    found = np.array([(surface.rms_height**2, surface.rms_slope**2) for surface in surfaces])
    error = np.abs(found.mean(axis=0) - [1e-18, surfaces[0].spectrum.rms_slope ** 2])
    # The discrete modes up to the cutoff are not the integral: a few per cent at 12 modes.
    assert np.all(error < 4 * found.std(axis=0, ddof=1) / np.sqrt(200) + [0.0, 0.05] * found.mean(axis=0))


def test_wave_and_sphere_and_plane():
    wave = realise(case(kind="wavy", amplitude="1 nm", modes=[2, 0], shape=[64, 32]))
    expected = 1e-9 * np.cos(4 * np.pi * np.arange(64) / 64)[:, None] + np.zeros(32)
    np.testing.assert_allclose(wave.heights((64, 32)), expected, atol=1e-22)
    heights = realise(case(kind="sphere", radius="1 um", size=["104 nm", "52 nm"])).heights((64, 32))
    assert np.unravel_index(heights.argmax(), heights.shape) == (32, 16)
    step = 52e-9 / 32
    for curved in (heights[32, 15:18], heights[31:34, 16]):  # differences of 1e-13 of heights of 1e-9
        assert np.diff(curved, 2) == pytest.approx(-1e6 * step**2, abs=0, rel=1e-9)
    # The mean of the paraboloid is zero; that of the points is 2d²/12R below it, the error of the trapezoidal rule.
    assert heights.mean() == pytest.approx(-(step**2) / 6e-6, abs=0, rel=1e-9)
    assert np.all(realise(case(kind="flat")).heights((5, 6)) == 0)
