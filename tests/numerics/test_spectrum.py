import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from contact_study.numerics.grid import Grid
from contact_study.physics.height_maps.preparation import detrended, mirrored
from contact_study.physics.roughness.spectrum import radial_spectrum
from contact_study.physics.roughness.statistics import PowerSpectrum, roughness_of, roughness_of_sample, self_affine_fit
from contact_study.physics.solids import HalfSpace
from contact_study.study.case import realise
from tests.study.test_surface import case
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
    # Rounding of sums in another order, as processors differ.
    assert PAPER.weighted_variance(lambda q: q**power) == pytest.approx(found[-1], rel=1e-14)
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
    shells = RadialSpectrum(np.linspace(1.0, 5.0, 60) ** 1.5, np.linspace(2.0, 0.1, 60))
    for spectrum in (PAPER, TABLE, shells):
        edges = spectrum.band_edges(10)
        assert (edges[0], edges[-1]) == spectrum.limits
        assert np.all(np.diff(edges) > 0)
        assert edges.size <= 11
    assert 3 * Q_L in PAPER.band_edges(10)


UNIT = 2 * np.pi / 104e-9


def surface(**keys):
    return realise(case(**keys))


def test_moments_of_a_wave_and_where_the_spectrum_ends():
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
    wave = found.spectrum.density * found.spectrum.waves * (2 * np.pi) ** 2 / 6
    assert np.sum(wave) == pytest.approx(amplitude**2, abs=0, rel=1e-12)
    grid = Grid((32, 32), (1.0, 1.0))
    heights = np.random.default_rng(2).standard_normal(grid.shape)
    spectrum = roughness_of(heights, grid).spectrum
    assert spectrum.wavevectors[-1] <= 32 * np.pi
    assert spectrum.waves.sum() == np.sum(np.hypot(*np.meshgrid(*2 * [np.fft.fftfreq(32)])) <= 0.5) - 1


@pytest.mark.parametrize(("hurst", "roll_off", "cutoff"), [(0.2, 12, 90), (0.9, 1, 127)])
def test_the_law_of_a_self_affine_surface_is_found(hurst, roll_off, cutoff):
    keys = {"shape": [256, 256], "hurst_exponent": hurst, "roll_off_mode": roll_off, "cutoff_mode": cutoff}
    samples = [surface(**keys, seed=seed) for seed in range(3)]
    fits = [roughness_of(sample.sampled, sample.grid).fit for sample in samples]  # which is not told the limits
    # Thousands of waves give H to a hundredth; roll-offs are ends of bands of an eighth of an octave (9 %) among
    # few waves, cutoffs end among many.
    assert np.mean([fit.hurst_exponent for fit in fits]) == pytest.approx(hurst, abs=0.03)
    assert np.median([fit.roll_off for fit in fits]) / UNIT == pytest.approx(roll_off, abs=0, rel=0.15)
    assert np.mean([fit.cutoff for fit in fits]) / UNIT == pytest.approx(cutoff, abs=0, rel=0.03)


def test_a_part_has_the_slope_of_its_heights_tilt_included_and_the_spectrum_of_its_mirror_images():
    part, grid = surface(shape=[256, 256], cutoff_mode=50).sampled[:128, :128], Grid((128, 128), (52e-9, 52e-9))
    level, torn = roughness_of_sample(part, grid), roughness_of(part, grid)
    assert (level.edge_ratio, level.edge_jump) == (torn.edge_ratio, torn.edge_jump)
    assert level.rms_height == pytest.approx(part.std(), abs=0, rel=1e-9)
    tilted = roughness_of_sample(part + 0.5 * grid.coordinates[0][:, None], grid)
    # The mean gradient of the part adds to the tilt by itself; a hundredth is the corner between it and its image.
    assert tilted.rms_slope == pytest.approx(np.hypot(level.rms_slope, 0.5), abs=0, rel=0.1)
    steps = (np.diff(part + 0.5 * grid.coordinates[0][:, None], axis=axis) / grid.spacing[axis] for axis in range(2))
    assert tilted.rms_slope == pytest.approx(np.sqrt(sum(np.mean(step**2) for step in steps)), abs=0, rel=0.05)
    assert tilted.rms_curvature == pytest.approx(level.rms_curvature, abs=0, rel=1e-6)
    np.testing.assert_allclose(tilted.spectrum.density, level.spectrum.density, rtol=1e-6)
    mirror = roughness_of(mirrored(detrended(part, 1)), Grid((256, 256), (104e-9, 104e-9)))
    assert level.rms_curvature == pytest.approx(mirror.rms_curvature, abs=0, rel=1e-9)
    found, images = level.spectrum, mirror.spectrum
    assert 2 * np.pi / 52e-9 * (1 - 1e-9) <= found.wavevectors[0]
    for name, factor in (("wavevectors", 1), ("density", 1), ("waves", 4)):
        # The same sums in another order; images have longer waves, and one at the Nyquist wavevector.
        expected = getattr(images, name)[-found.waves.size - 1 : -1]
        np.testing.assert_allclose(factor * getattr(found, name), expected, rtol=1e-9)


