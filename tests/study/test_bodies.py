"""Two bodies of several parts: their combined heights, scales, modulus, files, commands and refusals."""

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
import tomli_w

import contact_study
from contact_study import composite_surface, make_study, realise
from contact_study.campaign import model as models
from contact_study.inputs.errors import InputError
from contact_study.start import bem_adhesion
from contact_study.study.checks import review

SIZE, SHAPE = (2e-7, 1e-7), (32, 16)
ROUGH = {"kind": "self_affine", "size": "100 nm", "shape": [32, 32], "rms_height": "1 nm", "cutoff_mode": 8}
REST = {
    "material": {"youngs_modulus": "10 GPa", "poissons_ratio": 0.3},
    "interaction": {"law": "hard_wall"},
    "loading": {"path": ["50 MPa", "200 MPa"]},
}


def maps(tmp_path, *shapes):
    found = []
    for number, shape in enumerate(shapes):
        heights = 1e-11 * np.random.default_rng(number).standard_normal(shape)
        found.append(heights - heights.mean())
        np.save(tmp_path / f"map{number}.npy", found[-1])
    return found


def heights_at(heights, y, x):
    """Periodic heights at whole numbers of points."""
    return heights[np.ix_(y % heights.shape[0], x % heights.shape[1])]


def test_heights_are_the_sum_of_body_and_counterface_turned_over_rotated_moved_and_repeated(tmp_path):
    own, other, fine = maps(tmp_path, SHAPE, (16, 16), (8, 8))
    table = {"kind": "file", "path": "map0.npy", "size": list(SIZE)}
    counter = {"kind": "file", "path": "map1.npy", "size": "100 nm", "offset": ["12.5 nm", "-18.75 nm"]}
    detail = {"kind": "file", "path": "map2.npy", "size": "50 nm"}
    y, x = np.arange(SHAPE[0]), np.arange(SHAPE[1])
    whole = own + heights_at(fine, y, x)
    for turns, at in enumerate(
        (lambda y, x: (y, x), lambda y, x: (-x, y), lambda y, x: (-y, -x), lambda y, x: (x, -y))
    ):
        found = composite_surface(table, None, detail, {**counter, "rotation": f"{90 * turns} deg"}, tmp_path)
        # Where a point of the counterface stood before it was moved by two and −three points, and rotated.
        before_y, before_x = at(*np.meshgrid(y - 2, x + 3, indexing="ij"))
        expected = whole + other[before_y % 16, -before_x % 16]
        np.testing.assert_allclose(found.sampled, expected, atol=1e-24)  # rounding of transforms of 1e-11 m
        finer = found.heights((64, 32))
        np.testing.assert_allclose(finer[::2, ::2].mean(), 0, atol=1e-24)
    # Half a point is one on a finer grid, on which the map's trigonometric polynomial moves as a whole.
    flat = {"kind": "flat", "size": list(SIZE), "shape": [64, 16]}
    moves = ({**counter, "offset": [way, 0]} for way in (0, "3.125 nm"))
    finer = [composite_surface(flat, None, None, each, tmp_path) for each in moves]
    np.testing.assert_allclose(finer[1].sampled, np.roll(finer[0].sampled, 1, axis=0), atol=1e-24)


