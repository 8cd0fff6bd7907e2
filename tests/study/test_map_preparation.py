import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import gaussian_filter

from contact_study.inputs.errors import InputError
from contact_study.numerics.grid import Grid
from contact_study.physics.height_maps.preparation import detrended, filled, lowpassed, mirrored, windowed
from contact_study.physics.roughness.statistics import SelfAffineFit
from contact_study.study.case import realise
from contact_study.study.checks import describe_maps, described, law_in_words, review
from contact_study.study.study import make_study
from tests.study.test_study import TABLE, changed


def study(folder, **keys):
    own = {"kind": "file", "path": "map.npy", "size": ["24 nm", "30 nm"], **keys}
    return make_study({**TABLE, "interaction": {"law": "hard_wall"}, "surface": own}, folder)


def surface(folder, **keys):
    return realise(study(folder, **keys).cases[0])


def refused(folder, **keys):
    with pytest.raises(InputError) as failure:
        surface(folder, **keys)
    return str(failure.value)


@pytest.fixture
def tilted(tmp_path):
    y, x = np.mgrid[:24, :30]
    heights = 1e-9 * (np.sin(2 * np.pi * 3 * y / 24) + np.cos(2 * np.pi * 5 * x / 30))
    np.save(tmp_path / "map.npy", heights + 3e-9 * y - 2e-9 * x + 4e-10 * (y - 12.0) ** 2)
    return tmp_path


def test_keys_of_the_file_reach_its_reader(tilted):
    heights = np.load(tilted / "map.npy")
    np.savez(tilted / "map.npz", one=heights, two=2 * heights)
    found = surface(tilted, path="map.npz", channel="two", height_unit="nm")
    assert found.rms_height == pytest.approx(2e-9 * heights.std(), abs=0, rel=1e-9)
    assert "surface.lateral_unit" in refused(tilted, lateral_unit="nm")


def test_crop_takes_the_part_and_its_size(tilted):
    found, part = surface(tilted, crop=[["4 nm", "16 nm"], [0, "10 nm"]]), np.load(tilted / "map.npy")[4:16, :10]
    np.testing.assert_allclose(found.sampled, part - part.mean(), atol=1e-12 * np.ptp(part))
    np.testing.assert_allclose(found.size, (12e-9, 10e-9), rtol=1e-9)
    assert "y = 2.5e-08 m lies beyond" in refused(tilted, crop=[[0, "25 nm"], [0, "10 nm"]])
    assert "3 points" in refused(tilted, crop=[[0, "20 nm"], [0, "3 nm"]])
    wide = {"size": ["5.2 nm", "7.8 nm"], "edges": "mirror"}
    assert study(tilted, **wide).cases[0].lattice.atoms == (40, 60), "atoms stand on the cell that is left"


def test_edges(tilted):
    torn = surface(tilted).roughness
    assert torn.edge_ratio > 10
    mirror, window = surface(tilted, edges="mirror"), surface(tilted, edges="window", window_share=0.4)
    assert (mirror.shape, mirror.roughness.edge_ratio) == ((48, 60), 0)
    assert (*mirror.size, *window.size) == pytest.approx((48e-9, 60e-9, 24e-9, 30e-9), abs=0, rel=1e-9)
    assert window.roughness.edge_ratio < 2


def test_resample_and_lowpass(tilted):
    keys = {"detrend": "curvature", "edges": "mirror"}
    whole = surface(tilted, **keys)
    finer = surface(tilted, resample=[96, 120], **keys)
    np.testing.assert_allclose(finer.sampled[::2, ::2], whole.sampled, atol=1e-20)  # rounding of 1e-8
    smooth = surface(tilted, lowpass="9 nm", **keys)
    waves = smooth.measured_spectrum().wavevectors
    assert waves[-1] < 2 * np.pi / 9e-9 < 1.1 * waves[-1]
    assert study(tilted, lowpass="9 nm", **keys).scales[0].shortest_wave == pytest.approx(9e-9, abs=0, rel=1e-9)
    assert "surface.lowpass" in refused(tilted, lowpass="25 nm", **keys)


def test_missing_heights_outside_the_crop_do_not_matter(tilted):
    heights = np.load(tilted / "map.npy")
    whole, heights[20, 20] = surface(tilted).roughness, np.inf
    np.save(tilted / "map.npy", heights)
    assert "0.14 % of the heights" in refused(tilted)
    assert "row 20, column 20" in refused(tilted)
    surface(tilted, crop=[[0, "16 nm"], [0, "30 nm"]])
    assert (whole.filled, surface(tilted, fill="harmonic").roughness.filled) == (0.0, pytest.approx(1 / 720))


def test_a_plane_or_a_bowl_is_taken_away(tilted):
    left = [surface(tilted, detrend=how).rms_height for how in ("mean", "tilt", "curvature")]
    assert left[0] > 1.5 * left[1] > 3 * left[2]
    # The waves that are left correlate a little with a plane and a bowl.
    assert left[2] == pytest.approx(1e-9, abs=0, rel=0.2)


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


