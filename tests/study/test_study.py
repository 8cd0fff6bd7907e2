"""Study files: what is read, and the one clear line for what cannot be."""

import copy
import tomllib

import numpy as np
import pytest
import tomli_w

import bem_adhesion.study.model
import md_reference.study.model
import theory.study.model
from contact_study.inputs.errors import InputError
from contact_study.physics.lattice import lattice_of
from contact_study.study.case import path_points, path_points_of
from contact_study.study.schema.dotted_keys import bare_numbers
from contact_study.study.schema.loading import LoadingSection
from contact_study.study.study import make_study, read_study

SURFACE = {"kind": "self_affine", "size": "1040 angstrom", "shape": [64, 64], "rms_height": "10 angstrom"}
TABLE = {
    "surface": SURFACE | {"cutoff_mode": 12, "roll_off_mode": 3},
    "material": {"youngs_modulus": "77.2 GPa", "poissons_ratio": 0.42, "lattice_constant": "2.6 angstrom"},
    "interaction": {"well_depth": "18.6 meV", "length": "3.28 angstrom", "contact_distance": "3.68 angstrom"},
    "loading": {"path": ["0.1 GPa", "1 GPa"]},
}


def changed(section, **keys):
    table = copy.deepcopy(TABLE)
    if section == "surface" and keys.get("kind", "self_affine") != "self_affine":
        of_another_kind(table)
    table.setdefault(section, {}).update(keys)
    return table


def of_another_kind(table):
    """A table without the keys that only a self-affine surface has."""
    table["surface"] = {name: table["surface"][name] for name in ("size", "shape")}


def read(tmp_path, table, keys=()):
    (tmp_path / "study.toml").write_text(tomli_w.dumps(table))
    return read_study(tmp_path / "study.toml", dict(keys))


def test_quantities_are_si_also_in_lists_as_people_type_them():
    (case,) = make_study(changed("loading", path="0.1 GPa, 1 GPa")).cases
    # Each to rounding: a conversion is one multiplication.
    np.testing.assert_allclose(case.surface.size, (104e-9, 104e-9), rtol=1e-15)
    np.testing.assert_allclose(case.material.contact_modulus, 77.2e9 / (1 - 0.42**2), rtol=1e-15)
    np.testing.assert_allclose(case.interaction.well_depth, 18.6e-3 * 1.602176634e-19, rtol=1e-12)
    np.testing.assert_allclose([value for value, _ in case.path], [1e8, 1e9], rtol=1e-15)
    assert case.loading.unit == ("GPa", pytest.approx(1e9, rel=1e-12))
    # The most waves that 8 x 64 points carry, along each axis on its own.
    surface = {"kind": "wavy", "amplitude": "1 nm", "modes": [3, 31], "shape": [8, 64], "size": ["13 nm", "104 nm"]}
    assert make_study(changed("surface", **surface)).cases[0].surface.modes == (3, 31)
    for section, name, written, value in (
        ("surface", "size", "104 nm, 0.052 um", (1.04e-7, 5.2e-8)),
        ("surface", "shape", " 128 , 96 ", (128, 96)),
        ("output", "pressure_range", "-1 GPa, 20 GPa", (-1e9, 2e10)),
        ("loading", "path", ["0.1 GPa", "2e8 Pa"], (1e8, 2e8)),
        ("loading", "path", "-1e3, 2e5, 3", (-1e3, 2e5, 3.0)),
        ("loading", "path", -1e3, (-1e3,)),
    ):
        (case,) = make_study(changed(section, **{name: written})).cases
        # Each to the rounding of a conversion.
        np.testing.assert_allclose(getattr(getattr(case, section), name), value, rtol=1e-12)


def test_work_of_adhesion_is_that_of_the_pairs_of_atoms():
    (case,) = make_study(copy.deepcopy(TABLE)).cases
    assert (case.lattice.atoms, case.lattice.substrate_sites) == ((400, 400), (647, 647))
    # The reference, 0.6924 J/m², is for b = a/φ; made periodic, b = 400a/647 holds (647/(400φ))² as many sites.
    expected = 0.6924 * (647 / (400 * (1 + 5**0.5) / 2)) ** 2
    assert case.work_of_adhesion == pytest.approx(expected, abs=5e-5)  # the reference has four digits
    table = changed("interaction", work_of_adhesion=case.work_of_adhesion, well_depth_ratio=3)
    del table["interaction"]["well_depth"]
    # Rounding of two inverse formulas; the ratio multiplies either once.
    for other in (make_study(table).cases[0], make_study(changed("interaction", well_depth_ratio=3)).cases[0]):
        assert other.well_depth == pytest.approx(3 * case.well_depth, abs=0, rel=1e-14)
        assert other.work_of_adhesion == pytest.approx(3 * case.work_of_adhesion, rel=1e-14)
    (long,) = make_study(changed("surface", size=["104 nm", "26 nm"], shape=[256, 64])).cases
    assert (long.lattice.atoms, long.lattice.substrate_sites) == ((400, 100), (647, 162))
    # Δγ ∝ n_a n_b: the sites' density differs by the rounding of 161.8 sites to 162.
    assert long.work_of_adhesion == pytest.approx(case.work_of_adhesion * 162 / 161.75, rel=1e-12)


