"""Plates and sheets that nothing supports, and solids that a Python module holds."""

import importlib
import re
import sys
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from scipy.linalg import expm

import contact_study
from bem_adhesion import LennardJones104, rough_contact
from contact_study.inputs.errors import InputError
from contact_study.physics.solids import FunctionSolid, HalfSpace, Plate, Sheet
from contact_study.physics.solids.function import named
from contact_study.start import bem_adhesion
from contact_study.study.schema.elasticity import PythonSection
from contact_study.study.study import make_study, with_keys
from tests.study.test_elasticity import isotropic

MODULUS, THICKNESS = 3.0, 0.7


@pytest.mark.parametrize("ratio", [-0.3, 0.3, 0.5])
@pytest.mark.parametrize("thickness_in_waves", [0.05, 1.0, 5.0])
def test_plates_solve_the_equations_of_elasticity_between_free_faces(ratio, thickness_in_waves):
    q = thickness_in_waves / THICKNESS
    plane, share, axial, shear = isotropic(MODULUS, ratio)
    system = [[0, q, shear, 0], [-share * q, 0, 0, axial], [plane * q**2, 0, 0, share * q], [0, 0, -q, 0]]
    at_surface = expm(np.array(system) * THICKNESS) @ np.eye(4)[:, :2]  # free below: displacements alone
    expected = 1 / (at_surface[1] @ np.linalg.solve(at_surface[2:], [0.0, 1.0]))
    # Rounding grows by e^(2x) as waves decay, and by x⁻³ as bending cancels squeezing.
    lost = max(np.exp(2 * thickness_in_waves), thickness_in_waves**-3)
    assert Plate(MODULUS, THICKNESS).stiffness(q) == pytest.approx(expected, rel=1e-14 * lost)


def test_plates_are_half_spaces_when_thick_and_bend_when_thin():
    plate = Plate(MODULUS, THICKNESS)
    assert plate.stiffness(60.0) == pytest.approx(HalfSpace(MODULUS).stiffness(60.0), rel=1e-14)
    q = 1e-4
    assert plate.stiffness(q) == pytest.approx(MODULUS * THICKNESS**3 / 12 * q**4, rel=1e-7)  # shear: x²/5
    sheet, scaled = Sheet(MODULUS, 2.0, 5.0, 7.0), Sheet(MODULUS, 2.0, 5.0, 7.0).scaled(10.0, 4.0)
    assert sheet.stiffness(3.0) == 2.0 * 81 + 5.0 * 9 + 7.0
    for solid, same in ((sheet, scaled), (plate, plate.scaled(10.0, 4.0))):
        assert same.stiffness(30.0) * 4.0 / 10.0 == pytest.approx(solid.stiffness(3.0), rel=1e-14)
    assert (sheet.mean_compliance, Sheet(1.0, 1.0).mean_compliance, plate.mean_compliance) == (1 / 7, 0.0, 0.0)
    for wrong in ((-1.0,), (1.0, -1.0), (1.0, 0.0, -1.0), (0.0,), (np.nan,)):
        with pytest.raises(ValueError, match=r"bending_stiffness|tension|foundation"):
            Sheet(1.0, *wrong)


@pytest.mark.parametrize(("share", "conforms"), [(0.95, False), (1.05, True)])
def test_a_sheet_conforms_to_a_wave_at_the_work_of_adhesion_that_its_bending_takes(share, conforms):
    """Between crests of h cos qx a sheet under a pressure p = P κq⁴h leaves contact with a jump of its curvature.

    The jump is h q² f, f(φ) = sin φ/φ − cos φ − P φ²/3, φ/q the half width of the gap, and the edge is in balance where
    ½ κ (h q² f)² is the work of adhesion: above the largest there is none, and the sheet closes.
    """
    points, height, q, load = 64, 1e-3, 2 * np.pi, 0.01
    phi = np.linspace(1.0, np.pi, 10_000)
    largest = np.max(np.sin(phi) / phi - np.cos(phi) - load * phi**2 / 3) ** 2
    work = share * largest * 0.5 * height**2 * q**4
    # The range of the law over h moves the transition by its share, twice.
    law = LennardJones104(work, 0.02 * height)
    wave = height * np.cos(q * np.arange(points) / points) * np.ones((4, 1))
    contact = rough_contact(wave, (4 / points, 1.0), Sheet(10 * height * q**4, 1.0), law)
    found = contact.step(contact.separated(), load * height * q**4)
    assert found.converged
    assert bool(np.all(found.gap < law.peak_distance)) is conforms


STUDY = {
    "surface": {"kind": "wavy", "size": "1 um", "shape": [16, 16], "amplitude": "1 nm"},
    "material": {"youngs_modulus": "1 GPa", "poissons_ratio": 0.0},
    "interaction": {"law": "lennard_jones_10_4", "work_of_adhesion": "1 mJ/m^2", "length": "5 nm"},
    "loading": {"path": ["0.1 MPa"]},
}
MODULE = """
from contact_study.physics.solids import HalfSpace, Plate
class Own(HalfSpace):
    pass
own = Own(2e9)
def bed(q):
    return 1e15 + 0 * q
plate = Plate(1e9, 1e-7)
number = 1
def negative(q):
    return -q
def scalar(q):
    return float(q)
"""


@pytest.fixture
def module(tmp_path, monkeypatch):
    (tmp_path / "own_solids_of_test.py").write_text(MODULE)
    monkeypatch.syspath_prepend(tmp_path)
    sys.modules.pop("own_solids_of_test", None)
    yield tmp_path / "own_solids_of_test.py"
    named.cache_clear()