@pytest.fixture(scope="module")
def heights():
    keys = {"size": "2 um", "shape": [512, 512], "rms_height": "10 nm", "roll_off_mode": 4, "cutoff_mode": 100}
    table = changed("surface", **keys, seed=2) | {"interaction": {"law": "hard_wall"}}
    return realise(make_study(table).cases[0]).sampled


def study_of(folder, heights, size="2 um", **keys):
    np.save(folder / "map.npy", heights)
    return study(folder, size=size, **keys)


def notes(folder, heights, **keys):
    return review(study_of(folder, heights, **keys))


@pytest.mark.parametrize("edges", ["periodic", "window"])
def test_what_is_told_of_a_map_is_its_own_whatever_becomes_of_its_edges(tmp_path, heights, edges):
    (scales,) = study_of(tmp_path, heights[:256, :256], size="1 um", edges=edges).scales
    part = study_of(tmp_path, heights, edges=edges).scales[0].measured.sample.rms_slope
    assert scales.measured.sample.rms_slope == pytest.approx(part, abs=0, rel=0.1)  # a quarter of the surface
    assert scales.rms_curvature == scales.measured.sample.rms_curvature
    fit = scales.measured.sample.fit
    # A quarter of the surface; the roll-off is among two waves a side.
    assert fit.hurst_exponent == pytest.approx(0.8, abs=0.05)
    assert 2 * np.pi / fit.cutoff == pytest.approx(20e-9, abs=0, rel=0.03)
    assert 2 * np.pi / fit.roll_off == pytest.approx(500e-9, abs=0, rel=0.3)
    if edges == "periodic":
        assert notes(tmp_path, heights) == notes(tmp_path, heights[:256, :256], size="1 um", edges="mirror") == []
        assert scales.rms_slope > 1.3 * part
        (line,) = notes(tmp_path, heights[:256, :256], size="1 um")
        assert f"has an rms slope of {scales.rms_slope:.3g} in place of {scales.measured.sample.rms_slope:.3g};" in line
        assert "do not meet" in line
        assert 'surface.edges = "mirror"' in line


def test_points_or_waves_that_are_left_out_do_not_count(tmp_path, heights):
    whole, lowpass, fewer = (
        study_of(tmp_path, heights[:256, :256], size="1 um", **keys).scales[0].measured.sample.rms_slope
        for keys in ({}, {"lowpass": "40 nm"}, {"resample": [50, 50]})
    )
    assert lowpass < 0.9 * whole
    assert fewer == pytest.approx(lowpass, abs=0, rel=1e-9)


def test_laws_that_are_no_self_affine_surfaces():
    steep, flat = (law_in_words(SelfAffineFit(hurst, 0.1, 1e7, 1e9, 1e-30)) for hurst in (1.9, -0.7))
    assert steep.startswith("C falls as q^-5.8 ± 0.2, steeper, as of filtered surfaces")
    assert flat.startswith("C falls as q^-0.6 ± 0.2, flatter, as of noise")


def test_heights_of_the_wrong_order(tmp_path, heights):
    for scale, size, words in (
        (1e9, "2000 m", "a cell of 2000 x 2000 m"),
        (1e-9, "2 um", "an rms slope of "),
        (10, "0.2 m", "map.npy has a cell of 200 x 200 mm and an rms slope of 3.1e-05"),
        (5, "2 um", "rms slope"),
    ):
        (line,) = notes(tmp_path, scale * heights, size=size)
        assert words in line
        assert ("are its units right" in line) == (scale != 5)
    with pytest.raises(InputError, match=r"surface\.height_unit"):
        notes(tmp_path, 1e9 * heights)


def test_noise_of_single_points(tmp_path, heights):
    noisy = heights + 3e-10 * np.random.default_rng(1).standard_normal(heights.shape)
    (line,) = notes(tmp_path, noisy)
    assert "noise in single points" in line
    advice = line.partition("surface.lowpass = ")[2].partition('"')[2].partition('"')[0]
    assert notes(tmp_path, noisy, lowpass=advice) == []
    assert notes(tmp_path, noisy[:16, :16] - heights[:16, :16]) == [], "less than four octaves"


def test_what_was_taken_is_said_once_for_each_map(tmp_path, heights):
    torn = heights.copy()
    torn[:10, :100] = np.nan
    table = study_of(tmp_path, torn, fill="harmonic").table | {"sweep": {"material.poissons_ratio": [0.2, 0.3]}}
    lines = describe_maps(make_study(table, tmp_path).cases)
    assert len(lines) == 3
    assert "512 x 512 points, spacing 3.906 x 3.906 nm, size 2 x 2 µm (y, x), 0.381 % filled" in lines[0]
    said = float(lines[1].partition("h_rms ")[2].partition(" nm")[0])
    assert said == pytest.approx(1e9 * heights.std(), abs=0, rel=0.01)  # 0.4 % of the points are others
    assert "Hurst exponent 0.8" in lines[2]
    flat = study_of(tmp_path, np.zeros((8, 8)))
    assert "h_rms 0 pm" in described(flat.scales[0].measured)[1]
    assert review(flat) == []
