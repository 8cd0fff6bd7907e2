import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from contact_study.numerics.grid import Grid
from contact_study.physics.roughness.spectrum import radial_spectrum
from contact_study.physics.solids import HalfSpace
from theory import RadialSpectrum, SelfAffineSpectrum, TabulatedSpectrum

ANGSTROM = 1e-10
Q_L = 2 * np.pi / (1040 * ANGSTROM)
PAPER = SelfAffineSpectrum(0.8, 10 * ANGSTROM, Q_L, 3 * Q_L, 12 * Q_L)
CORNERS = np.array([1, 3, 12]) * Q_L
TABLE = TabulatedSpectrum(CORNERS, PAPER.density(CORNERS))


def test_reference_numbers_of_the_paper():
    # Half a unit of the last digit of each reference value.
    assert PAPER.plateau / ANGSTROM**4 == pytest.approx(48379.66, abs=0.005)
    assert PAPER.rms_slope == pytest.approx(0.26244, abs=5e-6)
    assert PAPER.rms_laplacian * ANGSTROM == pytest.approx(0.01106, abs=5e-6)
    stiffness = HalfSpace(77.2e9 / (1 - 0.42**2)).stiffness
    assert np.sqrt(PAPER.full_contact_stress_variance(stiffness)) == pytest.approx(12.300e9, abs=5e5)
    assert PAPER.full_contact_energy(stiffness) == pytest.approx(5.3532, abs=5e-5)
    assert PAPER.mean_square_height == pytest.approx(100 * ANGSTROM**2, abs=0, rel=1e-10)
    assert np.all(PAPER.density(np.array([0.99 * Q_L, 12.01 * Q_L])) == 0)


@given(
    st.floats(0, 1),
    st.tuples(st.floats(0, 3), st.floats(0.1, 4)),
    st.sampled_from([0, 1, 2, 3, 5, 2.5]),
    st.tuples(*[st.integers(0, 64)] * 2),
)
def test_moments_agree_with_quadrature(hurst, octaves, order, limits):
    low = 3.0
    roll_off = low * 2 ** octaves[0]
    spectrum = SelfAffineSpectrum(hurst, 0.1, low, roll_off, roll_off * 2 ** octaves[1])
    a, b = np.sort(low * (spectrum.cutoff / low) ** (np.array(limits) / 64))
    middle = np.clip(roll_off, a, b)
    expected = sum(
        quad(lambda q: q**order * spectrum.density(q), x, y, epsrel=1e-10)[0] for x, y in ((a, middle), (middle, b))
    )
    # quad's own tolerance; the absolute part for empty intervals.
    assert spectrum.moment(order, a, b) == pytest.approx(expected, rel=1e-8, abs=1e-14 * spectrum.moment(order))


@pytest.mark.parametrize("order", [-1.0, 1, 2.6, 3, 5])  # 2.6 makes the second integrand 1/q
def test_three_corners_have_every_moment_of_the_target(order):
    q = np.array([0.5, 1, 2, 3, 7, 12, 20]) * Q_L
    moments = PAPER.moment(order, upper=q)
    assert moments[0] == moments[1] == 0
    assert moments[-1] == moments[-2] == pytest.approx(PAPER.moment(order), abs=0, rel=1e-15)
    # Subtracting the upper part loses no more than rounding.
    assert PAPER.moment(order, lower=7 * Q_L) == pytest.approx(PAPER.moment(order) - moments[4], abs=0, rel=1e-13)
    np.testing.assert_allclose(TABLE.moment(order, upper=q), moments, rtol=1e-12)
    np.testing.assert_allclose(TABLE.moment(order, lower=2 * Q_L), PAPER.moment(order, lower=2 * Q_L), rtol=1e-12)
    assert np.shape(TABLE.moment(order)) == ()
    np.testing.assert_allclose(TABLE.density_at(q), PAPER.density(q), rtol=1e-12)