def test_sweep_expands_with_the_last_key_fastest():
    table = changed("sweep", **{"interaction.well_depth_ratio": [1, 4], "surface.seed": [1, 2, 3]})
    table["override"] = [{"when": {"interaction.well_depth_ratio": 4}, "loading.path": ["-0.5 GPa"]}]
    study = make_study(table)
    assert [case.index for case in study.cases] == [(i, j) for i in range(2) for j in range(3)]
    assert study.cases[4].coordinates == {"well_depth_ratio": 4.0, "seed": 2}
    assert [len(case.path) for case in study.cases] == [2, 2, 2, 1, 1, 1]
    assert study.cases[3].work_of_adhesion == pytest.approx(4 * study.cases[0].work_of_adhesion, rel=1e-15)
    assert make_study(tomllib.loads(study.toml)).cases == study.cases


SWEPT = changed("sweep", **{"interaction.well_depth_ratio": [1, 4]})


def test_the_command_line_sweeps_by_lists_where_a_key_takes_one_value(tmp_path):
    for section, name, written, values in (
        ("surface", "seed", "1,2, 5", (1, 2, 5)),
        ("interaction", "well_depth_ratio", 7, (7.0,)),
        ("interaction", "well_depth_ratio", [2, 3], (2.0, 3.0)),
    ):
        study = read(tmp_path, SWEPT, {f"{section}.{name}": written})
        assert study.sweep[name].values == values
        assert {getattr(getattr(case, section), name) for case in study.cases} == set(values)
    study = read(tmp_path, TABLE, {"loading.path": "1 MPa, 2 MPa", "surface.shape": "32, 32"})
    assert not study.sweep
    assert [value for value, _ in study.cases[0].path] == pytest.approx([1e6, 2e6])
    for key, value, words in (
        ("surface.seed", "1, x", "surface.seed = '1, x': expected a whole number"),
        ("output.gap_bins", "10, 20", "output.gap_bins = '10, 20': expected a whole number"),
        ("loading.unload", [], r"loading.unload = \[\]: expected true or false"),
    ):
        with pytest.raises(InputError, match=words):
            read(tmp_path, TABLE, {key: value})


def test_exceptions_match_however_written_or_are_noted_and_the_command_line_has_the_last_word(tmp_path):
    size = {"surface.size": [1.04e-7, "1040 angstrom"], "surface.hurst_exponent": 0.8}
    for written, others in ((4, {}), (4.0, {"surface.size": "104 nm"}), ("4", size)):
        exception = {"when": {"interaction.well_depth_ratio": written, **others}, "loading.path": ["2 GPa"]}
        study = make_study(SWEPT | {"override": [exception]})
        assert [len(case.path) for case in study.cases] == [2, 1]
        assert study.notes == ()
    (note,) = make_study(SWEPT | {"override": [{"when": {"surface.seed": 2}, "loading.path": ["2 GPa"]}]}).notes
    assert "surface.seed = 2" in note
    exception = {"when": {"interaction.well_depth_ratio": 4}, "loading.path": ["2 GPa"]}
    study = read(tmp_path, SWEPT | {"override": [exception]}, {"loading.path": ["5 GPa"]})
    assert [case.path[0][0] for case in study.cases] == pytest.approx([5e9, 5e9])


def test_a_sweep_over_kinds_holds_the_keys_of_all():
    table = changed("surface", radius="1 um")
    table["sweep"] = {"surface.kind": ["self_affine", "sphere", "flat"], "surface.seed": [1, 2]}
    study = make_study(table)
    assert [case.surface.kind for case in study.cases] == ["self_affine"] * 2 + ["sphere"] * 2 + ["flat"] * 2
    assert [case.surface.realisation for case in study.cases] == [1, 2, None, None, None, None]
    assert [case.coordinates["seed"] for case in study.cases] == [1, 2] * 3, "a dimension of every dataset"
    assert not hasattr(study.cases[2].surface, "rms_height")


