"""Fields for ParaView, read back from the files as VTK lays them out: x fastest, after a header of eight bytes."""

import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

import contact_study
from contact_study.campaign.dataset.export import to_vtk
from tests.campaign.test_library import STUDY


def image(path):
    """Spacing, and the arrays by name, shape (y, x)."""
    content = path.read_bytes()
    head, _, data = content.partition(b'<AppendedData encoding="raw">')
    data = data[data.index(b"_") + 1 :]
    grid = ElementTree.fromstring(head.decode() + "</VTKFile>").find("ImageData")
    extent = [int(number) for number in grid.get("WholeExtent").split()]
    shape = (extent[3] + 1, extent[1] + 1)
    arrays = {}
    for array in grid.iter("DataArray"):
        start = int(array.get("offset"))
        count = int.from_bytes(data[start : start + 8], "little")
        arrays[array.get("Name")] = np.frombuffer(data[start + 8 : start + 8 + count], "<f8").reshape(shape)
    return [float(number) for number in grid.get("Spacing").split()], arrays


@pytest.fixture(scope="module")
def dataset():
    surface = {**STUDY["surface"], "shape": [16, 24], "size": [4e-9, 9e-9]}
    study = {name: keys for name, keys in STUDY.items() if name != "sweep"}
    loading = {"path": ["0.5 GPa", "2 GPa", "3 GPa"]}
    output = {"fields": True, "field_steps": [0, 2]}
    return contact_study.run(study | {"surface": surface, "loading": loading, "output": output})


def test_fields_are_those_of_the_dataset(dataset, tmp_path):
    pytest.importorskip("pyevtk", reason="extra vtk")
    apart = dataset.copy(deep=True)
    apart.gap[2] = np.inf
    files = to_vtk(apart, tmp_path / "contact.pvd")
    assert [path.name for path in files] == ["contact.pvd", "step_0000.vti", "step_0002.vti"]
    series = ElementTree.parse(files[0]).getroot().find("Collection").findall("DataSet")
    assert [(one.get("timestep"), tmp_path / one.get("file")) for one in series] == [("0", files[1]), ("2", files[2])]
    for step, path in zip((0, 2), files[1:], strict=True):
        spacing, arrays = image(path)
        np.testing.assert_allclose(spacing[:2], [9 / 24, 4 / 16], rtol=1e-9)  # nm, x first
        gap = 1e9 * dataset.gap[step] if step == 0 else np.full((16, 24), np.nan)
        np.testing.assert_allclose(arrays["gap (nm)"], gap, rtol=1e-12)
        np.testing.assert_allclose(arrays["pressure (MPa)"], 1e-6 * dataset.pressure[step], rtol=1e-12)
        np.testing.assert_allclose(arrays["height (nm)"], 1e9 * dataset.height, rtol=1e-12)


def test_what_cannot_be_written(dataset, tmp_path, monkeypatch):
    several = dataset.expand_dims({"seed": [1, 2]})
    cases = [
        (several, "contact.pvd", r"dataset\.isel\(seed=0\)"),
        (dataset.drop_vars("gap"), "contact.pvd", r"output\.fields"),
        (dataset, "contact.vtk", r"\.pvd"),
        (dataset, "contact.pvd/", r"contact\.pvd/: is the name of a folder"),
    ]
    for given, name, culprit in cases:
        with pytest.raises(ValueError, match=culprit):
            to_vtk(given, f"{tmp_path}/{name}")
    monkeypatch.setitem(__import__("sys").modules, "pyevtk.hl", None)
    with pytest.raises(ValueError, match=re.escape(".[vtk]")):
        to_vtk(dataset, tmp_path / "contact.pvd")
    assert not list(tmp_path.iterdir())