@pytest.mark.parametrize("power", [0, 2, 4, -3.5])
def test_weighted_variance_is_a_moment_for_a_power_of_the_wavevector(power):
    q = np.array([0.5, 1, 2, 3, 3.0001, 7, 12, 20]) * Q_L
    found = PAPER.weighted_variance(lambda q: q**power, q)
    # Gauss's rule of six points on 1/80 of a decade, summed.
    np.testing.assert_allclose(found, 2 * np.pi * PAPER.moment(1 + power, upper=q), rtol=1e-13)
    assert PAPER.weighted_variance(lambda q: q**power) == found[-1]
    np.testing.assert_allclose(TABLE.weighted_variance(lambda q: q**power, q), found, rtol=1e-9)


def test_impossible_spectra_are_refused():
    for kind, arguments, said in (
        *[(SelfAffineSpectrum, (0.8, 1.0, *q), "must be positive, not decrease") for q in ((0, 1, 2), (1, 3, 2))],
        (SelfAffineSpectrum, (0.8, 0.0, 1.0, 2.0, 3.0), "rms_height"),
        *[(SelfAffineSpectrum, (h, 1.0, 1.0, 2.0, 3.0), "hurst_exponent") for h in (-0.1, 1.1, np.nan)],
        *[(RadialSpectrum, ([1.0, 2.0], [3.0, v]), r"variances: .* at 2 1/m") for v in (-0.5, np.nan, np.inf)],
        *[(RadialSpectrum, (q, [1.0, 1.0]), "wavevectors") for q in ([1.0, np.nan], [2.0, 1.0], [0.0, 1.0])],
        (TabulatedSpectrum, ([1.0], [1.0]), "wavevectors"),
        (TabulatedSpectrum, ([2.0, 1.0], [1.0, 1.0]), "rise"),
        *[(TabulatedSpectrum, ([1.0, 2.0], [1.0, power]), "density") for power in (-1.0, np.nan)],
        (TabulatedSpectrum, ([1.0, 2.0], [1.0, 1.0, 1.0]), "one each"),
        (TabulatedSpectrum, ("spectrum.txt", [1.0, 1.0]), "wavevectors"),
    ):
        arguments = map(np.array, arguments) if kind is RadialSpectrum else arguments
        with pytest.raises(ValueError, match=said):
            kind(*arguments)


@pytest.mark.parametrize(("shape", "size"), [((21, 32), (1.5, 2.0)), ((16, 27), (2.0, 3.0))])
def test_realised_moments_are_sums_over_modes(shape, size):
    heights = np.random.default_rng(0).standard_normal(shape)
    spectrum = radial_spectrum(heights, Grid(shape, size))
    # Independent of the half-spectrum layout: the full complex transform.
    power = np.abs(np.fft.fft2(heights) / heights.size) ** 2
    q = 2 * np.pi * np.hypot(*np.meshgrid(*map(np.fft.fftfreq, shape, np.divide(size, shape)), indexing="ij"))
    assert spectrum.rms_height == pytest.approx(heights.std(), abs=0, rel=1e-12)
    assert spectrum.rms_slope == pytest.approx(np.sqrt(np.sum(q**2 * power)), rel=1e-12)
    assert spectrum.rms_laplacian == pytest.approx(np.sqrt(np.sum(q**4 * power)), rel=1e-12)
    weighted = np.cumsum(spectrum.variances * np.cos(spectrum.wavevectors))
    np.testing.assert_allclose(spectrum.weighted_variance(np.cos, spectrum.shell_edges[1:]), weighted, rtol=1e-14)
    assert spectrum.weighted_variance(np.cos) == weighted[-1]
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


def test_bands_divide_the_whole_spectrum():
    count = 10
    shells = RadialSpectrum(np.linspace(1.0, 5.0, 60) ** 1.5, np.linspace(2.0, 0.1, 60))
    for spectrum in (PAPER, TABLE, shells):
        edges = spectrum.band_edges(count)
        assert (edges[0], edges[-1]) == spectrum.limits
        assert np.all(np.diff(edges) > 0)
        assert edges.size <= count + 1
    assert 3 * Q_L in PAPER.band_edges(10)
