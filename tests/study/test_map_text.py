import gzip

import numpy as np
import pytest

from contact_study.physics.height_maps.height_map import read_height_map
from tests.study.test_map_files import HEIGHTS, POINTS, SIZE, refused, taken

NUMBER = f"{HEIGHTS[3, 2]:.3f}"


def table(separator, decimal=".", end=""):
    rows = (separator.join(f"{value:.3f}" for value in row) + end for row in HEIGHTS)
    return "\n".join(rows).replace(".", decimal) + "\n"


@pytest.mark.parametrize(
    ("separator", "decimal", "end"),
    [(",", ".", ""), (",", ".", ","), (";", ",", ";"), ("\t", ",", ""), (", ", ",", ",")],
)
def test_what_parts_the_numbers_and_their_decimal_sign(tmp_path, separator, decimal, end):
    (tmp_path / "map.csv").write_text("# of a profiler\n" + table(separator, decimal, end))
    taken(tmp_path / "map.csv", height_unit="nm", size=SIZE)
    if not separator.isspace():  # an empty cell is a missing height
        (tmp_path / "map.csv").write_text(table(separator, decimal, end).replace(NUMBER.replace(".", decimal), ""))
        missing = np.argwhere(np.isnan(read_height_map(tmp_path / "map.csv", size=SIZE).heights))
        np.testing.assert_array_equal(missing, [[3, 2]])


UM = "# Lateral units: um\n# Value units: nm\n"


@pytest.mark.parametrize(
    ("head", "separator"),
    [("", ","), ("x,y,z\n", ";"), ("X[um] Y[um] Z[nm]\n", " "), ("X (um); Y (um); Z (nm)\n", " "), (UM, "\t")],
)
def test_three_columns_are_points(tmp_path, head, separator):
    rows = "\n".join(separator.join(f"{value:.3f}" for value in row) for row in POINTS[::-1])
    (tmp_path / "map.txt").write_text(head + rows)
    if "nm" in head:
        assert taken(tmp_path / "map.txt") == "nm, its file"
    else:
        taken(tmp_path / "map.txt", height_unit="nm", lateral_unit="um")
        assert "missing key surface.lateral_unit" in refused(tmp_path / "map.txt", height_unit="nm")


def test_what_is_no_map_is_named(tmp_path):
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
