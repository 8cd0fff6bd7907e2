import gzip

import numpy as np
import pytest
import xarray as xr

from contact_study.inputs.errors import InputError
from contact_study.physics.height_maps.height_map import read_height_map

SIZE = (6e-6, 8e-6)  # y, x
AXES = {"y": np.arange(6.0), "x": np.arange(8.0)}
# In nm, with no symmetry that a wrong axis would leave unseen.
HEIGHTS = np.round(np.random.default_rng(3).normal(0, 20, (6, 8)), 3) + AXES["y"][:, None] - AXES["x"]
POINTS = np.column_stack([*(part.ravel() for part in np.meshgrid(AXES["x"], AXES["y"])), HEIGHTS.ravel()])


def refused(path, **keys):
    with pytest.raises(InputError) as failure:
        read_height_map(path, **keys)
    assert "\n" not in str(failure.value)
    return str(failure.value)


def taken(path, sides=SIZE, expected=1e-9 * HEIGHTS, rounded=1e-9, **keys):
    found = read_height_map(path, **keys)
    np.testing.assert_allclose(found.heights, expected, rtol=1e-12)
    np.testing.assert_allclose(found.size, sides, rtol=rounded)
    return found.unit


def text(table):
    return "\n".join(" ".join(map(str, row)) for row in table[::-1]) + "\n"


def netcdf(path, heights=HEIGHTS, dims=("y", "x"), lateral="um", names=None, **axes):
    kinds = {name: ({"units": lateral} if lateral else {}) | ({"axis": names[name]} if names else {}) for name in axes}
    coordinates = {name: (name, values, kinds[name]) for name, values in axes.items()}
    xr.Dataset({"height": (dims, heights, {"units": "nm"})}, coordinates).to_netcdf(path)
    return path


MATRIX = "WSxM ASCII Matrix file\nX Amplitude: 8000 nm\nY Amplitude: 6 µm\nZ Amplitude: 90 nm\n\n" + text(HEIGHTS)
TEXTS = {
    "map.xyz": "WSxM file copyright UAM\nWSxM ASCII XYZ file\nX[um]\tY[um]\tZ[nm]\n\n" + text(POINTS),
    "map.txt": "WSxM file copyright UAM\n" + MATRIX,
    "map.asc": "# Channel: Height\n# Width: 8.00 µm\n# Height: 6.00 µm\n# Value units: nm\n" + text(HEIGHTS),
}


@pytest.mark.parametrize("name", ["map.nc", *TEXTS])
@pytest.mark.parametrize("encoding", ["utf-8", "latin-1"])  # the micro sign of old files
def test_files_that_say_all(tmp_path, name, encoding):
    path = tmp_path / name
    if name in TEXTS:
        path.write_text(TEXTS[name], encoding=encoding)
    else:
        netcdf(path, HEIGHTS.T, ("x", "y"), **AXES)
    assert taken(path) == "nm, its file"
    # What the study repeats is no contradiction; what differs is one, with both in the line.
    taken(path, (6e-6, 8.001e-6), size=(6e-6, 8.001e-6), height_unit="nm")
    assert "says 6e-06 x 8e-06" in refused(path, size=(6e-6, 7e-6))
    assert "says nm" in refused(path, height_unit="um")


@pytest.mark.parametrize("name", ["map.npy", "map.npz", "map.dat"])
def test_bare_tables_are_told_their_size_and_unit(tmp_path, name):
    path = tmp_path / name
    {"map.npy": np.save, "map.npz": np.savez, "map.dat": np.savetxt}[name](path, HEIGHTS)
    assert taken(path, size=SIZE, height_unit="nm") == "nm, surface.height_unit"
    assert taken(path, expected=HEIGHTS, size=SIZE) == "m, default"
    assert "missing key surface.size: how wide is the map?" in refused(path)
    assert "surface.height_unit" in refused(path, size=SIZE, height_unit="N")
    assert "surface.lateral_unit" in refused(path, size=SIZE, lateral_unit="um")
    if name != "map.npz":
        assert "holds one map" in refused(path, channel="retrace", size=SIZE)


def test_dimensions_and_directions_of_coordinates(tmp_path):
    for turn, dims, given in (
        (lambda h: h[::-1, ::-1], ("y", "x"), {"y": AXES["y"][::-1], "x": AXES["x"][::-1]}),
        (lambda h: h[:, ::-1].T, ("x", "y"), {"y": AXES["y"], "x": AXES["x"][::-1]}),
        (lambda h: h.T, ("u", "v"), {"u": AXES["x"], "v": AXES["y"], "names": {"u": "X", "v": "Y"}}),
        # Three decimals, and single precision.
        (lambda h: h, ("y", "x"), {"y": AXES["y"], "x": np.round(AXES["x"] / 3, 3).astype(np.float32)}),
        (lambda h: h.T, ("x", "y"), {}),
    ):
        path = netcdf(tmp_path / "map.nc", turn(HEIGHTS), dims, **given)
        thirds = given and given.get("x", POINTS).dtype == np.float32
        size = (6e-6, 8e-6 / 3) if thirds else SIZE
        taken(path, size, rounded=1e-3 if thirds else 1e-12, **({} if given else {"size": SIZE}))


