"""Height maps as text: what parts the numbers, what the decimal sign is, what is no map."""

import gzip

import numpy as np
import pytest

from contact_study.inputs.errors import InputError
from contact_study.physics.height_maps.height_map import read_height_map

HEIGHTS = np.round(np.random.default_rng(5).normal(0, 20, (6, 8)), 3)
SIZE = (6e-6, 8e-6)


def table(separator, decimal=".", end=""):
    rows = (separator.join(f"{value:.3f}" for value in row) + end for row in HEIGHTS)
    return "\n".join(rows).replace(".", decimal) + "\n"


def refused(path, **keys):
    with pytest.raises(InputError) as failure:
        read_height_map(path, **keys)
    assert "\n" not in str(failure.value)
    return str(failure.value)


@pytest.mark.parametrize(
    ("separator", "decimal", "end"),
    [
        (",", ".", ""),
        (",", ".", ","),
        (";", ",", ";"),
        ("\t", ",", ""),
        (", ", ",", ","),
    ],
)
def test_what_parts_the_numbers_and_their_decimal_sign(tmp_path, separator, decimal, end):
    (tmp_path / "map.csv").write_text("# of a profiler\n" + table(separator, decimal, end))
    found = read_height_map(tmp_path / "map.csv", height_unit="nm", size=SIZE)
    np.testing.assert_allclose(found.heights, 1e-9 * HEIGHTS, rtol=1e-12)


@pytest.mark.parametrize("row", ["1,2,3,4,5", "1,-2,3,4", "10,25,132,400,50,166"])
def test_whole_numbers_between_commas(tmp_path, row):
    (tmp_path / "map.csv").write_text(f"{row}\n" * (4 if "-" in row else 12))
    numbers = [float(cell) for cell in row.split(",")]
    np.testing.assert_array_equal(read_height_map(tmp_path / "map.csv", size=SIZE).heights[0], numbers)


def test_an_empty_cell_is_a_missing_height(tmp_path):
    rows = table(";", ",").splitlines()
    rows[1] = rows[1].rpartition(";")[0] + ";"
    rows[3] = ";" + rows[3].partition(";")[2]
    (tmp_path / "map.csv").write_text("\n".join(rows))
    missing = np.argwhere(np.isnan(read_height_map(tmp_path / "map.csv", size=SIZE).heights))
    np.testing.assert_array_equal(missing, [[1, 7], [3, 0]])


UM = "# Lateral units: um\n# Value units: nm\n"


@pytest.mark.parametrize(
    ("head", "separator"),
    [("", ","), ("x,y,z\n", ";"), ("X[um] Y[um] Z[nm]\n", " "), ("X (um); Y (um); Z (nm)\n", " "), (UM, "\t")],
)
def test_three_columns_are_points(tmp_path, head, separator):
    y, x = np.mgrid[:6, :8]
    points = np.stack([x.ravel(), y.ravel(), HEIGHTS.ravel()], axis=1)[::-1]
    rows = "\n".join(separator.join(f"{value:.3f}" for value in row) for row in points)
    (tmp_path / "map.txt").write_text(head + rows)
    bare = "nm" not in head
    found = read_height_map(tmp_path / "map.txt", **({"height_unit": "nm", "lateral_unit": "um"} if bare else {}))
    np.testing.assert_allclose(found.heights, 1e-9 * HEIGHTS, rtol=1e-12)
    assert found.size == pytest.approx(SIZE, abs=0, rel=1e-9)
    if bare:
        assert "missing key surface.lateral_unit" in refused(tmp_path / "map.txt", height_unit="nm")
    else:
        assert found.unit == "nm, its file"


def test_a_header_in_another_language_with_decimal_commas(tmp_path):
    head = "# Kanal: Höhe\n# Breite: 8,00 µm\n# Höhe: 6,00 µm\n# Value units: nm\n"
    (tmp_path / "map.txt").write_text(head + table("\t", ","), encoding="utf-8")
    found = read_height_map(tmp_path / "map.txt")
    np.testing.assert_allclose(found.heights, 1e-9 * HEIGHTS[::-1], rtol=1e-12)  # the first row is the top
    assert found.size == pytest.approx(SIZE, abs=0, rel=1e-9)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "surface.path: {path} holds no numbers"),
        ("# Width: 1 um\n# Height: 1 um\n", "{path} holds no numbers"),
        (",0,1,2,3\n" + "0,1.5,2,3,4\n" * 4, "{path} begins with an empty cell; leave out names"),
        # Between numbers no line is left out: SurfaceTopography's reader would do so.
        ("1 2 3 4\nheights in nm\n" + "1 2 3 4\n" * 4, "the line 'heights in nm'"),
        ("1 2 3 4\n" * 5 + "1 2", "{path} cannot be read (the number of columns changed from 4 to 2 at row 6)"),
        ("1\n2\n3\n4\n5\n", "holds a line scan (5 points); a map (rows x columns) is needed"),
        ("0,1;2,5\n" * 9, "holds a line scan (9 points)"),
        ("# Width: 1 um\n# Height: 2 um\n" + "1 2 3\n" * 5, "an array of shape (5, 3); expected at least 4 x 4"),
        ("-12,125,10,250,3,1,4,5\n" * 12, "{path} looks like decimal commas between commas; use another separator"),
    ],
)
def test_what_is_no_map_is_named(tmp_path, text, words):
    (tmp_path / "map.txt").write_text(text)
    keys = {} if "shape" in words else {"size": SIZE}
    assert words.format(path=tmp_path / "map.txt") in refused(tmp_path / "map.txt", **keys)


@pytest.mark.parametrize("name", ["map.npy.gz", "map.csv.GZ"])
def test_compressed_files(tmp_path, name):
    if ".npy" in name:
        np.save(tmp_path / "map.npy", HEIGHTS)
        content = (tmp_path / "map.npy").read_bytes()
    else:
        content = table(",").encode()
    (tmp_path / name).write_bytes(gzip.compress(content))
    found = read_height_map(tmp_path / name, height_unit="nm", size=SIZE)
    np.testing.assert_allclose(found.heights, 1e-9 * HEIGHTS, rtol=1e-12)
    assert f"{tmp_path / name} holds one map" in refused(tmp_path / name, channel=3, size=SIZE)


def test_damaged_compressed_files(tmp_path):
    (tmp_path / "map.txt.gz").write_bytes(gzip.compress(table(" ").encode())[:-20])
    assert "map.txt.gz cannot be read" in refused(tmp_path / "map.txt.gz", size=SIZE)