def test_two_rough_bodies_are_one_with_the_difference_of_heights_and_two_moduli_are_one():
    own, other = (composite_surface({**ROUGH, "rms_height": 2e-10, "seed": seed}).sampled for seed in (1, 2))
    one = {"surface": {"heights": own + np.roll(other[:, ::-1], 1, axis=1), "size": 1e-7}, **REST}
    two = {"surface": {"heights": own, "size": 1e-7}, "counterface": {"heights": other, "size": 1e-7}, **REST}
    elastic = {
        "youngs_modulus": 3e10,
        "poissons_ratio": 0.3,
        "counter_youngs_modulus": 1e10,
        "counter_poissons_ratio": 0.5,
    }
    stiffnesses = 3e10 / (1 - 0.3**2), 1e10 / (1 - 0.5**2)
    modulus = stiffnesses[0] * stiffnesses[1] / sum(stiffnesses)
    one["material"] = {"youngs_modulus": modulus * (1 - 0.2**2), "poissons_ratio": 0.2}
    two["material"] = elastic
    first, second = contact_study.run(one), contact_study.run(two)
    # The residual that the solver leaves, 1e-8; the heights differ by rounding.
    np.testing.assert_allclose(second.mean_gap, first.mean_gap, rtol=1e-6)
    np.testing.assert_array_equal(second.relative_contact_area, first.relative_contact_area)
    assert float(second.contact_modulus) == pytest.approx(modulus, rel=1e-12)
    assert float(second.counter_contact_modulus) == pytest.approx(stiffnesses[1], rel=1e-12)
    assert "counter_contact_modulus" not in first
    axial = {"axial_modulus": 2e10, "axial_poissons_ratio": 0.25, "axial_shear_modulus": 1e10}
    turned = {**two, "elasticity": {"kind": "transversely_isotropic", **axial}}
    rigid = {**turned, "material": {name: elastic[name] for name in ("youngs_modulus", "poissons_ratio")}}
    cases = [make_study({**study, "surface": {**ROUGH}, "counterface": {}}).cases[0] for study in (turned, rigid)]
    both, alone = (1 / case.solid.contact_modulus for case in cases)
    assert both - alone == pytest.approx(1 / stiffnesses[1], rel=1e-12)


def rounded(beyond):
    """Edge of a punch beyond its flat face."""
    return -np.where(beyond < 3e-8, np.maximum(beyond, 0) ** 2 / 6e-8, beyond - 1.5e-8)


FORMS = {
    "sphere": ({"radius": 4e-7}, lambda y, x: np.sqrt(4e-7**2 - y**2 - x**2)),
    "cylinder": ({"radius": 4e-7}, lambda y, x: np.sqrt(4e-7**2 - x**2) + 0 * y),
    "paraboloid": ({"radii": [1e-6, 2e-6]}, lambda y, x: -(y**2) / 2e-6 - x**2 / 4e-6),
    "cone": ({"slope": 0.1}, lambda y, x: -0.1 * np.hypot(y, x)),
    "punch": ({"flat_radius": 2e-8, "edge_radius": 3e-8}, lambda y, x: rounded(np.hypot(y, x) - 2e-8)),
    "plane": ({}, lambda y, x: 0 * y * x),
}


@pytest.mark.parametrize("kind", FORMS)
def test_a_form_is_placed_rotated_and_tilted_under_roughness_and_its_scales_are_its_own(kind):
    keys, profile = FORMS[kind]
    placement = {"offset": ["10 nm", "-20 nm"], "rotation": "30 deg", "tilt": ["1 deg", "-2 deg"]}
    form = {"kind": kind, **keys, **placement}
    found, rough = composite_surface(ROUGH, form), composite_surface(ROUGH)
    at = np.arange(32) * 1e-7 / 32 - 5e-8
    y, x = at[:, None] - 1e-8, at[None, :] + 2e-8
    up, across = np.tan(np.radians([1, -2]))
    expected = profile(y * np.sqrt(3) / 2 - x / 2, x * np.sqrt(3) / 2 + y / 2) + up * y + across * x
    left = found.sampled - rough.sampled - expected
    np.testing.assert_allclose(left, left.mean(), atol=1e-12 * 4e-7)  # rounding of a radius
    assert np.std(left) < 1e-12 * 4e-7
    fine = {"kind": "flat", "size": "100 nm", "shape": [256, 256]}
    study = {"form": form, **REST, "elasticity": {"boundary": "free"}}
    case, alone = (make_study({"surface": surface, **study}).cases[0] for surface in (ROUGH, fine))
    heights, spacing = realise(alone).sampled, 1e-7 / 256
    # The mean over the cell is zero; that of its points differs as these lie half a spacing aside.
    assert abs(heights.mean()) < 0.5 * np.ptp(heights) / 128
    slopes = np.gradient(heights, spacing)
    # So do root mean squares, by a share of 1/256 of edges.
    assert alone.scales.rms_height == pytest.approx(heights.std(), rel=0.01, abs=1e-15)
    assert alone.scales.rms_slope == pytest.approx(np.sqrt(np.mean(slopes[0] ** 2 + slopes[1] ** 2)), rel=0.01)
    assert case.scales.rms_height == pytest.approx(np.hypot(1e-9, alone.scales.rms_height), rel=1e-3)
    assert case.scales.rms_curvature == pytest.approx(
        make_study({"surface": ROUGH, **REST}).cases[0].scales.rms_curvature, rel=0.01
    )
    assert realise(case).roughness.rms_height == pytest.approx(rough.rms_height)


