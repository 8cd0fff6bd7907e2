"""Height maps of many formats, made ready by the keys of the study; what does not fit ends in one line."""

import numpy as np
import pytest
import xarray as xr

from contact_study.inputs.errors import InputError
from contact_study.physics.height_maps.height_map import read_height_map
from contact_study.study.case import realise
from contact_study.study.study import make_study
from tests.study.test_study import TABLE

SIZE = (6e-6, 8e-6)  # y, x


@pytest.fixture
def heights():
    """In nm, with no symmetry that a wrong axis would leave unseen."""
    return np.round(np.random.default_rng(3).normal(0, 20, (6, 8)), 3) + np.arange(6)[:, None] - np.arange(8)


def surface(folder, name, **keys):
    table = {
        "surface": {"kind": "file", "path": name, **keys},
        "material": TABLE["material"],
        "interaction": {"law": "hard_wall"},
        "loading": TABLE["loading"],
    }
    return realise(make_study(table, folder).cases[0])


def refused(folder, name, **keys):
    with pytest.raises(InputError) as failure:
        surface(folder, name, **keys)
    assert "\n" not in str(failure.value)
    return str(failure.value)


def taken(found, expected, size=SIZE, rounded=1e-9):
    np.testing.assert_allclose(found.sampled, expected - expected.mean(), atol=1e-12 * np.ptp(expected))
    np.testing.assert_allclose(found.size, size, rtol=rounded)


def wsxm_xyz(path, heights):
    y, x = np.mgrid[:6, :8]
    lines = [f"{a} {b} {h}" for a, b, h in zip(x.ravel(), y.ravel(), heights.ravel(), strict=True)]
    path.write_text(
        "\n".join(["WSxM file copyright UAM", "WSxM ASCII XYZ file", "X[um]\tY[um]\tZ[nm]", "", *lines[::-1]])
    )


def rows(heights):
    return "\n".join(" ".join(map(str, row)) for row in heights[::-1]) + "\n"


def wsxm_matrix(path, heights):
    head = "WSxM file copyright UAM\nWSxM ASCII Matrix file\n"
    said = "X Amplitude: 8000 nm\nY Amplitude: 6 µm\nZ Amplitude: 90 nm\n\n"
    path.write_text(head + said + rows(heights), encoding="utf-8")


def gwyddion(path, heights):
    head = "# Channel: Height\n# Width: 8.00 µm\n# Height: 6.00 µm\n# Value units: nm\n"
    path.write_text(head + rows(heights), encoding="utf-8")


def netcdf(path, heights):
    units = {"units": "um"}
    coordinates = {"x": ("x", np.arange(8.0), units), "y": ("y", np.arange(6.0), units)}
    xr.Dataset({"height": (("x", "y"), heights.T, {"units": "nm"})}, coordinates).to_netcdf(path)


@pytest.mark.parametrize(
    ("name", "write"), [("map.nc", netcdf), ("map.xyz", wsxm_xyz), ("map.txt", wsxm_matrix), ("map.asc", gwyddion)]
)
def test_files_that_say_all(tmp_path, heights, name, write):
    write(tmp_path / name, heights)
    found = surface(tmp_path, name)
    taken(found, 1e-9 * heights)
    assert found.shape == (6, 8)
    assert read_height_map(tmp_path / name).unit == "nm, its file"
    # What the study repeats is no contradiction; what differs is one, with both in the line.
    surface(tmp_path, name, size=["6 um", "8.001 um"], height_unit="nm")
    assert "says 6e-06 x 8e-06" in refused(tmp_path, name, size=["6 um", "7 um"])
    assert "says nm" in refused(tmp_path, name, height_unit="um")


