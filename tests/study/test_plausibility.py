"""Numbers that do not fit each other are named before any work, in one line; soft and weak laws are not refused."""

import re

import numpy as np
import pytest

from contact_study.inputs.errors import InputError
from contact_study.study.checks import idle_motion, review
from contact_study.study.study import make_study
from tests.study.test_study import changed, of_another_kind


def table_of(**sections):
    table = changed("study")
    if "kind" in sections.get("surface", {}):
        of_another_kind(table)
    for name, keys in sections.items():
        table.setdefault(name, {}).update(keys)
    if "work_of_adhesion" in table["interaction"]:
        table["interaction"].pop("well_depth", None)
    return table


def notes_of(**sections):
    return review(make_study(table_of(**sections)))


def test_soft_and_weak_laws_pass_without_a_word():
    for material, law, rms_height, path in (
        # Rubber with an atomic law, and a micrometre's reach.
        ({"youngs_modulus": "2 MPa", "poissons_ratio": 0.5}, ("0.05 J/m^2", "0.3 nm", "0.4 nm"), "1 um", ["100 kPa"]),
        ({"youngs_modulus": "1 GPa"}, ("1 mJ/m^2", "1 um", "1.2 um"), "0.01 um", ["10 Pa"]),
    ):
        interaction = dict(zip(("work_of_adhesion", "length", "contact_distance"), law, strict=True))
        surface = {"size": "100 um", "rms_height": rms_height}
        assert notes_of(material=material, interaction=interaction, surface=surface, loading={"path": path}) == []


def test_steep_surfaces_are_said_and_absurd_numbers_refused_in_one_line():
    table = table_of() | {"sweep": {"surface.rms_height": ["10 angstrom", "50 angstrom", "100 angstrom"]}}
    (note,) = review(make_study(table))
    assert "rms slope 2.62 (2 of 3 points of the sweep" in note
    for sections, culprit in (
        ({"surface": {"size": "10.4 nm", "rms_height": "200 m"}}, "surface.rms_height"),
        ({"surface": {"kind": "sphere", "radius": "0.01 nm"}}, "surface.radius"),
        ({"loading": {"path": ["1e30 Pa"]}}, "interaction"),
    ):
        with pytest.raises(InputError, match=culprit) as failure:
            notes_of(**sections)
        assert "\n" not in str(failure.value)


def test_weak_laws_are_said():
    (note,) = notes_of(interaction={"well_depth_ratio": 1e-5})
    assert "pressed to 0.3" in note
    notes = notes_of(interaction={"well_depth_ratio": 1e-8})
    assert len(notes) == 2
    assert "below the residual stress that solver.tolerance leaves" in notes[1]
    assert len(notes_of(interaction={"well_depth_ratio": 1e-8}, solver={"tolerance": 1e-12})) == 1


def test_coarse_grids_say_what_a_map_loses(tmp_path):
    long = np.tile(np.cos(2 * np.pi * np.arange(32) / 32), (32, 1))
    short = np.tile(np.cos(2 * np.pi * 6 * np.arange(32) / 32), (32, 1)).T
    np.save(tmp_path / "map.npy", 3 * long + short)
    keys = {"kind": "file", "path": "map.npy", "height_unit": "angstrom"}
    # The wave of six periods along y is lost on eight points there: of the variances 9/2 and 1/2 the first is left,
    # of the slopes' 9/2 and 36/2 likewise.
    finer, (note,) = (review(make_study(table_of(surface=keys | {"shape": [n, 32]}), tmp_path)) for n in (32, 8))
    assert finer == []
    assert f"({100 * (np.sqrt(9 / 10) - 1):+.2g} %)" in note
    assert f"({100 * (np.sqrt(9 / 45) - 1):+.2g} %)" in note
    assert "surface.shape = [8, 32] is coarser than the height map map.npy" in note

    for part, said in ((0.03, 0), (0.1, 1)):
        np.save(tmp_path / "map.npy", 3 * long + part * short)
        notes = review(make_study(table_of(surface=keys | {"shape": [8, 32]}), tmp_path))
        assert len(notes) == said, "less than a per cent of the map"
    # The root of 3² and (6 · 0.1)² loses 1.9 % with the short wave, that of 3² and 0.1² nothing to speak of.
    assert re.search(r"becomes \S+ \S+ \(the same\), rms slope \S+ becomes \S+ \(-\S+ %\)", notes[0])