@pytest.mark.parametrize(
    ("form", "curvature"),
    [
        ({"kind": "sphere", "radius": 4e-7}, 1 / 4e-7),
        ({"kind": "cylinder", "radius": 4e-7}, 1 / 8e-7),
        ({"kind": "paraboloid", "radii": [4e-7, 2e-7]}, (1 / 4e-7 + 1 / 2e-7) / 2),
        ({"kind": "cone", "slope": 0.5, "tip_radius": "40 nm"}, 1 / 4e-8),
        ({"kind": "punch", "flat_radius": 2e-8, "edge_radius": 1e-7}, 1 / 2e-7),
    ],
)
def test_curvatures_of_forms_are_those_of_their_heights(form, curvature):
    surface = {"kind": "flat", "size": "100 nm", "shape": [1000, 1000]}
    (case,) = make_study({"surface": surface, "form": form, **REST}).cases
    heights, spacing = realise(case).sampled, 1e-10
    # Mean curvature beside the axis, or beyond the edge of the flat face.
    row, column = (500, 702) if form["kind"] == "punch" else (500, 500)
    near = heights[row - 1 : row + 2, column - 1 : column + 2]
    bend = near[0, 1] + near[2, 1] + near[1, 0] + near[1, 2] - 4 * near[1, 1]
    assert case.scales.rms_curvature == pytest.approx(curvature, rel=1e-12)
    assert -bend / spacing**2 / 2 == pytest.approx(curvature, rel=0.02)  # of the punch at a distance of 0.2 nm


def test_a_surface_alone_is_moved_and_rotated():
    for moved, shift in (({"offset": ["6.25 nm", 0]}, (2, 0)), ({"rotation": "180 deg"}, None)):
        found, own = composite_surface({**ROUGH, **moved}).sampled, composite_surface(ROUGH).sampled
        expected = np.roll(own, shift, (0, 1)) if shift else np.roll(own[::-1, ::-1], (1, 1), (0, 1))
        np.testing.assert_allclose(found, expected, atol=1e-22)  # rounding of 1e-9 m


def test_random_bodies_are_independent_and_an_ensemble_draws_both():
    many = {"rms_height": "1 nm", "roll_off_mode": 6, "cutoff_mode": 8}
    surface = {**ROUGH, **many}
    study = {"surface": surface, "counterface": {"kind": "self_affine", **many}, **REST}
    cases = make_study({**study, "detail": study["counterface"], "sweep": {"surface.seed": [1, 2, 3]}}).cases
    assert [case.counterface.seed for case in cases] == [1, 2, 3]
    parts = [part.sampled for case in cases for part in realise(case).parts]
    parts += [np.roll(part[:, ::-1], 1, axis=1) for part in parts]
    shares = np.corrcoef([part.ravel() for part in parts]) - np.eye(len(parts))
    # Two surfaces of some hundred waves correlate by 0.1 in the mean; those of equal draws by 1.
    assert np.abs(shares[:9]).max() < 0.5
    scales, alone = cases[0].scales, make_study({"surface": surface, **REST}).cases[0]
    assert scales.shortest_wave == pytest.approx(1e-7 / 8)
    assert scales.peak_to_valley == pytest.approx(3 * alone.scales.peak_to_valley)
    assert scales.rms_height == pytest.approx(np.sqrt(3) * 1e-9)
    assert scales.rms_slope == pytest.approx(np.sqrt(3) * alone.scales.rms_slope)
    # Waves in eighths of an octave, of the same height and slope; stress has the slope's weight.
    assert scales.spectrum.rms_slope == pytest.approx(scales.rms_slope, rel=1e-6)
    stress = alone.scales.full_contact_stress(alone.solid)
    assert scales.full_contact_stress(alone.solid) == pytest.approx(np.sqrt(3) * stress, rel=1e-3)