def test_a_kind_chosen_on_the_command_line_leaves_the_files_behind(tmp_path):
    table = changed("sweep", **{"surface.seed": [1, 2], "interaction.well_depth_ratio": [1, 4]})
    table["override"] = [{"when": {"interaction.well_depth_ratio": 4}, "surface.hurst_exponent": 0.5}]
    study = read(tmp_path, table, {"surface.radius": "1 um", "surface.kind": "sphere"})
    assert [case.surface.radius for case in study.cases] == pytest.approx([1e-6, 1e-6], abs=0, rel=1e-12)
    assert list(study.sweep) == ["well_depth_ratio"]
    with pytest.raises(InputError, match=r"surface\.seed: kind = \"sphere\" has no such key"):
        read(tmp_path, table, {"surface.kind": "sphere", "surface.radius": "1 um", "surface.seed": 3})
    assert len(read(tmp_path, table, {"surface.kind": "self_affine"}).cases) == 4, "its own kind loses nothing"


WRONG = [
    (changed("surfaces"), "[surfaces]"),
    (changed("surface", rms_height="10 GPa"), "surface.rms_height"),
    (changed("surface", rms_height="10 angstroem"), "angstroem"),
    (changed("surface", rms_height=float("nan")), "surface.rms_height"),
    (changed("surface", rms_height=True), "surface.rms_height"),
    (changed("solver", threads=10**9), "must be at most 1024"),
    ({**TABLE, "sweep": {"interaction.well_depth_ratio": []}}, "well_depth_ratio"),
    (changed("theory", flows=["gap_flow", "gap_flow"]), "names one twice"),
    (changed("surface", cutoff_mode=32), "surface.cutoff_mode"),
    (changed("surface", roll_off_mode=13), "must not decrease"),
    (changed("surface", kind=["flat"]), "surface.kind = "),
    (changed("interaction", law={"law": 1}), "interaction.law = "),
    (changed("sweep", **{"theory.wavevectors": [1e8, 2e8]}), "sweep.theory.wavevectors: a list cannot be swept"),
    (changed("surface", radius="1 um"), 'surface.radius: kind = "self_affine" has no such key; it belongs to sphere'),
    ({**changed("surface", radius="1 um"), "sweep": {"surface.kind": ["self_affine", "flat"]}}, "surface.radius"),
    (changed("material", poissons_ratio=0.6), "material.poissons_ratio"),
    (changed("interaction", contact_distance="3 angstrom"), "interaction.contact_distance"),
    (changed("loading", path=[]), "loading.path"),
    (changed("loading", path=["0.1 GPa", 2e8]), "loading.path"),
    (changed("loading", path=["1 GPa", "-40 GPa"]), "loading.path[1] = -40 GPa exceeds the largest tensile stress"),
    (changed("surface", rms_height="1,5 nm"), "surface.rms_height = '1,5 nm': use a decimal point, \"1.5 nm\""),
    (changed("solver", tolerance=1e-17), "must be at least 1e-15"),
    (changed("elasticity", kind="viscoelastic", branch_youngs_moduli=1e9, relaxation_times=[1, 2]), "1 branch_youngs_"),
    (changed("output", gap_range=["2 nm", "1 nm"]), "output.gap_range"),
    (changed("surface", rms_height="9**9**9**9 m"), "surface.rms_height"),  # nothing is calculated
    (changed("surface", rms_height=1e308), "far from any size"),
    (changed("surface", hurst_exponent="0.8 m/m"), "without a unit"),
    (changed("surface", kind="wavy", amplitude="1 nm", modes=[5, 1], shape=[8, 32]), "5 waves along y"),
    (changed("surface", size="3840 nm, 5120"), "surface.size[1] = '5120': has no unit"),
    (changed("sweep", **{"surface.size": ["104 nm, 52 nm", "104 nm"]}), "two equal values"),
    (changed("interaction", law="lennard_jones_9_3"), "interaction.well_depth"),
    (changed("atomistic", cutoff=1.1), "must be at least 2; the law's peak must lie within"),
    (changed("dynamics", seed=3), "unknown key dynamics.seed (use atomistic.random_seed); known"),
    (changed("sweep", **{"sampling.seed": [1, 2]}), "unknown key 'sampling.seed' (use atomistic.random_seed)"),
    (changed("sweep", **{"output.gap_bins": [10, 20]}), "sweep.output.gap_bins"),
    (changed("sweep", **{"surface.size": ["1040 angstrom", "104 nm"]}), "holds a value twice"),
    ({**changed("interaction", well_depth_ratio="x"), "sweep": {"interaction.well_depth_ratio": [1]}}, "'x'"),
    ({**TABLE, "override": [{"loading.path": [1e8]}]}, "override"),
    ({**TABLE, "override": [{"when": {"surface.seed": 1}, "output.gap_bins": 9}]}, "output.gap_bins"),
    (SWEPT | {"override": [{"when": {"surface.seed": 1}, "interaction.well_depth_ratio": 3}]}, "_ratio is swept"),
]