def test_a_load_above_the_contact_modulus_is_named():
    (note,) = (line for line in notes_of(material={"youngs_modulus": 2}) if "loading.path" in line)
    modulus = 2 / (1 - 0.42**2)
    assert f"a pressure of 1 GPa is {1e9 / modulus:.2g} times the contact modulus, 2.43 Pa" in note
    assert "are the units of loading.path and material.youngs_modulus right?" in note
    assert not any("loading.path" in line for line in notes_of(loading={"path": ["90 GPa"]}))


def test_keys_without_effect_are_said():
    (note,) = notes_of(interaction={"law": "hard_wall"})
    assert note.startswith("interaction.well_depth, interaction.length, interaction.contact_distance: without effect")
    assert review(make_study(table_of() | {"interaction": {"law": "hard_wall"}})) == []
    for idle, used, words in (
        (
            {"loading": {"adaptive": True}, "interaction": {"law": "hard_wall"}},
            {"loading": {"adaptive": True}},
            "loading.adaptive = true: without effect; it belongs to laws that attract, or "
            'elasticity.kind = "viscoelastic"',
        ),
        (
            {"loading": {"resolution": 0.02}, "sweep": {"loading.adaptive": [True, False]}},
            {"loading": {"resolution": 0.02, "adaptive": True}},
            "loading.resolution: without effect (1 of 2 points of the sweep, such as adaptive = False); it belongs to "
            "loading.adaptive = true",
        ),
        (
            {"loading": {"time_steps": 5}},
            {"loading": {"time_steps": 5, "duration": 1.0}, "elasticity": VISCOELASTIC},
            'loading.time_steps: without effect; it belongs to elasticity.kind = "viscoelastic" without '
            "loading.adaptive",
        ),
    ):
        # Those of the interaction have no effect on the wall either.
        (note,) = (note for note in notes_of(**idle) if not note.startswith("interaction."))
        assert note == words
        assert notes_of(**used) == []


VISCOELASTIC = {"kind": "viscoelastic", "branch_youngs_moduli": [1e9], "relaxation_times": [1.0]}


def tabulated(low, high, modulus, **keys):
    """A half-space of a modulus (Pa) as a table between two wavenumbers, with units if they have some."""
    q = np.geomspace(low, high, 5)
    return {"kind": "tabulated", "wavenumber": q.tolist(), "stiffness": (0.5 * modulus * q).tolist()} | keys


def test_tables_of_a_stiffness_that_leave_out_waves_of_the_grid_are_said():
    """The paper's cell of 1040 Å has waves from 2π/1040 Å on, down to two grid spacings."""
    (case,) = make_study(table_of()).cases
    ends = 2 * np.pi / 104e-9, np.pi * case.surface.shape[0] / 104e-9
    modulus = case.material.contact_modulus
    assert notes_of(elasticity=tabulated(*ends, modulus)) == []
    (note,) = notes_of(elasticity=tabulated(1e-9 * ends[0], 1e-9 * ends[1], modulus))  # nm⁻¹ read as m⁻¹
    assert note.startswith("elasticity.path: the table holds waves of")
    assert f"{1e-9 * ends[0]:.3g} to {1e-9 * ends[1]:.3g} m^-1" in note
    assert f"waves of {ends[0]:.3g} to {ends[1]:.3g} m^-1:" in note
    assert len(notes_of(elasticity=tabulated(1.1 * ends[0], ends[1], modulus))) == 1
    for ratio, said in ((0.4, True), (0.6, False), (1.8, False), (2.2, True)):
        notes = notes_of(elasticity=tabulated(*ends, ratio * modulus))
        assert len(notes) == said
        assert all(f"the table's E* is {ratio * modulus:.3g} Pa" in note for note in notes)


def test_keys_of_a_way_of_motion_that_is_not_gone_are_said():
    flow, dynamics = {"overdamped": {"loading_rate": 1e-2}}, {"dynamics": {"duration": "1 ps", "frames": 5}}
    belongs = 'without effect; it belongs to atomistic.method = "dynamics"'
    assert idle_motion(make_study(table_of(**dynamics)).cases) == [f"dynamics.duration, dynamics.frames: {belongs}"]
    assert idle_motion(make_study(table_of(**dynamics, atomistic={"method": "dynamics"})).cases) == []
    (note,) = idle_motion(make_study(table_of(**flow)).cases)
    assert note.endswith('it belongs to atomistic.method or solver.path = "overdamped"')
    for chosen in ({"atomistic": {"method": "overdamped"}}, {"solver": {"path": "overdamped"}}):
        assert idle_motion(make_study(table_of(**flow, **chosen)).cases) == []
    swept = table_of(sampling={"trajectories": 20}) | {"sweep": {"atomistic.method": ["sampling", "dynamics"]}}
    assert idle_motion(make_study(swept).cases) == []
