import pathlib
import sys
import warnings
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
import xarray as xr
from scipy import constants

import contact_study
from contact_study import plots
from contact_study.campaign.dataset.export import to_vtk, to_xyz
from contact_study.plots.maps import ATOMS_NEED
from contact_study.report.align.states import read_atoms
from contact_study.report.facts.shown_states import panel_points
from contact_study.report.read.datasets import read_inputs
from contact_study.results.schema import COORDINATES, VARIABLES
from contact_study.start import contact_compare
from contact_study.study.study import make_study
from md_reference.study.dynamics import build_block
from md_reference.study.model import check
from tests.campaign.test_library import STUDY
from tests.md_reference.systems import moving
from tests.report.synthetic import write

ANGSTROM = 1e-10
DIGITS = 1e-8  # of every number, as ASE writes it
PATH = {"path": ["1 GPa", "0.5 GPa", "-3.5 GPa"]}  # the last one tears the block off


def still(**sections):
    atomistic = {"method": "quasi_static"}
    return moving(atomistic=atomistic, loading=PATH, dynamics={}, output={"atoms": "surface"}, **sections)


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    return contact_study.run(still(), "atomistic", output=tmp_path_factory.mktemp("atoms") / "md.nc")


@pytest.fixture(scope="module")
def moved():
    study = moving(output={"atoms": "block"}, dynamics={"duration": "0.3 ps", "frames": 4})
    with pytest.warns(UserWarning, match="converge"):
        return contact_study.run(study, "atomistic")


def test_atoms_are_those_of_the_dataset(dataset, tmp_path):
    ase_io = pytest.importorskip("ase.io", reason="extra xyz")
    (path,) = to_xyz(dataset, tmp_path / "atoms.xyz")
    frames = ase_io.read(path, index=":")
    assert [frame.info["step"] for frame in frames] == [0, 1, 2]
    assert set(frames[0].numbers) == {0}  # no element
    assert frames[0].pbc.tolist() == [True, True, False]
    np.testing.assert_allclose(frames[0].cell.lengths()[:2], 41.6, rtol=1e-12)
    block, sites = (frames[0][frames[0].arrays["level"] == level] for level in (0, -1))
    np.testing.assert_allclose(block.get_masses(), 197, rtol=1e-9)
    assert np.isinf(sites.get_masses()).all()
    assert (len(block), len(sites)) == (16 * 16, 26 * 26)
    state = dataset.isel(step=0)
    x, y = ((state[axis] + state[f"lateral_displacement_{axis}"]).transpose("y", "x") for axis in ("x", "y"))
    for column, values in (
        (block.positions, (1e10 * x, 1e10 * y, 1e10 * state.atom_height)),
        (block.arrays["shear_stress"], (1e-9 * state.shear_stress_x, 1e-9 * state.shear_stress_y)),
        (block.arrays["normal_stress"][:, None], (1e-9 * state.normal_stress,)),
    ):
        np.testing.assert_allclose(column, np.stack([own.values.ravel() for own in values], axis=-1), atol=2 * DIGITS)
    at = {f"site_{axis}": xr.DataArray(ANGSTROM * sites.positions[:, number]) for number, axis in enumerate("xy")}
    below = state.substrate_height.sel(at, method="nearest")
    np.testing.assert_allclose(sites.positions[:, 2], 1e10 * below, atol=2 * DIGITS)
    assert np.all(sites.arrays["normal_stress"] == 0)
    assert np.all(frames[2].arrays["normal_stress"] == 0)  # torn off