def test_a_part_whose_edges_meet_is_taken_as_it_is_and_edges_that_jump_are_seen():
    whole = surface(shape=[64, 64], cutoff_mode=12)
    alone, repeated = (find(whole.sampled, whole.grid) for find in (roughness_of_sample, roughness_of))
    assert alone.rms_slope == repeated.rms_slope
    np.testing.assert_array_equal(alone.spectrum.density, repeated.spectrum.density)
    smooth = roughness_of_sample(whole.sampled, whole.grid, 104e-9 / 6)
    assert smooth.spectrum.density[smooth.spectrum.wavevectors > 6.1 * UNIT].max() < 1e-20 * smooth.spectrum.density[0]
    assert smooth.rms_slope < 0.9 * whole.roughness.rms_slope
    assert repeated.edge_ratio < 2  # rows across the edge differ as any two do, but for scatter
    for tilt in (np.linspace(0, 1e-8, 64), np.linspace(0, 1e-8, 64)[:, None]):
        # 1e-8 across one edge, on heights that differ by far less from row to row.
        tilted = roughness_of(whole.sampled + tilt, whole.grid)
        assert tilted.edge_jump == pytest.approx(1e-8, abs=0, rel=0.05)
        assert tilted.edge_ratio > 20


def test_a_narrow_law_is_found_between_its_own_limits():
    """The example ``first``: 1.6 octaves and a hundred waves, of which a search for the limits made H = 0.26."""
    fit = surface(shape=[100, 100], roll_off_mode=2, cutoff_mode=6, normalisation="realised", seed=4).roughness.fit
    assert abs(fit.hurst_exponent - 0.8) < 2 * fit.uncertainty
    # Of n = 50 pairs of waves over an octave and a half H is known to √(1/4n var(ln q)), 0.26.
    assert 0.15 < fit.uncertainty < 0.45
    assert (fit.roll_off, fit.cutoff) == pytest.approx((2 * UNIT, 6 * UNIT), abs=0, rel=1e-9)


def test_what_a_law_misses_adds_to_its_uncertainty():
    q = np.geomspace(1e6, 1e8, 54)
    sign, waves = np.where(np.arange(54) % 4 < 2, 1, -1), np.full(54, 400.0)
    spectra = [PowerSpectrum(q, q**-3.6 * (1 + part * sign), waves) for part in (0.0, 0.6)]
    there, missed = (self_affine_fit(spectrum, (q[0], q[-1])) for spectrum in spectra)
    assert there.hurst_exponent == pytest.approx(0.8, abs=0.001)
    assert missed.hurst_exponent == pytest.approx(0.8, abs=0.05)
    # n = 67 pairs a band, √(1/200 + 0.1²) of C: 1/√(4 · 54 n var(ln q)); and 0.6 in place of that √(1/200 + 0.1²).
    assert there.uncertainty == pytest.approx(0.5 / np.sqrt(54 * 66.7 * np.var(np.log(q))), abs=0, rel=0.15)
    assert self_affine_fit(PowerSpectrum(q[:10], spectra[0].density[:10], waves[:10])) is None, "too narrow"
    assert roughness_of(np.zeros((16, 16)), Grid((16, 16), (1.0, 1.0))).fit is None
    assert missed.uncertainty / there.uncertainty == pytest.approx(0.6 / np.sqrt(0.015), abs=0, rel=0.3)