def test_uneven_coordinates_and_those_without_a_unit(tmp_path):
    for x in ([*range(7), 7.5], [*range(7), np.nan], [0] * 8):
        path = netcdf(tmp_path / "map.nc", y=AXES["y"], x=np.array(x, float))
        assert f"coordinate x of {path} is not evenly spaced" in refused(path)
    path = netcdf(tmp_path / "map.nc", lateral=None, **AXES)
    taken(path, lateral_unit="um")
    assert "missing key surface.lateral_unit: " in refused(path), "6 x 8 m are no map"
    # A cell of a size of use may be in metres.
    taken(netcdf(tmp_path / "metres.nc", lateral=None, **{name: 1e-6 * values for name, values in AXES.items()}))
    # One coordinate speaks for both.
    whole = xr.open_dataset(path)
    whole.assign_coords(x=("x", AXES["x"], {"units": "um"})).to_netcdf(tmp_path / "one.nc")
    taken(tmp_path / "one.nc")


def test_netcdf_with_the_attributes_of_surfacetopography(tmp_path):
    unit, mask = {"unit": "A"}, np.zeros((8, 6), "i1")
    mask[3, 2] = 1
    coordinates = {name: (name, values, unit) for name, values in AXES.items()}
    fields = {"topography": (("x", "y"), np.where(mask, 1e30, HEIGHTS.T), unit), "mask": (("x", "y"), mask)}
    xr.Dataset(fields, coordinates).to_netcdf(tmp_path / "other.nc")
    xr.Dataset(fields, coordinates).rename(topography="heights").to_netcdf(tmp_path / "map.nc")
    for name in ("other.nc", "map.nc"):
        expected = np.where(mask.T, np.nan, 1e-10 * HEIGHTS)
        assert taken(tmp_path / name, (6e-10, 8e-10), expected) == "angstrom, its file"


def test_esri_grid_and_its_missing_heights(tmp_path):
    torn = HEIGHTS.copy()
    torn[2, 3] = -9999
    head = "ncols 8\nnrows 6\nxllcorner 0.0\nyllcorner 0.0\ncellsize 1.0\nNODATA_value -9999\n"
    (tmp_path / "map.asc").write_text(head + text(torn))
    keys = {"height_unit": "nm", "lateral_unit": "um"}
    taken(tmp_path / "map.asc", expected=1e-9 * np.where(torn == -9999, np.nan, torn), **keys)
    (tmp_path / "map.asc").write_text(head.replace("8", "7", 1) + text(torn))
    assert "holds 6 x 8 heights, its header says 6 x 7" in refused(tmp_path / "map.asc", **keys)


def test_points_in_any_order_with_whole_lines_missing(tmp_path):
    points, path = POINTS * [0.1, 1 / 3, 1], tmp_path / "map.xyz"
    np.random.default_rng(1).shuffle(points)
    keys = {"height_unit": "nm", "lateral_unit": "nm"}
    np.savetxt(path, points, fmt="%.4f")  # a third rounds to 0.01 % of a step
    taken(path, (2e-9, 0.8e-9), rounded=1e-4, **keys)
    np.savetxt(path, points[np.abs(points[:, 0] - 0.3) > 1e-3], fmt="%.4f")
    taken(path, (2e-9, 0.8e-9), np.where(AXES["x"] == 3, np.nan, 1e-9 * HEIGHTS), 1e-4, **keys)
    np.savetxt(path, np.vstack([points, points[:1]]))
    assert "two heights for one place" in refused(path, **keys)
    np.savetxt(path, points + [[0.02, 0.0, 0.0]] * (points[:, :1] > 0.45))
    assert "coordinate x of" in refused(path, **keys)


def test_unknown_formats(tmp_path, capfd, monkeypatch):
    path = tmp_path / "map.spm"
    with monkeypatch.context() as without:
        without.setitem(__import__("sys").modules, "SurfaceTopography.IO", None)
        path.write_bytes(b"\0\1\2\3 of some instrument" * 100)
        assert ".[instruments]" in refused(path, size=SIZE)
    pytest.importorskip("SurfaceTopography", reason="extra instruments")
    # Of 4 x 4 numbers of two bytes would be a tile of elevations, a format that marks itself by its name alone.
    for content in (b"\0\1\2\3 nothing that anyone knows" * 100, b"height of a surface\nis not here\n"):
        path.write_bytes(content)
        said = refused(path, size=SIZE)
        assert "in no format that is known" in said
        assert ".npy, .npz, .nc, .nc4, .netcdf, .xyz, .gz and those of SurfaceTopography" in said
    assert capfd.readouterr() == ("", ""), "the library's own remarks"