@pytest.mark.parametrize(("table", "culprit"), WRONG, ids=[culprit for _, culprit in WRONG])
def test_wrong_input_is_named_in_one_line(table, culprit):
    with pytest.raises(InputError) as failure:
        make_study(copy.deepcopy(table))
    assert culprit in str(failure.value)
    assert "\n" not in str(failure.value)


@pytest.mark.parametrize("model", [bem_adhesion.study.model, md_reference.study.model, theory.study.model])
def test_a_gap_that_is_none_is_for_driven_blocks(model):
    """Whose plane goes as far as the block is compressed, 0.6 GPa at -3.28 angstrom and the paper's size."""
    table = changed("loading", control="gap", path=["1 nm", "-3.28 angstrom"])
    table["material"]["atom_mass"] = "197 u"
    table.update(dynamics={"approach_speed": "20 m/s"})
    with pytest.raises(InputError, match="leaves no gap between"):
        model.check(make_study(table).cases[0])
    if model is md_reference.study.model:
        model.check(make_study(table | {"atomistic": {"method": "dynamics"}}).cases[0])


def test_hard_wall_needs_neither_adhesion_nor_tension():
    table = changed("study") | {"interaction": {"law": "hard_wall", "work_of_adhesion": 0.69}}
    assert make_study(table).cases[0].work_of_adhesion == 0.0
    table["loading"]["path"] = ["-0.1 GPa"]
    with pytest.raises(InputError, match="hard wall"):
        make_study(table)


def test_unreadable_study(tmp_path):
    path = tmp_path / "study.toml"
    for content, culprit in (
        *((b"\xff\xfe\x00", "no text"), (b"[surface\n", "no valid TOML")),
        *((b"surface = 3", "surface = 3"), (b"override = 3", "override"), (None, "cannot be read")),
    ):
        path.write_bytes(content) if content else path.unlink()
        with pytest.raises(InputError, match=culprit):
            read_study(path, {"surface.seed": 2})


def test_a_lattice_that_does_not_fit_the_cell_is_told_of_one_that_does():
    with pytest.raises(InputError, match=r"lattice_constant = 2.5e-10 m: .*24.96 atoms.*; 2.496e-10 m divides it"):
        lattice_of((62.4e-10, 62.4e-10), 2.5e-10)
    assert lattice_of((62.4e-10, 62.4e-10), 2.496e-10).atoms == (25, 25)


