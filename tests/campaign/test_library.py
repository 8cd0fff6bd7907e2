import copy
import importlib.metadata
import tomllib

import numpy as np
import pint
import pytest
import tomli_w
import xarray as xr

import contact_study
from bem_adhesion import HalfSpace, Layer, Layered, LennardJones104, Measured, Tabulated, Viscoelastic
from contact_study import make_study, run, start
from contact_study.campaign.library import _plain
from contact_study.numerics.grid import Grid
from contact_study.study.study import with_keys
from tests.laws_of_all_kinds import EVERY_LAW

STUDY = tomllib.loads("""
[surface]
kind = "self_affine"
size = "41.6 angstrom"
shape = [16, 16]
rms_height = "1 angstrom"
cutoff_mode = 4
[material]
youngs_modulus = "77.2 GPa"
poissons_ratio = 0.42
lattice_constant = "2.6 angstrom"
[interaction]
work_of_adhesion = "0.1 J/m^2"
length = "3.28 angstrom"
[loading]
path = ["0.5 GPa", "2 GPa"]
[sweep]
"surface.seed" = [1, 2]
""")


def changed(**sections):
    table = copy.deepcopy(STUDY)
    for section, keys in sections.items():
        table.setdefault(section, {}).update(keys)
    return table


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def assert_same(*datasets):
    xr.testing.assert_identical(*(dataset.drop_vars("wall_time").drop_attrs() for dataset in datasets))


@pytest.mark.validation
def test_a_table_gives_the_dataset_of_the_command_and_leaves_nothing(tmp_path):
    table = copy.deepcopy(STUDY)
    dataset = run(table)
    assert table == STUDY
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "study.toml").write_text(tomli_w.dumps(STUDY))
    assert start.bem_adhesion(["study.toml", "-o", "bem.nc", "--workers", "1"]) == 0
    written = xr.load_dataset("bem.nc")
    assert_same(dataset, written)
    assert dataset.attrs["study_toml"] == written.attrs["study_toml"]
    assert "contact_study.run(..., 'continuum')" in dataset.attrs["history"]
    assert_same(run("study.toml"), dataset)


@pytest.mark.validation
def test_an_output_is_written_kept_and_gone_on_from(tmp_path, capfd, monkeypatch):
    assert_same(run(STUDY, output="out.nc"), xr.load_dataset("out.nc"))
    words = r"out\.nc exists; use overwrite=True to replace it or resume=True to continue its run$"
    with pytest.raises(ValueError, match=words):
        run(STUDY, output="out.nc")
    wider = changed(sweep={"surface.seed": [1, 2, 3]})
    assert run(wider, output="out.nc", resume=True).sizes["seed"] == 3
    assert run(STUDY, output="out.nc", overwrite=True).sizes["seed"] == 2
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out.nc", "out.nc.restart"]
    monkeypatch.setattr("contact_study.campaign.record.git_commit", lambda: "another")
    run(STUDY, output="out.nc", resume=True, progress=True)
    assert "overwrite=True computes it again" in capfd.readouterr().err


def test_mistakes_are_value_errors_that_name_the_culprit(tmp_path):
    (tmp_path / "study.toml").write_text(tomli_w.dumps(STUDY))
    for table, arguments, culprit in (
        (changed(interaction={"work_of_adhesion": -1.0}), {}, "interaction.work_of_adhesion"),
        ([1, 2], {}, r"study = \[1, 2\]"),
        ("missing.toml", {}, "missing.toml"),
        (STUDY, {"model": "bem"}, "model = 'bem': expected one of continuum, atomistic, theory"),
        (STUDY, {"workers": 0}, "workers = 0"),
        (STUDY, {"engine": "cloud"}, "engine 'cloud'"),
        (STUDY, {"predictor": "bem.nc"}, "predictor: the model 'continuum' takes none"),
        (STUDY, {"model": "atomistic", "predictor": "none.nc"}, r"^predictor: none\.nc does not exist"),
        (STUDY, {"engine": "dask"}, "^engine dask: needs scheduler ADDRESS"),
        (STUDY, {"resume": True}, "resume: needs an output"),
        ("study.toml", {"output": "study.toml", "overwrite": True}, "is read by this run"),
        (STUDY, {"output": "a.nc", "resume": True, "overwrite": True}, "resume and overwrite"),
    ):
        with pytest.raises(ValueError, match=culprit):
            run(table, **arguments)
    assert [path.name for path in tmp_path.iterdir()] == ["study.toml"]