@pytest.mark.parametrize("name", ["map.nc", "map.npz"])
def test_several_maps_leave_a_choice(tmp_path, name):
    fields, path = {"trace": HEIGHTS, "retrace": HEIGHTS + HEIGHTS**2}, tmp_path / name
    if name == "map.nc":
        xr.Dataset({name: (("y", "x"), field) for name, field in fields.items()}).to_netcdf(path)
    else:
        np.savez(path, **fields, scale=np.ones(3))
    keys = {"size": SIZE, "height_unit": "nm"}
    line = refused(path, **keys)
    assert "surface.channel" in line
    assert "0: trace, 1: retrace" in line
    for channel, expected in ((1, fields["retrace"]), ("trace", HEIGHTS)):
        taken(path, expected=1e-9 * expected, channel=channel, **keys)
    for channel in (2, "phase"):
        assert f"surface.channel = {channel!r}" in refused(path, channel=channel, **keys)


def test_unusable_height_maps_and_what_is_no_map(tmp_path):
    for content, culprit in (
        (None, "does not exist"),
        (400, "cannot be read"),  # of a truncated NetCDF file
        (np.full((8, 8), np.nan), "no finite numbers: all of its heights are missing"),
        (np.zeros(8), "line scan (8 points)"),
        (np.ones((8, 8)) * 1j, "holds complex numbers; expected heights"),
    ):
        path = tmp_path / ("map.nc" if isinstance(content, int) else "map.npy")
        if isinstance(content, int):
            path.write_bytes(netcdf(path).read_bytes()[:content])
        elif content is not None:
            np.save(path, content)
        assert culprit in (line := refused(path))
        assert str(path) in line
    for text, words in (
        ("", "surface.path: {path} holds no numbers"),
        ("# Width: 1 um\n# Height: 1 um\n", "{path} holds no numbers"),
        (",0,1,2,3\n" + "0,1.5,2,3,4\n" * 4, "{path} begins with an empty cell; leave out names"),
        ("1,2,3,4,5\n" * 3, "an array of shape (3, 5)"),  # whole numbers between commas
        # Between numbers no line is left out: SurfaceTopography's reader would do so.
        ("1 2 3 4\nheights in nm\n" + "1 2 3 4\n" * 4, "the line 'heights in nm'"),
        ("1 2 3 4\n" * 5 + "1 2", "{path} cannot be read (the number of columns changed from 4 to 2 at row 6)"),
        ("1\n2\n3\n4\n5\n", "holds a line scan (5 points); a map (rows x columns) is needed"),
        ("0,1;2,5\n" * 9, "holds a line scan (9 points)"),
        ("# Width: 1 um\n# Height: 2 um\n" + "1 2 3\n" * 5, "an array of shape (5, 3); expected at least 4 x 4"),
        ("-12,125,10,250,3,1,4,5\n" * 12, "{path} looks like decimal commas between commas; use another separator"),
    ):
        (tmp_path / "map.txt").write_text(text)
        keys = {} if "shape" in words else {"size": SIZE}
        assert words.format(path=tmp_path / "map.txt") in refused(tmp_path / "map.txt", **keys)


NUMBER = f"{HEIGHTS[3, 2]:.3f}"


def table(separator, decimal=".", end=""):
    rows = (separator.join(f"{value:.3f}" for value in row) + end for row in HEIGHTS)
    return "\n".join(rows).replace(".", decimal) + "\n"


def test_what_parts_the_numbers_and_their_decimal_sign(tmp_path):
    for separator, decimal, end in (
        *((",", ".", ""), (",", ".", ","), (";", ",", ";")),
        *(("\t", ",", ""), (", ", ",", ",")),
    ):
        (tmp_path / "map.csv").write_text("# of a profiler\n" + table(separator, decimal, end))
        taken(tmp_path / "map.csv", height_unit="nm", size=SIZE)
        if not separator.isspace():  # an empty cell is a missing height
            (tmp_path / "map.csv").write_text(table(separator, decimal, end).replace(NUMBER.replace(".", decimal), ""))
            missing = np.argwhere(np.isnan(read_height_map(tmp_path / "map.csv", size=SIZE).heights))
            np.testing.assert_array_equal(missing, [[3, 2]])


UM = "# Lateral units: um\n# Value units: nm\n"