@pytest.mark.parametrize("name", ["map.npy", "map.npz", "map.dat"])
def test_bare_tables_are_told_their_size_and_unit(tmp_path, heights, name):
    if name == "map.npy":
        np.save(tmp_path / name, heights)
    elif name == "map.npz":
        np.savez(tmp_path / name, heights=heights)
    else:
        np.savetxt(tmp_path / name, heights, fmt="%.17g")
    taken(surface(tmp_path, name, size=["6 um", "8 um"], height_unit="nm"), 1e-9 * heights)
    assert read_height_map(tmp_path / name, "nm", SIZE).unit == "nm, surface.height_unit"
    assert read_height_map(tmp_path / name, None, SIZE).unit == "m, default"
    assert "missing key surface.size: how wide is the map?" in refused(tmp_path, name)
    assert "surface.height_unit" in refused(tmp_path, name, size="6 um", height_unit="N")
    assert "surface.lateral_unit" in refused(tmp_path, name, size="6 um", lateral_unit="um")


def test_coordinates_without_a_unit(tmp_path, heights):
    coordinates = {"x": ("x", np.arange(8.0)), "y": ("y", np.arange(6.0))}
    xr.Dataset({"height": (("y", "x"), heights, {"units": "nm"})}, coordinates).to_netcdf(tmp_path / "map.nc")
    taken(surface(tmp_path, "map.nc", lateral_unit="um"), 1e-9 * heights)
    assert "missing key surface.lateral_unit: " in refused(tmp_path, "map.nc"), "6 x 8 m are no map"
    # A cell of a size of use may be in metres.
    xr.open_dataset(tmp_path / "map.nc").assign_coords(x=1e-6 * np.arange(8), y=1e-6 * np.arange(6)).to_netcdf(
        tmp_path / "metres.nc"
    )
    taken(surface(tmp_path, "metres.nc"), 1e-9 * heights)
    # One coordinate speaks for both.
    coordinates["x"] = ("x", np.arange(8.0), {"units": "um"})
    xr.Dataset({"height": (("y", "x"), heights, {"units": "nm"})}, coordinates).to_netcdf(tmp_path / "one.nc")
    taken(surface(tmp_path, "one.nc"), 1e-9 * heights)


def test_netcdf_with_the_attributes_of_surfacetopography(tmp_path, heights):
    """``unit``, not ``units``; (x, y); missing heights in a variable of their own; Å as A."""
    torn = heights.copy()
    torn[2, 3] = 1e30
    mask = np.zeros((8, 6), "i1")
    mask[3, 2] = 1
    unit = {"unit": "A"}
    coordinates = {"x": ("x", np.arange(8.0), unit | {"length": 8.0}), "y": ("y", np.arange(6.0), unit)}
    fields = {"topography": (("x", "y"), torn.T, unit), "mask": (("x", "y"), mask)}
    xr.Dataset(fields, coordinates).to_netcdf(tmp_path / "other.nc")
    xr.Dataset(fields, coordinates).rename(topography="heights").to_netcdf(tmp_path / "map.nc")
    np.testing.assert_array_equal(*(read_height_map(tmp_path / name).heights for name in ("other.nc", "map.nc")))
    found = read_height_map(tmp_path / "map.nc")
    assert found.size == pytest.approx((6e-10, 8e-10), abs=0, rel=1e-9)
    assert found.unit == "angstrom, its file"
    assert np.isnan(found.heights[2, 3])
    there = ~np.isnan(found.heights)
    np.testing.assert_allclose(found.heights[there], 1e-10 * np.delete(heights, 2 * 8 + 3), rtol=1e-12)
    assert "says angstrom" in refused(tmp_path, "map.nc", height_unit="nm")


def test_the_micro_sign_of_old_files(tmp_path, heights):
    wsxm_matrix(tmp_path / "map.txt", heights)
    text = (tmp_path / "map.txt").read_text(encoding="utf-8")
    (tmp_path / "map.txt").write_bytes(text.encode("latin-1"))
    taken(surface(tmp_path, "map.txt"), 1e-9 * heights)


