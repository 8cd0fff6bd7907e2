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


def chosen(**keys):
    table = changed("output", **keys)
    table["sweep"] = {"interaction.well_depth_ratio": [1, 8]}
    study = make_study(table)
    return study.bins, study.cases[-1]


def test_zero_stress_lies_in_the_middle_of_a_bin_and_the_strongest_law_fits():
    bins, strongest = chosen()
    width = bins.pressure_edges[1] - bins.pressure_edges[0]
    assert np.abs(bins.pressure).min() < 1e-9 * width  # rounding of edges of a hundred widths
    assert bins.pressure_edges[0] < -strongest.law.peak_tensile_stress
    assert bins.pressure_edges[-1] > 10e9
    assert bins.gap_edges[0] == 0.0


def test_detachment_stress_of_perssons_theory_fits_and_nothing_beyond_full_contact():
    """Cracks of a weak law on a smooth surface carry five times its peak stress; a flatter one never stresses them."""
    table = changed("surface", rms_height="1 angstrom")
    table["interaction"]["well_depth_ratio"] = 0.1
    (case,) = make_study(table).cases
    wave = case.solid.stiffness(np.array([2 * np.pi * 12 / 104e-9]))[0]
    cracks = np.sqrt(2 * wave * case.law.work_of_adhesion)
    assert cracks > 5 * case.law.peak_tensile_stress
    edge = make_study(table).bins.pressure_edges[0]
    assert edge == pytest.approx(-cracks, rel=0.1)  # two digits, upwards, and half a bin
    assert edge < -cracks
    table["surface"]["rms_height"] = "0.1 angstrom"
    assert make_study(table).bins.pressure_edges[0] > -cracks


def test_seeds_have_the_same_bins_and_given_ranges_are_kept():
    one, other = (make_study(changed("sweep", **{"surface.seed": seeds})).bins for seeds in ([1], [3, 4]))
    np.testing.assert_array_equal(other.pressure_edges, one.pressure_edges)
    np.testing.assert_array_equal(other.gap_edges, one.gap_edges)
    bins, _ = chosen(pressure_range=["-1 GPa", "3 GPa"], pressure_bins=8, gap_range=["0 nm", "2 nm"], gap_bins=4)
    np.testing.assert_allclose(bins.pressure_edges, np.linspace(-1e9, 3e9, 9))
    assert bins.gap == pytest.approx([0.25e-9, 0.75e-9, 1.25e-9, 1.75e-9], rel=1e-12, abs=0)


def test_surfaces_fit_into_the_bins():
    """One surface in fifty may be higher than its bins expect, by the choice of the expected number of such places."""
    table = changed("surface", cutoff_mode=28, hurst_exponent=0.3, normalisation="spectrum")
    table["sweep"] = {"surface.seed": list(range(100))}
    study = make_study(table)
    (scale,) = set(make_study(changed("surface", cutoff_mode=28, hurst_exponent=0.3)).scales)
    surfaces = [realise(case) for case in study.cases]
    extreme = np.array([np.abs(one.heights(one.shape)).max() for one in surfaces])
    # Places of excess come singly at this height: Poisson, of mean 0.02 a surface, hence above 8 in 100 surfaces with a
    # probability of 3e-4. The bound is no wider than that: at four fifths of it places are 20 times as many.
    assert np.count_nonzero(extreme > scale.peak_to_valley / 2) <= 8
    assert np.count_nonzero(extreme > 0.4 * scale.peak_to_valley) >= 12


def test_scales_of_other_surfaces_are_theirs():
    for surface, error in (
        ({"kind": "wavy", "amplitude": "1 nm", "modes": [2, 3]}, 1e-12),
        # Sums over 256 points are the integrals to the square of their distance.
        ({"kind": "sphere", "radius": "50 nm", "shape": [256, 256]}, 1e-4),
        ({"kind": "flat"}, 0),
    ):
        study = make_study(changed("surface", size=["104 nm", "52 nm"], **surface))
        (scale,) = study.scales
        heights = realise(study.cases[0]).heights(scale.shape)
        assert scale.rms_height == pytest.approx(heights.std(), rel=error, abs=1e-30)
        # Points beside the crests.
        assert scale.peak_to_valley == pytest.approx(np.ptp(heights), abs=0, rel=max(error, 0.01))
        slopes = np.gradient(heights, 104e-9 / scale.shape[0], 52e-9 / scale.shape[1])
        # Differences of second order, one-sided at the rim.
        assert scale.rms_slope == pytest.approx(np.sqrt(np.mean(np.square(slopes).sum(0))), rel=0.05, abs=1e-30)
        assert scale.pixel == 104e-9 / scale.shape[0]


def test_ranges_are_those_of_the_largest_values_also_on_a_wall_that_carries_nothing():
    """Six deviations of the full-contact stress beside pressure and peak; heights, contact and prescribed gaps."""
    table = changed("loading", path=["1 GPa", "200 GPa"])
    study = make_study(table)
    bins = study.bins
    (case,), (scale,) = study.cases, study.scales
    highest = 3 * case.material.contact_modulus * scale.rms_slope + 200e9 + case.law.peak_tensile_stress
    # Rounded upwards to two digits, and moved by half a bin for zero to lie in the middle of one.
    width = bins.pressure_edges[1] - bins.pressure_edges[0]
    assert 0 <= bins.pressure_edges[-1] + width - highest <= 0.1 * highest
    widest = 1.1 * scale.peak_to_valley + 4 * case.contact_distance
    assert 0 <= bins.gap_edges[-1] - widest <= 0.1 * widest
    table["loading"] = {"control": "gap", "path": ["30 nm", "1 nm"]}
    bins = make_study(table).bins
    assert 0 <= bins.gap_edges[-1] - (widest + 30e-9) <= 0.1 * (widest + 30e-9)
    assert bins.pressure_edges[-1] < 0.5 * highest  # 30 nm are no pressure
    table = changed("surface", kind="flat")
    table["interaction"] = {"law": "hard_wall"}
    table["loading"] = {"control": "gap", "path": [0.0, 1e-9]}
    bins = make_study(table).bins
    assert np.all(np.isfinite(bins.pressure_edges))
    assert bins.pressure_edges[0] < 0 < bins.pressure_edges[-1]
    assert bins.gap_edges[-1] >= 1e-9
