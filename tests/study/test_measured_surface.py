import numpy as np
import pytest

from contact_study.inputs.errors import InputError
from contact_study.physics.roughness.statistics import SelfAffineFit
from contact_study.study.case import realise
from contact_study.study.checks import describe_maps, described, law_in_words, review
from contact_study.study.study import make_study
from tests.study.test_map_preparation import study
from tests.study.test_study import changed


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