def test_explicit_block_has_its_levels_and_velocities(moved, tmp_path):
    ase_io = pytest.importorskip("ase.io", reason="extra xyz")
    block = build_block(make_study(moving()).cases[0])
    assert len(block.levels) > 1
    (path,) = to_xyz(moved, tmp_path / "block.*.xyz")
    assert path.name == "block.0000.xyz"
    frame = ase_io.read(path)
    nodes = frame[frame.arrays["level"] >= 0]
    assert not nodes.get_velocities().any()  # as docs/howto_export.md says
    level, velocity, surface = nodes.arrays["level"], nodes.arrays["velo"], moved.isel(step=0)
    counts = [own.shape[1] - (number + 1 < len(block.levels)) for number, own in enumerate(block.levels)]
    assert np.bincount(level).tolist() == [planes * (16 >> n) ** 2 for n, planes in enumerate(counts)]
    # Layers stand one above the other, each a cell of its level over the one below; the block is hardly deformed yet.
    for number, edge in enumerate(2.6 * 2.0 ** np.arange(len(counts))):
        own = nodes.positions[level == number].reshape(counts[number], 16 >> number, 16 >> number, 3)
        for axis, along in ((0, 2), (1, 1), (2, 0)):
            np.testing.assert_allclose(np.diff(own[..., along], axis=axis), edge, atol=0.2)
    np.testing.assert_allclose(nodes.positions[:256, 2] * ANGSTROM, surface.atom_height.values.ravel(), atol=DIGITS)
    np.testing.assert_allclose(velocity[:256, 0] * 100, surface.velocity_x.values.ravel(), atol=100 * DIGITS)
    kinetic = 0.5 * constants.atomic_mass * np.sum(nodes.get_masses()[:, None] * (100 * velocity) ** 2)
    assert kinetic / 41.6e-10**2 == pytest.approx(surface.kinetic_energy.item(), rel=1e-6)
    np.testing.assert_allclose(velocity[block.nodes_of(block.mass)[0] == 0, 2], velocity[-1, 2])
    assert velocity[-1, 2] < -1.0  # still coming down, Å/ps


def test_atoms_are_kept_only_on_demand_and_widen_a_run(tmp_path):
    kept, without = tmp_path / "md.nc", {**still(), "output": {}, "loading": {"path": ["1 GPa"]}}
    assert "atom_height" not in contact_study.run(without, "atomistic", output=kept)
    with_atoms = {**without, "output": {"atoms": "surface"}}
    with pytest.warns(UserWarning, match=r"output\.atoms = surface: the earlier run did not keep its atoms"):
        assert "substrate_height" in contact_study.run(with_atoms, "atomistic", output=kept, resume=True)
    with pytest.raises(ValueError, match=r'output\.atoms = "block".*use "surface"'):
        check(make_study({**without, "output": {"atoms": "block"}}).cases[0])
    contact_study.run(without, output=tmp_path / "bem.nc")
    with warnings.catch_warnings(action="error"):  # the continuum knows no atoms: nothing is computed anew
        contact_study.run(with_atoms, output=tmp_path / "bem.nc", resume=True)


def test_picture_shows_the_row_under_the_largest_tension(dataset):
    state = dataset.isel(step=0)
    row, column = np.unravel_index(state.normal_stress.values.argmin(), (16, 16))
    sites, atoms = plots.atoms(state).collections
    np.testing.assert_allclose(np.sort(atoms.get_array()), np.sort(state.normal_stress[row] / 1e9), rtol=1e-12)
    at = state.isel(y=row, x=column)
    told = [float(at.x + at.lateral_displacement_x), float(at.atom_height)]
    np.testing.assert_allclose(atoms.get_offsets()[np.argmin(atoms.get_array())] * 1e-9, told, rtol=1e-9)
    below = state.substrate_height.sel(site_y=float(at.y + state.lateral_displacement_y[row].mean()), method="nearest")
    np.testing.assert_allclose(np.sort(sites.get_offsets()[:, 1]) * 1e-9, np.sort(below), rtol=1e-9)
    given = plots.atoms(state, centre=(float(state.y[3]), 0.0))
    np.testing.assert_allclose(np.sort(given.collections[1].get_array()), np.sort(state.normal_stress[3] / 1e9))
    with pytest.raises(ValueError, match=r"atoms are kept with output\.atoms"):
        plots.atoms(state.drop_vars("normal_stress"))


@pytest.mark.validation
def test_comparison_reads_the_atoms_of_its_state(dataset, tmp_path):
    source = pathlib.Path(dataset.encoding["source"])
    inputs = read_inputs([source])
    held, torn = (panel_points(inputs.models, pressure) for pressure in (0.5e9, -3.5e9))
    found = read_atoms(inputs, held.case, held.common, None)
    for name in ATOMS_NEED:
        np.testing.assert_array_equal(found[name], dataset[name].isel(step=1, missing_dims="ignore"))
    assert read_atoms(inputs, torn.case, torn.common, None) is None  # torn off
    assert contact_compare([str(source), "-o", str(tmp_path / "out.nc"), "--figures", str(tmp_path)]) == 0
    assert list(tmp_path.glob("*_atoms.png"))


