import numpy as np
import pytest

from contact_study.inputs.errors import InputError
from contact_study.study.case import realise
from contact_study.study.study import make_study
from tests.study.test_study import TABLE


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


def test_a_plane_is_fitted_to_what_was_measured(tilted):
    left = [surface(tilted, detrend=how).rms_height for how in ("mean", "tilt", "curvature")]
    assert left[0] > 1.5 * left[1] > 3 * left[2]
    # The waves that are left correlate a little with a plane and a bowl.
    assert left[2] == pytest.approx(1e-9, abs=0, rel=0.2)
    heights = np.load(tilted / "map.npy")
    plane = 3e-9 * np.arange(24)[:, None] - 2e-9 * np.arange(30)[None, :]
    heights[:8, :8] = np.nan
    left = []
    for more in (0, 5 * plane):
        np.save(tilted / "map.npy", heights + more)
        left.append(surface(tilted, detrend="tilt", fill="harmonic").sampled)
    np.testing.assert_allclose(left[0], left[1], atol=1e-18)  # rounding of 1e-6