@pytest.mark.filterwarnings("ignore:surface. its shortest wave")
def test_atoms_start_from_gaps_of_the_same_counterface(tmp_path):
    study = {
        "surface": {"kind": "wavy", "size": "16 nm", "shape": [16, 16], "amplitude": "0.2 nm"},
        "counterface": {"kind": "wavy", "amplitude": "0.2 nm"},
        "material": {**REST["material"], "lattice_constant": "2 nm"},
        "interaction": {"law": "lennard_jones_10_4", "work_of_adhesion": 0.02, "length": "0.7 nm"},
        "loading": {"path": ["0.1 GPa"]},
        "output": {"fields": True},
        "sweep": {"counterface.amplitude": ["0.1 nm", "0.3 nm"]},
    }
    contact_study.run(study, output=tmp_path / "bem.nc")
    started = contact_study.run(study, "atomistic", predictor=tmp_path / "bem.nc")
    fields = started.predictor_field.values.ravel()
    assert len({*fields}) == 2
    assert "" not in fields
    with pytest.raises(InputError, match=r"is of another contact: form\.kind is none there and cone here"):
        contact_study.run(
            {**study, "form": {"kind": "cone", "slope": 0.01}}, "atomistic", predictor=tmp_path / "bem.nc"
        )


@pytest.mark.filterwarnings("ignore:surface. its shortest wave")
def test_theories_and_atoms_take_the_combined_heights(tmp_path):
    counter = {"kind": "wavy", "amplitude": "0.2 nm", "modes": [2, 2], "offset": ["3 nm", 0]}
    surface = {"kind": "wavy", "size": "16 nm", "shape": [32, 32], "amplitude": "0.2 nm"}
    two = {
        "surface": surface,
        "counterface": counter,
        **REST,
        "loading": {"path": ["0.1 GPa"]},
        "theory": {"flows": "none"},
    }
    two["interaction"] = {"law": "lennard_jones_10_4", "work_of_adhesion": 0.02, "length": "0.4 nm"}
    two["material"] = {**REST["material"], "lattice_constant": "1 nm"}
    y = x = np.arange(32) * 2 * np.pi / 32
    waves = 2e-10 * (np.cos(y[:, None]) * np.cos(x) + np.cos(2 * (y[:, None] - 3 * 2 * np.pi / 16)) * np.cos(2 * x))
    one = {**two, "surface": {"heights": waves, "size": "16 nm"}, "counterface": {}}
    for model, name in (("theory", "relative_contact_area"), ("atomistic", "mean_gap")):
        first, second = contact_study.run(one, model), contact_study.run(two, model)
        # The equilibria are those of heights that differ by rounding.
        np.testing.assert_allclose(second[name], first[name], rtol=1e-6)