def image(path):
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
def fields():
    surface = {**STUDY["surface"], "shape": [16, 24], "size": [4e-9, 9e-9]}
    study = {name: keys for name, keys in STUDY.items() if name != "sweep"}
    loading = {"path": ["0.5 GPa", "2 GPa", "3 GPa"]}
    output = {"fields": True, "field_steps": [0, 2]}
    return contact_study.run(study | {"surface": surface, "loading": loading, "output": output})


def test_fields_are_those_of_the_dataset(fields, tmp_path):
    pytest.importorskip("pyevtk", reason="extra vtk")
    apart = fields.copy(deep=True)
    apart.gap[2] = np.inf
    files = to_vtk(apart, tmp_path / "contact.pvd")
    assert [path.name for path in files] == ["contact.pvd", "step_0000.vti", "step_0002.vti"]
    series = ElementTree.parse(files[0]).getroot().find("Collection").findall("DataSet")
    assert [(one.get("timestep"), tmp_path / one.get("file")) for one in series] == [("0", files[1]), ("2", files[2])]
    for step, path in zip((0, 2), files[1:], strict=True):
        spacing, arrays = image(path)
        np.testing.assert_allclose(spacing[:2], [9 / 24, 4 / 16], rtol=1e-9)  # nm, x first
        gap = 1e9 * fields.gap[step] if step == 0 else np.full((16, 24), np.nan)
        np.testing.assert_allclose(arrays["gap (nm)"], gap, rtol=1e-12)
        np.testing.assert_allclose(arrays["pressure (MPa)"], 1e-6 * fields.pressure[step], rtol=1e-12)
        np.testing.assert_allclose(arrays["height (nm)"], 1e9 * fields.height, rtol=1e-12)


@pytest.mark.parametrize(
    ("save", "field", "key", "suffix", "library"),
    [
        (to_vtk, "gap", r"output\.fields", "pvd", "pyevtk.hl"),
        (to_xyz, "atom_height", r"output\.atoms", "xyz", "ase.io"),
    ],
)
def test_what_cannot_be_written(dataset, fields, tmp_path, monkeypatch, save, field, key, suffix, library):
    one = fields if save is to_vtk else dataset
    for given, name, culprit in (
        (one.expand_dims({"seed": [1, 2]}), f"a.{suffix}", r"dataset\.isel\(seed=0\)"),
        (one.drop_vars(field), f"a.{suffix}", key),
        (one, "a.csv", rf"a\.csv: expected a name that ends in \.{suffix}"),
        (one, f"a.{suffix}/", rf"a\.{suffix}/: is the name of a folder"),
        (one, "", ": is the name of a folder"),
    ):
        with pytest.raises(ValueError, match=culprit):
            save(given, f"{tmp_path}/{name}")
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(ValueError, match=r"pip install '\.\["):
        save(one, tmp_path / f"a.{suffix}")
    assert not list(tmp_path.iterdir())


@pytest.mark.filterwarnings("ignore::pint.UnitStrippedWarning")  # of indices, which are kept as they are
def test_a_dataset_is_quantified_and_converted(tmp_path):
    pytest.importorskip("pint_xarray")
    units = pytest.importorskip("cf_xarray.units").units
    for unit in {entry.units for entry in {**VARIABLES, **COORDINATES}.values()}:
        assert units.parse_units(unit) is not None
    with xr.open_dataset(write(tmp_path / "bem.nc", "continuum")) as dataset:
        found = dataset.pint.quantify(unit_registry=units)
        in_millijoules = found.elastic_energy.pint.to("mJ/m^2").pint.dequantify()
        np.testing.assert_allclose(in_millijoules, 1e3 * dataset.elastic_energy, rtol=1e-12)
        assert (found.pressure_pdf * found.mean_pressure).pint.to("").pint.units == units.dimensionless
