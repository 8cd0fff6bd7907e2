"""Roughness spectra: the reference numbers of the paper's surface, moments against quadrature, realised surfaces."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from contact_study.numerics.grid import Grid
from contact_study.physics.roughness.spectrum import RadialSpectrum, SelfAffineSpectrum, radial_spectrum
from contact_study.physics.solids import HalfSpace

ANGSTROM = 1e-10
Q_L = 2 * np.pi / (1040 * ANGSTROM)
PAPER = SelfAffineSpectrum(0.8, 10 * ANGSTROM, Q_L, 3 * Q_L, 12 * Q_L)
CONTACT_MODULUS = 77.2e9 / (1 - 0.42**2)


def test_reference_numbers_of_the_paper():
    # Half a unit of the last digit of each reference value.
    assert PAPER.plateau / ANGSTROM**4 == pytest.approx(48379.66, abs=0.005)
    assert PAPER.rms_slope == pytest.approx(0.26244, abs=5e-6)
    assert PAPER.rms_laplacian * ANGSTROM == pytest.approx(0.01106, abs=5e-6)
    stiffness = HalfSpace(CONTACT_MODULUS).stiffness
    assert np.sqrt(PAPER.full_contact_stress_variance(stiffness)) == pytest.approx(12.300e9, abs=5e5)
    assert PAPER.full_contact_energy(stiffness) == pytest.approx(5.3532, abs=5e-5)


def test_rms_height_is_the_integral_of_the_density():
    corner = PAPER.roll_off
    mean_square = sum(
        quad(lambda q: 2 * np.pi * q * PAPER.density(q), a, b, epsrel=1e-11)[0]
        for a, b in ((PAPER.low, corner), (corner, PAPER.cutoff))
    )
    assert np.sqrt(mean_square) == pytest.approx(10 * ANGSTROM, abs=0, rel=1e-10)
    assert PAPER.mean_square_height == pytest.approx(mean_square, abs=0, rel=1e-10)
    assert np.all(PAPER.density(np.array([0.99 * Q_L, 12.01 * Q_L])) == 0)


@given(
    hurst=st.floats(0, 1),
    octaves=st.tuples(st.floats(0, 3), st.floats(0.1, 4)),
    order=st.sampled_from([0, 1, 2, 3, 5, 2.5]),
    limits=st.tuples(st.floats(0, 1), st.floats(0, 1)),
)
def test_moments_agree_with_quadrature(hurst, octaves, order, limits):
    low = 3.0
    roll_off = low * 2 ** octaves[0]
    spectrum = SelfAffineSpectrum(hurst, 0.1, low, roll_off, roll_off * 2 ** octaves[1])
    a, b = np.sort(low * (spectrum.cutoff / low) ** np.array(limits))
    middle = np.clip(roll_off, a, b)
    expected = sum(
        quad(lambda q: q**order * spectrum.density(q), x, y, epsrel=1e-10)[0] for x, y in ((a, middle), (middle, b))
    )
    # quad's own tolerance; the absolute part for empty intervals.
    assert spectrum.moment(order, a, b) == pytest.approx(expected, rel=1e-8, abs=1e-14 * spectrum.moment(order))


def test_moment_is_logarithmic_where_the_power_vanishes():
    spectrum = SelfAffineSpectrum(1.0, 1.0, 1.0, 1.0, 8.0)
    assert spectrum.moment(3) == pytest.approx(spectrum.plateau * np.log(8), abs=0, rel=1e-13)
    near = SelfAffineSpectrum(1.0 - 1e-12, 1.0, 1.0, 1.0, 8.0)
    assert near.moment(3) == pytest.approx(spectrum.moment(3), abs=0, rel=1e-10)


def test_moments_take_arrays_of_limits():
    q = np.array([0.5, 1, 2, 3, 7, 12, 20]) * Q_L
    moments = PAPER.moment(2, upper=q)
    assert moments[0] == moments[1] == 0
    assert moments[-1] == moments[-2] == pytest.approx(PAPER.moment(2), abs=0, rel=1e-15)
    # Subtracting the upper part loses no more than rounding.
    assert PAPER.moment(2, lower=7 * Q_L) == pytest.approx(PAPER.moment(2) - moments[4], abs=0, rel=1e-13)


@pytest.mark.parametrize("power", [0, 2, 4, -3.5])
def test_weighted_variance_is_a_moment_for_a_power_of_the_wavevector(power):
    q = np.array([0.5, 1, 2, 3, 3.0001, 7, 12, 20]) * Q_L
    found = PAPER.weighted_variance(lambda q: q**power, q)
    # Gauss's rule of six points on 1/80 of a decade, summed.
    np.testing.assert_allclose(found, 2 * np.pi * PAPER.moment(1 + power, upper=q), rtol=1e-13)
    assert PAPER.weighted_variance(lambda q: q**power) == found[-1]


def test_weighted_variance_of_a_weight_that_is_no_power():
    """On its own function, not on the power law that carries it: a resonance at 5 q_L."""

    def weight(q):
        return 1 / (1 + (q / Q_L - 5) ** 2)

    expected = sum(
        quad(lambda x: 2 * np.pi * x * Q_L**2 * weight(x * Q_L) * PAPER.density(x * Q_L), a, b, epsrel=1e-12)[0]
        for a, b in ((1, 3), (3, 5.5))
    )
    assert PAPER.weighted_variance(weight, 5.5 * Q_L) == pytest.approx(expected, abs=0, rel=1e-11)


def test_weighted_variance_of_shells_weighs_each_at_its_own_wavevector():
    q, variances = np.array([1.0, 2.0, 5.0]), np.array([3.0, 0.5, 0.1])
    shells = RadialSpectrum(q, variances)
    found = shells.weighted_variance(lambda q: np.cos(q), shells.shell_edges)
    np.testing.assert_allclose(found, [0, *np.cumsum(variances * np.cos(q))], rtol=1e-14)
    assert shells.weighted_variance(lambda q: np.cos(q)) == found[-1]


@pytest.mark.parametrize("wavevectors", [(0.0, 1.0, 2.0), (1.0, 0.5, 2.0), (1.0, 3.0, 2.0), (1.0, 1.0, 1.0)])
def test_impossible_wavevectors_are_refused(wavevectors):
    with pytest.raises(ValueError, match="must be positive, not decrease"):
        SelfAffineSpectrum(0.8, 1.0, *wavevectors)


@pytest.mark.parametrize("exponent", [-0.1, 1.1, np.nan])
def test_impossible_hurst_exponents_are_refused(exponent):
    with pytest.raises(ValueError, match="hurst_exponent"):
        SelfAffineSpectrum(exponent, 1.0, 1.0, 2.0, 3.0)


@pytest.mark.parametrize("variance", [-0.5, np.nan, np.inf])
def test_power_that_is_negative_or_no_number_is_named_with_its_wavevector(variance):
    with pytest.raises(ValueError, match=r"variances: .* at 2 1/m"):
        RadialSpectrum(np.array([1.0, 2.0]), np.array([3.0, variance]))


@pytest.mark.parametrize("wavevectors", [(1.0, np.nan), (np.nan, 1.0), (2.0, 1.0), (0.0, 1.0)])
def test_impossible_shells_are_refused(wavevectors):
    with pytest.raises(ValueError, match="wavevectors"):
        RadialSpectrum(np.array(wavevectors), np.ones(2))


@pytest.mark.parametrize(("shape", "size"), [((24, 24), (2.0, 2.0)), ((21, 32), (1.5, 2.0)), ((16, 27), (2.0, 3.0))])
def test_realised_moments_are_sums_over_modes(shape, size):
    grid = Grid(shape, size)
    heights = np.random.default_rng(0).standard_normal(shape)
    spectrum = radial_spectrum(heights, grid)
    # Independent of the half-spectrum layout: the full complex transform.
    power = np.abs(np.fft.fft2(heights) / heights.size) ** 2
    q = np.hypot(
        2 * np.pi * np.fft.fftfreq(shape[0], size[0] / shape[0])[:, None],
        2 * np.pi * np.fft.fftfreq(shape[1], size[1] / shape[1])[None, :],
    )
    assert spectrum.rms_height == pytest.approx(heights.std(), abs=0, rel=1e-12)
    assert spectrum.rms_slope == pytest.approx(np.sqrt(np.sum(q**2 * power)), rel=1e-12)
    assert spectrum.rms_laplacian == pytest.approx(np.sqrt(np.sum(q**4 * power)), rel=1e-12)
    edge = spectrum.shell_edges[5]
    expected = np.sum((power * q)[(q > 0) & (q < edge)]) / (2 * np.pi)
    assert spectrum.moment(2, upper=edge) == pytest.approx(expected, abs=0, rel=1e-12)


def test_modes_a_surface_does_not_have_leave_no_shell():
    grid = Grid((48, 64), (3.0, 4.0))
    y, x = grid.coordinates
    heights = 7.0 + np.cos(2 * np.pi * x / 4)[None, :] * np.cos(2 * np.pi * y / 3)[:, None]
    spectrum = radial_spectrum(heights, grid)
    assert spectrum.wavevectors == pytest.approx([2 * np.pi * np.hypot(1 / 4, 1 / 3)], rel=1e-12)
    assert spectrum.variances == pytest.approx([0.25], abs=0, rel=1e-12)
    assert spectrum.limits[0] < spectrum.wavevectors[0] < spectrum.limits[1]
    with pytest.raises(ValueError, match="flat"):
        radial_spectrum(np.full(grid.shape, 0.7), grid)


@pytest.mark.parametrize("count", [3, 10, 1000])
def test_bands_divide_the_whole_spectrum(count):
    shells = RadialSpectrum(np.linspace(1.0, 5.0, 60) ** 1.5, np.linspace(2.0, 0.1, 60))
    for spectrum in (PAPER, shells):
        edges = spectrum.band_edges(count)
        assert (edges[0], edges[-1]) == spectrum.limits
        assert np.all(np.diff(edges) > 0)
        assert edges.size <= count + 1
    assert 3 * Q_L in PAPER.band_edges(10)