def test_two_maps_are_recorded_checked_and_named(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    maps(tmp_path, (16, 16), (16, 16), (64, 64))
    study = {
        "surface": {"kind": "file", "path": "map0.npy", "size": "100 nm", "lowpass": "20 nm"},
        "counterface": {"kind": "file", "path": "map1.npy", "size": "100 nm", "lowpass": "20 nm"},
        **REST,
    }
    Path("study.toml").write_text(tomli_w.dumps(study))
    assert bem_adhesion(["run", "study.toml", "-o", "out.nc"]) == 0
    assert bem_adhesion(["run", "study.toml", "-o", "out.nc", "--resume"]) == 0
    np.save("map1.npy", 2 * np.load("map1.npy"))
    capsys.readouterr()
    assert bem_adhesion(["run", "study.toml", "-o", "out.nc", "--resume"]) == 1
    assert "the map map1.npy has changed" in capsys.readouterr().err
    more = [
        "--counterface.path",
        "map2.npy",
        "--counterface.lowpass",
        "5 nm",
        "--material.counter_youngs_modulus",
        "10 GPa",
    ]
    assert bem_adhesion(["check", "study.toml", *more, "--material.counter_poissons_ratio", "0.3"]) == 0
    said = capsys.readouterr().out
    assert "surface.shape = [16, 16] is coarser than the height map map2.npy" in said
    more += ["--form.kind", "cone", "--form.slope", "0.01"]
    assert bem_adhesion(["inspect", "study.toml", *more, "--material.counter_poissons_ratio", "0.3"]) == 0
    said = capsys.readouterr().out
    assert "kind file, form cone, counterface file" in said
    assert "E* = 5.49 GPa, combined of two elastic bodies" in said
    assert "spectrum of the roughness, without the form" in said
    np.save("map2.npy", np.full((16, 16), np.nan))
    assert bem_adhesion(["inspect", "study.toml", "--counterface.path", "map2.npy"]) == 1
    assert "counterface.path: map2.npy holds no finite numbers" in capsys.readouterr().err


WAVY = {"kind": "wavy", "amplitude": "1 nm"}
COUNTER = {"counter_youngs_modulus": "1 GPa", "counter_poissons_ratio": 0.3}


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"counterface": {**WAVY, "size": "30 nm"}}, r"counterface\.size: a period of 3e-08 m does not divide"),
        ({"detail": {**WAVY, "rotation": "45 deg"}}, r"detail\.rotation = 45 deg: .* quarter turns"),
        ({"counterface": {**WAVY, "shape": [32, 32]}}, r"counterface\.shape: the grid is that of surface\.shape"),
        ({"counterface": {**WAVY, "modes": [0, 0]}}, r"counterface\.modes = \[0, 0\]: make no wave"),
        ({"counterface": {"kind": "sphere", "radius": 1e-6, "offset": [1e-9, 0]}}, r"counterface\.kind: only a sum"),
        (
            {"counterface": {"kind": "self_affine", "rms_height": 1e-9, "size": "50 nm", "cutoff_mode": 8}},
            r"counterface\.cutoff_mode = 8: beyond what surface\.shape \(\[16, 16\] on its period\) can carry",
        ),
        ({"detail": {**WAVY, "modes": [40, 40]}}, r"detail\.modes = \[40, 40\]: .* surface\.shape \(\[32, 32\] on its"),
        ({"form": {"kind": "sphere", "radius": "60 nm"}}, r"form\.radius: the sphere ends within the cell"),
        ({"form": {"kind": "cone"}}, r'missing key form\.slope: kind = "cone" needs it'),
        ({"form": {"kind": "cone", "slope": -0.1}}, r"form\.slope = -0\.1: must be positive"),
        ({"form": {"kind": "plane", "radius": 1e-6}}, r'form\.radius: kind = "plane" has no such key'),
        ({"material": {**REST["material"], "counter_youngs_modulus": 1e9}}, "missing key material.counter_poissons"),
        (
            {"material": {**REST["material"], **COUNTER}, "elasticity": {"kind": "layer", "thickness": 1e-8}},
            r'counter_youngs_modulus: elasticity\.kind = "layer" has no combined modulus',
        ),
    ],
)
def test_what_makes_no_bodies_is_refused_in_one_line(changed, said):
    with pytest.raises(InputError, match=said):
        realise(make_study({"surface": ROUGH, **REST, **changed}).cases[0])


def test_theories_take_no_form_atoms_no_second_modulus_and_repeated_forms_no_jump():
    study = {"surface": ROUGH, "form": {"kind": "cone", "slope": 0.01}, **REST}
    with pytest.raises(InputError, match=r'form\.kind = "cone": the theories are of nominally flat'):
        models.check_study(models.MODELS["theory"], make_study(study))
    two = {**study, "form": {}, "material": {**REST["material"], **COUNTER}}
    adhesive = {"law": "lennard_jones_10_4", "work_of_adhesion": 0.02, "length": "0.4 nm"}
    with pytest.raises(InputError, match=r"material\.counter_youngs_modulus: atoms make one elastic body"):
        models.check_study(models.MODELS["atomistic"], make_study({**two, "interaction": adhesive}))
    assert not review(make_study(study))
    tilted = {**study, "form": {**study["form"], "tilt": [0, "1 deg"]}}
    (line,) = review(make_study(tilted))
    assert "heights of the cone jump by 1.746 nm across the edges" in line  # 100 nm · tan 1°
    assert not review(make_study({**tilted, "elasticity": {"boundary": "free"}}))