def test_quantities_of_pint_are_values():
    unit = pint.UnitRegistry()
    given = changed(
        loading={"path": unit.Quantity([0.5, 2.0], "GPa")},
        interaction={"work_of_adhesion": unit.Quantity(0.1, "J/m^2"), "length": 3.28 * unit.angstrom},
        material={"poissons_ratio": unit.Quantity(0.42, "")},
        overdamped={"step_error": 0.1},
        dynamics={"damping": 1e12 / unit.s},
        surface={"shape": (np.int64(16), 16)},
        sweep={"surface.seed": np.array([1, 2])},
    )
    dataset = run(given)
    assert_same(dataset, run(STUDY))
    assert 'length = "3.28 angstrom"' in dataset.attrs["study_toml"]
    with pytest.raises(ValueError, match=r"interaction.length = '3.28 gigapascal': a unit of .* cannot be converted"):
        run(changed(interaction={"length": 3.28 * unit.GPa}))


def test_a_law_is_what_its_keys_make():
    for law in EVERY_LAW.values():
        gaps = law.equilibrium_distance + law.length * np.geomspace(1e-3, 3, 20)
        for given in (law, {"law": law}):
            (case,) = make_study(_plain(with_keys(STUDY | {"interaction": given, "sweep": {}}))).cases
            assert type(case.law) is type(law)
            np.testing.assert_allclose(case.law.traction(gaps), law.traction(gaps), rtol=1e-12)


SOLIDS = [
    HalfSpace(90e9),
    Layer(90e9, 0.42, 2e-9),
    Layered(90e9, 0.42, 2e-9, 50e9, 0.2),
    Viscoelastic(90e9, (10e9, 20e9), (1.0, 2.0)),
    Measured(90e9, (1e8, 1e9), (1e19, 5e19)),
]


@pytest.mark.parametrize("solid", SOLIDS, ids=lambda solid: type(solid).__name__)
def test_a_solid_is_what_its_keys_make(solid):
    viscous, q = isinstance(solid, Viscoelastic), np.geomspace(1e8, 1e10, 7)
    for given in (solid, {"kind": solid, "boundary": "periodic"}):
        study = changed(loading={"duration": 1.0} if viscous else {})
        study |= {"elasticity": given, "material": {"poissons_ratio": 0.42}, "sweep": {}}
        (case,) = make_study(_plain(with_keys(study))).cases
        assert type(case.solid) is type(solid)
        np.testing.assert_allclose(case.solid.stiffness(q), solid.stiffness(q), rtol=1e-12)
        assert case.material.contact_modulus == pytest.approx(solid.contact_modulus, rel=1e-14)
        if viscous:
            np.testing.assert_allclose(case.solid.branch_moduli, solid.branch_moduli, rtol=1e-14)


LIST = r'{0}\.{1} = \[.*\]: takes one value; .* \[sweep\], "{0}\.{1}" = \[\.\.\.\]'
SOLID, LAYER, NU = HalfSpace(90e9), Layer(90e9, 0.42, 2e-9), "material.poissons_ratio"
BY_WAVE = Tabulated(9e9, Grid((2, 2), (1.0, 1.0)), np.ones((2, 2)))
OWN_LAW = type("OwnLaw", (LennardJones104,), {})(0.1, 3e-10)


def with_heights(heights=None, **keys):
    return {"surface": {"heights": np.eye(8) if heights is None else heights, "size": 1e-8, **keys}}