def test_bare_numbers_are_named_with_the_unit_they_are_taken_in_three_at_most(tmp_path):
    for section, keys, said in (
        ("material", {"youngs_modulus": 2}, "material.youngs_modulus = 2 is 2 Pa;"),
        ("surface", {"size": [1.04e-7, 2.08e-7]}, "surface.size = 1.04e-07 is 1.04e-07 m;"),
        ("loading", {"path": [1, 2]}, "loading.path = 1 is 1 Pa;"),
        ("loading", {"path": [0, 1e-9], "control": "gap"}, "loading.path = 1e-09 is 1e-09 m;"),
        ("sweep", {"material.youngs_modulus": [1, 2]}, "youngs_modulus = 1 is 1 Pa;"),
    ):
        (line,) = read(tmp_path, changed(section, **keys)).notes
        assert line.startswith("numbers without a unit are taken in SI: ")
        assert said in line
    for keys, name, said in (
        ({"path": ("1 Pa",), "history": "sine", "amplitude": 2}, "amplitude", "2 Pa"),
        ({"path": ("1 nN",), "history": "sine", "amplitude": 2}, "amplitude", "2 N"),
        ({"path": ("1 nN",), "duration": 2}, "duration", "2 s"),
        ({"path": ("1 Pa",), "speed": 2}, "speed", "2 Pa/s"),
        ({"path": ("1 nN",), "speed": 2}, "speed", "2 N/s"),
        ({"path": ("1 nm",), "control": "approach", "speed": 2}, "speed", "2 m/s"),
        ({"path": ("1 nm",), "control": "approach", "trigger_force": 2}, "trigger_force", "2 N"),
        ({"path": ("1 nm",), "control": "approach", "machine_stiffness": 2}, "machine_stiffness", "2 N/m"),
    ):
        (line,) = bare_numbers({"loading": {name: 2}}, LoadingSection(**keys))
        assert f"loading.{name} = 2 is {said};" in line
    waves = {"path": ["1 MPa"], "history": "sine"}
    study = make_study(changed("loading", **waves) | {"sweep": {"loading.amplitude": [1e5, 2e5]}})
    assert study.sweep["amplitude"].units == "Pa"
    swept = changed("sweep", **{"surface.seed": [1, 2], "surface.rms_height": ["1 nm", "2 nm"]})
    assert read(tmp_path, swept).notes == read(tmp_path, changed("loading", control="gap", path=[0])).notes == ()
    assert make_study(changed("loading", path=[1e6])).notes == ()
    many = changed("surface", size=1.04e-7, rms_height=1e-9) | {"loading": {"path": [1e9]}}
    (line,) = read(tmp_path, many, {"material.youngs_modulus": 10}).notes
    assert line.count(" is ") == 3
    assert ", and 1 keys more; " in line
    exception = {"when": {"surface.seed": 1}, "surface.hurst_exponent": 0.5, "surface.rms_height": 2}
    seeds = changed("sweep", **{"surface.seed": [1, 2]}) | {"override": [exception]}
    assert "surface.rms_height = 2 is 2 m" in read(tmp_path, seeds).notes[0]


def of_a_sphere(folder=".", surface=(), **loading):
    table = changed("surface", kind="sphere", size=["2 um", "3 um"], shape=[20, 30], radius="9 um")
    table |= {"interaction": {"law": "hard_wall"}, "loading": loading}
    del table["material"]["lattice_constant"]
    return make_study(table | ({"surface": dict(surface)} if surface else {}), folder)


def test_forces_are_shared_out_over_the_cell(tmp_path):
    loading = of_a_sphere(path=["12 nN", "0.3 uN"]).cases[0].loading
    # 6e-12 m²; the quotient of two decimals, to rounding.
    np.testing.assert_allclose(loading.path, [2e3, 5e4], rtol=1e-14)
    assert loading.unit == ("nN", pytest.approx(1e-9 / 6e-12, rel=1e-14))
    # A map brings its own cell.
    np.save(tmp_path / "map.npy", np.random.default_rng(1).normal(size=(16, 16)) * 1e-9)
    surface = {"kind": "file", "path": "map.npy", "size": "2 um", "crop": [["0 um", "1 um"], ["0 um", "0.5 um"]]}
    (case,) = of_a_sphere(tmp_path, surface, path=["12 nN"]).cases
    assert case.loading.path[0] == pytest.approx(12e-9 / 0.5e-12, rel=1e-12)
    for loading, culprit in (
        ({"path": ["12 nN", "2 MPa"]}, r"loading\.path\[1\] = '2 MPa'.*expected a number in N"),
        ({"path": ["12 nN"], "control": "gap"}, r"loading\.path\[0\] = '12 nN'.*expected a number in m"),
        ({"path": ["-12 nN"]}, r"-2000 Pa cannot be carried"),
    ):
        with pytest.raises(InputError, match=culprit):
            of_a_sphere(**loading)


def test_points_of_paths_are_matched_by_value_branch_and_visit():
    (case,) = make_study(changed("loading", path=["0 Pa", "1 GPa", "0.1 GPa", "1 GPa"], unload=True)).cases
    one, tenth = "1000000000", "100000000"
    up, down = [("0", 0, 0), (one, 0, 0), (tenth, 0, 0), (one, 0, 1)], [(tenth, 1, 0), (one, 1, 0), ("0", 1, 0)]
    assert path_points_of(case) == up + down
    # Padded by NaN; twelve digits tell points apart, no sign of zero does.
    one, near, same, zero, minus, padded = path_points(
        [1e9, 1e9 * (1 + 1e-11), 1e9 * (1 + 1e-15), 0.0, -0.0, np.nan], [0] * 6
    )
    assert padded is None
    assert one[0] != near[0]
    assert (same[0], same[2]) == (one[0], 1)
    assert (minus[0], minus[2]) == (zero[0], 1)