def test_three_columns_are_points(tmp_path):
    spaced, brackets = ("X[um] Y[um] Z[nm]\n", " "), ("X (um); Y (um); Z (nm)\n", " ")
    for head, separator in (("", ","), ("x,y,z\n", ";"), spaced, brackets, (UM, "\t")):
        rows = "\n".join(separator.join(f"{value:.3f}" for value in row) for row in POINTS[::-1])
        (tmp_path / "map.txt").write_text(head + rows)
        if "nm" in head:
            assert taken(tmp_path / "map.txt") == "nm, its file"
        else:
            taken(tmp_path / "map.txt", height_unit="nm", lateral_unit="um")
            assert "missing key surface.lateral_unit" in refused(tmp_path / "map.txt", height_unit="nm")


@pytest.mark.parametrize("name", ["map.npy.gz", "map.csv.GZ"])
def test_compressed_files(tmp_path, name):
    np.save(tmp_path / "map.npy", HEIGHTS)
    content = (tmp_path / "map.npy").read_bytes() if ".npy" in name else table(",").encode()
    (tmp_path / name).write_bytes(gzip.compress(content))
    taken(tmp_path / name, height_unit="nm", size=SIZE)
    assert f"{tmp_path / name} holds one map" in refused(tmp_path / name, channel=3, size=SIZE)
    (tmp_path / name).write_bytes(gzip.compress(content)[:-20])
    assert f"{name} cannot be read" in refused(tmp_path / name, size=SIZE)


SIDE, HEADER = 8, 8192
CHANNELS = {"ZSensor": "Sens. Z", "AmplitudeError": "Sens. A", "Phase": "Sens. P", "Height": "Sens. Z"}


def nanoscope(path, *names):
    pytest.importorskip("SurfaceTopography", reason="extra instruments")
    lines = ["\\*File list", "\\Version: 0x05300000", "\\Data length: 8192"]
    lines += ["\\*Scanner list", "\\@Sens. Z: V 100 nm/V", "\\@Sens. A: V 2 nm/V", "\\@Sens. P: V 3 deg/V"]
    for number, name in enumerate(names):
        lines += ["\\*Ciao image list", f"\\Data offset: {HEADER + number * 2 * SIDE**2}", "\\Bytes/pixel: 2"]
        lines += [f"\\Data length: {2 * SIDE**2}", f"\\Samps/line: {SIDE}", f"\\Number of lines: {SIDE}"]
        lines += [
            "\\Scan Size: 2000 2000 nm",
            f'\\@2:Image Data: S [{name}] "{name}"',
            f"\\@2:Z scale: V [{CHANNELS[name]}] (0.0001525879 V/LSB) 10.0 V",
        ]
    text = "\r\n".join([*lines, "\\*File list end"]).encode("latin-1")
    fields = np.random.default_rng(1).integers(-9000, 9000, (len(names), SIDE, SIDE)).astype("<i2")
    path.write_bytes(text + b"\r\n\x1a" + b"\0" * (HEADER - len(text) - 3) + fields.tobytes())
    return 10 / 2**16 * 100e-9 * fields[:, ::-1]  # rows begin at the top


def test_of_an_instruments_channels_the_only_height_is_taken_and_several_leave_a_choice(tmp_path):
    path = tmp_path / "map.001"
    fields = nanoscope(path, "Phase", "ZSensor", "AmplitudeError")
    found = read_height_map(path)
    np.testing.assert_allclose(found.heights, fields[1], rtol=1e-6)
    assert found.size == pytest.approx((2e-6, 2e-6), abs=0, rel=1e-9)
    nanoscope(path, "Phase")
    assert "holds no map of heights; it has 0: Phase (not a height)" in refused(path)
    fields = nanoscope(path, "ZSensor", "AmplitudeError", "Phase", "Height")
    listed = "0: ZSensor (height), 1: AmplitudeError (not a height), 2: Phase (not a height), 3: Height (height)"
    assert f"holds 2 maps of heights ({listed})" in refused(path)
    for channel in (3, "Height"):
        np.testing.assert_allclose(read_height_map(path, channel=channel).heights, fields[3], rtol=1e-6)
    none = f"there is no such channel; {path} has {listed}"
    for channel, words in (("Phase", "is no map of heights; "), (1, "is no map of heights; "), ("X", none), (4, none)):
        assert f"{channel!r}: {words}" in refused(path, channel=channel)
    rows = "".join(f"{x:.4f},{np.sin(x):.4f}\n" for x in 0.1 * np.arange(20))
    (tmp_path / "line.csv").write_text("X_(microns),y1\n" + rows)
    assert "line.csv holds a line scan (20 points)" in refused(tmp_path / "line.csv")