@pytest.mark.parametrize(
    ("sections", "message"),
    [
        ({"interaction": OWN_LAW}, r"interaction: OwnLaw is no law of a study; pass TabulatedLaw\.through"),
        ({"interaction": {"law": LennardJones104(0.1, 3e-10), "length": 1e-10}}, r"interaction\.length: .* leave"),
        ({"elasticity": SOLID}, r"material\.youngs_modulus: .* leave it out"),
        ({"elasticity": SOLID, "material": {}}, r"missing key material\.poissons_ratio: HalfSpace"),
        (
            {"elasticity": LAYER, "material": {"poissons_ratio": 0.4}},
            r"material\.poissons_ratio = 0.4: the solid's is 0.42",
        ),
        ({"elasticity": BY_WAVE, "material": {"poissons_ratio": 0.0}}, "no keys of a study make a Tabulated"),
        ({"elasticity": SOLID, "material": {}, "sweep": {NU: [0.1, 0.2]}}, f"sweep.{NU}: elasticity is an object"),
        (with_heights("map.npy"), "surface.heights must be an array"),
        (with_heights(np.full((8, 8), np.nan)), "surface.heights is not finite"),
        ({"surface": {"heights": np.eye(8)}}, "size"),
        (with_heights(kind="sphere"), "surface.kind"),
        (with_heights(height_unit="nm"), "surface.height_unit"),
        ({"surface": {**STUDY["surface"], "seed": [1, 2]}}, LIST.format("surface", "seed")),
        ({"elasticity": {"kind": ["half_space", "layer"]}}, LIST.format("elasticity", "kind")),
        ({"interaction": {"length": ["3 angstrom", "4 angstrom"]}}, LIST.format("interaction", "length")),
    ],
)
def test_what_is_no_part_of_a_study_is_named(sections, message):
    unswept = {} if "sweep" in sections else {"sweep": {}}
    with pytest.raises(ValueError, match=message):
        run(STUDY | unswept | sections)


def test_what_the_command_warns_of_is_a_warning_here():
    coarse = changed(solver={"max_iterations": 1}, surface={"size": "4000 angstrom", "rms_height": "40 angstrom"})
    with (
        pytest.warns(UserWarning, match="quarter of the process zone") as review,
        pytest.warns(UserWarning, match="4 of 4 steps did not converge") as end,
    ):
        dataset = run(coarse)
    assert {warning.filename for warning in [*review, *end]} == {__file__}
    assert (dataset.converged == 0).all()


def test_the_version_is_that_of_the_installed_package():
    assert importlib.metadata.version("bem-adhesion") == contact_study.__version__


@pytest.mark.validation
def test_a_height_array_is_a_surface(tmp_path):
    height = 2e-11 * np.random.default_rng(0).standard_normal((16, 24))
    study = {name: keys for name, keys in STUDY.items() if name not in ("surface", "sweep")}
    own = study | {"surface": {"heights": height, "size": (4e-9, 6e-9)}}
    dataset = run(own, output="own.nc")
    np.save("map.npy", height)
    assert_same(dataset, run(study | {"surface": {"kind": "file", "path": "map.npy", "size": [4e-9, 6e-9]}}))
    assert dataset.rms_height == pytest.approx(height.std(), rel=1e-12)
    # The same array goes on where the file ends; another one is another study.
    longer = own | {"loading": {"path": ["0.5 GPa", "2 GPa", "1 GPa"]}}
    assert run(longer, output="own.nc", resume=True).sizes["step"] == 3
    with pytest.raises(ValueError, match=r"heights\.npy has changed"):
        run(own | {"surface": {"heights": 2 * height, "size": (4e-9, 6e-9)}}, output="own.nc", resume=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["map.npy", "own.nc", "own.nc.restart"]
    unit = pint.UnitRegistry()
    of_unit = {"heights": unit.Quantity(1e10 * height, "angstrom"), "size": unit.Quantity((4.0, 6.0), "nm")}
    assert run(study | {"surface": of_unit}).relative_contact_area[0] == pytest.approx(dataset.relative_contact_area[0])
    with pytest.raises(ValueError, match=r"surface\.heights: Cannot convert"):
        run(study | {"surface": of_unit | {"heights": unit.Quantity(height, "Pa")}})