def study(loading=None, sweep=None, **elasticity):
    changed = {"elasticity": elasticity, "loading": STUDY["loading"] | (loading or {})}
    return make_study(STUDY | changed | ({"sweep": sweep} if sweep else {}))


def test_a_study_takes_solids_of_a_module_and_records_the_module(module, tmp_path):
    (bed,) = study(kind="python", object="own_solids_of_test:bed").cases
    assert isinstance(bed.solid, FunctionSolid)
    in_units = bed.solid.scaled(1e-9, 1e9)
    assert (bed.solid.stiffness(3.0), in_units.stiffness(np.ones(2)).tolist()) == (1e15, [1e-3] * 2)
    written = study(kind="python", object="own_solids_of_test:plate")
    (same,), (plate,) = written.cases, study(kind="plate", thickness="0.1 um").cases
    assert same.solid == plate.solid
    run = contact_study.run(written.table, output=tmp_path / "one.nc")
    assert run["gap_pdf"].equals(
        contact_study.run(STUDY | {"elasticity": {"kind": "plate", "thickness": 1e-7}})["gap_pdf"]
    )
    assert same.elasticity.object_hash in run.attrs["study_toml"]
    # An object of the module is its name, by run and in a study; so is one in place of the section.
    held, material = importlib.import_module("own_solids_of_test"), {"poissons_ratio": 0.0}
    for solid, given, more in (
        ("plate", {"kind": "python", "object": held.plate}, {"youngs_modulus": "1 GPa"}),
        ("bed", {"kind": "python", "object": held.bed}, {"youngs_modulus": "1 GPa"}),
        ("own", held.own, {}),
    ):
        table = STUDY | {"elasticity": given, "material": material | more}
        (case,) = make_study(with_keys(table)).cases
        assert case.elasticity == PythonSection(
            kind="python", object=f"own_solids_of_test:{solid}", object_hash=same.elasticity.object_hash
        )
        assert case.solid.contact_modulus == (2e9 if solid == "own" else 1e9)
    again = contact_study.run(STUDY | {"elasticity": {"kind": "python", "object": held.plate}})
    assert again["gap_pdf"].equals(run["gap_pdf"])
    assert 'object = "own_solids_of_test:plate"' in again.attrs["study_toml"]
    module.write_text(MODULE + "# changed")
    named.cache_clear()
    with pytest.raises(InputError, match=r"own_solids_of_test:plate': its module is another"):
        make_study(dict(written.table))


def test_an_object_that_no_run_could_find_again_is_refused(module, monkeypatch):
    held = importlib.import_module("own_solids_of_test")
    for given, words in (
        (lambda q: q, "<lambda> is given as an object, but no module holds it"),
        (type(held.own)(3e9), "Own is given as an object, but no module holds it.*my_solids.py"),
    ):
        with pytest.raises(InputError, match=words):
            study(kind="python", object=given)
    monkeypatch.setattr(sys.modules[__name__], "STUDY_SOLID", held.plate, raising=False)
    with pytest.raises(InputError, match=f"several modules hold it; give .*{__name__}:STUDY_SOLID"):
        study(kind="python", object=held.plate)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"kind": "python", "object": "own_solids_of_test"}, 'must be "module:name"'),
        ({"kind": "python", "object": "no_such_module:a"}, "cannot be imported"),
        ({"kind": "python", "object": "own_solids_of_test:number"}, "is a int, neither"),
        (
            {"kind": "python", "object": "own_solids_of_test:bed", "sweep": {"elasticity.object": ["re:escape"]}},
            "cannot be swept",
        ),
        ({"kind": "python"}, "missing key elasticity.object"),
        ({"kind": "sheet", "bending_stiffness": 0.0}, "one must be positive"),
        ({"kind": "sheet", "bending_stiffness": "-1 eV"}, "bending_stiffness"),
        ({"kind": "plate"}, "missing key elasticity.thickness"),
        ({"kind": "plate", "thickness": "1 um", "boundary": "free"}, 'elasticity.boundary = "free"'),
        ({"kind": "plate", "thickness": "1 um", "loading": {"control": "approach"}}, 'kind = "plate" by no finite'),
        ({"kind": "sheet", "bending_stiffness": "1 eV", "loading": {"control": "approach"}}, "by no finite distance"),
    ],
)
def test_what_cannot_be_is_one_line(module, keys, words):
    loading = {"path": ["1 nm"]} | keys.pop("loading") if "loading" in keys else None
    with pytest.raises(InputError, match=re.escape(words)):
        study(loading, **keys)


@pytest.mark.parametrize(("name", "fault"), [("negative", "must be positive and finite"), ("scalar", "TypeError")])
def test_a_function_that_is_no_stiffness_is_one_line_of_the_command(module, tmp_path, monkeypatch, capsys, name, fault):
    monkeypatch.chdir(tmp_path)
    kind = {"kind": "python", "object": f"own_solids_of_test:{name}"}
    Path("study.toml").write_text(tomli_w.dumps(STUDY | {"elasticity": kind}))
    assert bem_adhesion(["run", "study.toml", "-o", "out.nc"]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert f"elasticity.object = 'own_solids_of_test:{name}': its K(q) fails" in line
    assert fault in line
    assert not list(tmp_path.glob("out.nc*"))


def test_a_solid_of_another_modulus_than_the_material_is_refused(module):
    module.write_text(MODULE.replace("Plate(1e9", "Plate(2e9"))
    with pytest.raises(InputError, match=r"contact modulus is 2e\+09 Pa, that of \[material\] 1e\+09"):
        study(kind="python", object="own_solids_of_test:plate")