def test_esri_grid_and_its_missing_heights(tmp_path, heights):
    torn = heights.copy()
    torn[2, 3] = -9999
    head = "ncols 8\nnrows 6\nxllcorner 0.0\nyllcorner 0.0\ncellsize 1.0\nNODATA_value -9999\n"
    (tmp_path / "map.asc").write_text(head + rows(torn))
    keys = {"height_unit": "nm", "lateral_unit": "um"}
    assert "2.1 % of the heights in" in refused(tmp_path, "map.asc", **keys)
    found = surface(tmp_path, "map.asc", fill="harmonic", **keys)
    torn[2, 3] = np.mean([torn[1, 3], torn[3, 3], torn[2, 2], torn[2, 4]])
    # The mean is taken before filling, of the heights that are there, and once more after it.
    taken(found, 1e-9 * torn)
    assert found.roughness.filled == pytest.approx(1 / 48, abs=0, rel=1e-9)


def test_points_in_any_order_with_whole_lines_missing(tmp_path, heights):
    y, x = np.mgrid[:6, :8]
    points = np.column_stack([0.1 * x.ravel(), y.ravel() / 3, heights.ravel()])
    np.random.default_rng(1).shuffle(points)
    keys = {"height_unit": "nm", "lateral_unit": "nm", "fill": "harmonic"}
    np.savetxt(tmp_path / "map.xyz", points, fmt="%.4f")  # a third rounds to 0.01 % of a step
    taken(surface(tmp_path, "map.xyz", **keys), 1e-9 * heights, (2e-9, 0.8e-9), rounded=1e-4)
    left = points[np.abs(points[:, 0] - 0.3) > 1e-3]
    np.savetxt(tmp_path / "map.xyz", left, fmt="%.4f")
    found = surface(tmp_path, "map.xyz", **keys)
    assert found.shape == (6, 8)
    assert found.roughness.filled == pytest.approx(1 / 8, abs=0, rel=1e-9)
    np.savetxt(tmp_path / "map.xyz", np.vstack([points, points[:1]]))
    assert "two heights for one place" in refused(tmp_path, "map.xyz", **keys)
    np.savetxt(tmp_path / "map.xyz", points + [[0.02, 0.0, 0.0]] * (points[:, :1] > 0.45))
    assert "coordinate x of" in refused(tmp_path, "map.xyz", **keys)


def test_unknown_formats(tmp_path, capfd):
    pytest.importorskip("SurfaceTopography", reason="extra instruments")
    # Of 4 x 4 numbers of two bytes would be a tile of elevations, a format that marks itself by its name alone.
    for content in (b"\0\1\2\3 nothing that anyone knows" * 100, b"height of a surface\nis not here\n"):
        (tmp_path / "map.spm").write_bytes(content)
        said = refused(tmp_path, "map.spm", size="1 um")
        assert "in no format that is known" in said
        assert ".npy, .npz, .nc, .nc4, .netcdf, .xyz, .gz and those of SurfaceTopography" in said
    assert capfd.readouterr() == ("", ""), "the library's own remarks"


def test_instruments_need_their_extra(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "SurfaceTopography.IO", None)
    (tmp_path / "map.spm").write_bytes(b"\0\1\2\3 of some instrument" * 100)
    assert ".[instruments]" in refused(tmp_path, "map.spm", size="1 um")


def test_several_maps_leave_a_choice(tmp_path, heights):
    xr.Dataset({"trace": (("y", "x"), heights), "retrace": (("y", "x"), heights + 1.0 * heights**2)}).to_netcdf(
        tmp_path / "map.nc"
    )
    np.savez(tmp_path / "map.npz", trace=heights, retrace=heights + heights**2, scale=np.ones(3))
    for name in ("map.nc", "map.npz"):
        keys = {"size": ["6 um", "8 um"], "height_unit": "nm"}
        line = refused(tmp_path, name, **keys)
        assert "surface.channel" in line
        assert "0: trace, 1: retrace" in line
        for channel, expected in ((1, heights + heights**2), ("trace", heights)):
            taken(surface(tmp_path, name, channel=channel, **keys), 1e-9 * expected)
        for channel in (2, "phase"):
            assert f"surface.channel = {channel!r}" in refused(tmp_path, name, channel=channel, **keys)
    np.save(tmp_path / "one.npy", heights)
    assert "holds one map" in refused(tmp_path, "one.npy", channel="retrace", size="1 um")