def test_the_study_of_the_documentation_is_one(tmp_path):
    page = (Path(__file__).parents[2] / "docs/howto_bodies.md").read_text(encoding="utf-8")
    (written,) = re.findall("```toml\n(.*?)```", page, re.DOTALL)
    np.save(tmp_path / "afm.npy", 1e-9 * np.random.default_rng(1).standard_normal((32, 32)))
    (case,) = make_study({**tomllib.loads(written), **REST}, tmp_path).cases
    parts = realise(case).parts
    assert len(parts) == 3
    np.testing.assert_allclose(parts[1].sampled[:64], parts[1].sampled[64:128], atol=1e-20)  # four periods
    assert parts[1].sampled.std() > 0.9e-9


@pytest.mark.parametrize(
    ("form", "words"),
    [
        ({"kind": "paraboloid", "radii": ["1 um", "2 um"]}, "paraboloid, radii 1 x 2 µm"),
        (
            {"kind": "punch", "flat_radius": "20 nm", "edge_radius": "3 nm"},
            "punch, flat radius 20 nm, edge radius 3 nm",
        ),
        ({"kind": "plane", "tilt": ["1 mrad", 0]}, "plane"),
    ],
)
def test_a_report_names_a_form_by_its_lengths(form, words):
    (case,) = make_study({"surface": ROUGH, "form": form, **REST}).cases
    assert case.form.words == words


@pytest.mark.filterwarnings("ignore:grid too coarse")
def test_a_paraboloid_is_the_sphere_of_the_surface_for_continuum_and_atoms():
    cell = {"size": "16 nm", "shape": [32, 32]}
    rest = {
        **REST,
        "material": {**REST["material"], "lattice_constant": "1 nm"},
        "interaction": {"law": "lennard_jones_10_4", "work_of_adhesion": 0.02, "length": "0.4 nm"},
    }
    one = {**rest, "surface": {"kind": "sphere", "radius": "40 nm", **cell}}
    two = {**rest, "surface": {"kind": "flat", **cell}, "form": {"kind": "paraboloid", "radii": "40 nm"}}
    first, second = (make_study(study).cases[0] for study in (one, two))
    np.testing.assert_allclose(realise(second).sampled, realise(first).sampled, atol=1e-14 * 16e-9)
    for name, error in (("rms_height", 1e-4), ("rms_slope", 0.006), ("rms_curvature", 1e-12), ("peak_to_valley", 0.01)):
        # Of midpoints, 256 to a side: (1/256)² of squares, 1/256 of the depth and of the slope's waves at the edges.
        assert getattr(second.scales, name) == pytest.approx(getattr(first.scales, name), rel=error)
    for model in ("continuum", "atomistic"):
        gaps = [contact_study.run(study, model).mean_gap.values for study in (one, two)]
        np.testing.assert_allclose(*gaps, rtol=1e-6)  # the residual that the solvers leave, 1e-8


def test_heights_that_cannot_be_name_the_keys_of_all_roughness_and_the_form():
    counterface = {"kind": "wavy", "amplitude": "1 mm"}
    study = make_study({"surface": ROUGH, **REST, "counterface": counterface, "form": {"kind": "sphere", "radius": 1}})
    with pytest.raises(
        InputError, match=r"\(surface\.rms_height, counterface\.amplitude, form\) and surface\.size can"
    ):
        review(study)


@pytest.mark.parametrize("law", ["hard_wall", "lennard_jones_9_3"])
@pytest.mark.parametrize("solid", [{}, {"kind": "layer", "thickness": "20 nm"}])
def test_a_repeated_form_moves_by_the_prescribed_approach_on_any_grid(law, solid):
    """The form's mean over the cell is zero, that of its 8 x 8 points is not: a tenth of its height on one point."""
    spring = {} if solid else {"machine_stiffness": "20 N/m"}
    study = {
        "surface": {"kind": "flat", "size": "100 nm", "shape": [8, 8]},
        "form": {"kind": "paraboloid", "radii": "500 nm"},
        "material": REST["material"],
        "elasticity": solid,
        "interaction": {"law": law, **({} if law == "hard_wall" else {"work_of_adhesion": 1e-3, "length": "1 nm"})},
        "loading": {"control": "approach", "path": ["0.5 nm", "1 nm"], **spring},
    }
    found = contact_study.run(study)
    assert found.total_force.values[-1] > 0
    moved = found.approach if spring else found.displacement
    np.testing.assert_allclose(moved, found.applied_approach, rtol=1e-5)  # the residual pressure on the spring
