"""A prescribed approach of a solid that a uniform pressure moves: the same states as under pressure, and more."""

import numpy as np
import pytest
from scipy.optimize import brentq

import contact_study
from bem_adhesion import HardWall, Layer, LennardJones104, rough_contact
from bem_adhesion.hard_wall.contact import HardWallContact
from contact_study.numerics.grid import Grid
from contact_study.study.bins import bins_of
from contact_study.study.study import make_study
from tests.bem_adhesion.paper_system import E_STAR, R0, SIZE, study_table
from tests.bem_adhesion.rough_surfaces import self_affine
from tests.laws_of_all_kinds import EVERY_LAW

pytestmark = pytest.mark.filterwarnings("ignore:grid too coarse")

LAWS = {
    "hard_wall": HardWall(),
    **{name: EVERY_LAW[name] for name in ("exponential", "lennard_jones_10_4", "repulsive")},
}
# A thick layer, one that is next to a bed of springs, one whose uniform compression is the stiffest of all.
LAYERS = {"thick": (0.3, 0.5), "springs": (0.0, 0.01), "stiff": (0.499, 0.1)}


def approach_of(found, height, law, layer):
    """Of the undeformed surface beyond its first touch, from gap and pressure."""
    surface = float(np.mean(height + found.gap))
    return height.max() + law.equilibrium_distance - (surface - layer.mean_compliance * float(found.pressure.mean()))


@pytest.mark.parametrize("layer", LAYERS.values(), ids=LAYERS)
@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_both_controls_have_the_same_states(law, layer):
    """And the mean obeys 1/c as the waves do K: one balance of all wavevectors, by NumPy's transform."""
    ratio, thickness = layer
    height, grid = self_affine(32, 8)
    layer = Layer(E_STAR, ratio, thickness * SIZE)
    stiffness_q = layer.stiffness_on(grid)
    stiffness_q[0, 0] = 1 / layer.mean_compliance
    by_pressure, by_approach = (
        rough_contact(height, SIZE, layer, law, control) for control in ("pressure", "approach")
    )
    state = by_pressure.separated()
    for pressure in (1e8, 2e9, 3e10):
        pressed = by_pressure.step(state, pressure)
        state = pressed.state
        target = approach_of(pressed, height, law, layer)
        held = by_approach.step(pressed.state, target)
        fresh = by_approach.step(by_approach.separated(), target)
        for found in (held, fresh):
            assert found.converged
            assert approach_of(found, height, law, layer) == pytest.approx(target, abs=1e-8 * R0)
            plane = height.max() + law.equilibrium_distance - target
            elastic = np.fft.irfft2(stiffness_q * np.fft.rfft2(height + found.gap - plane), grid.shape)
            # The solver's 1e-8 E*; of a wall 1e-10 of the rms height, by the stiffest wave 7e-10 E*.
            np.testing.assert_allclose(elastic, found.pressure, atol=2e-8 * E_STAR, rtol=0)
            work = 0.5 * np.mean(elastic * (height + found.gap - plane))
            assert found.elastic_energy == pytest.approx(work, rel=1e-5)
        # From the state itself: the stress that the tolerance leaves over the pressure.
        assert held.pressure.mean() == pytest.approx(pressure, rel=1e-6, abs=2e-8 * E_STAR)
        np.testing.assert_allclose(held.gap, pressed.gap, atol=1e-5 * R0)
        back = by_pressure.step(fresh.state, float(fresh.pressure.mean()))
        assert approach_of(back, height, law, layer) == pytest.approx(target, abs=1e-5 * R0)


@pytest.mark.parametrize("pressed", [1e-6, 0.3, 20.0, 3e4])
def test_a_hard_wall_under_flat_and_far_pressed_surfaces(pressed):
    """Flat ones carry δ/c; of rough ones the same from where they are in full contact on, less their height."""
    layer = Layer(E_STAR, 0.2, 0.02 * SIZE)
    flat = rough_contact(np.full((8, 8), 3e-9), SIZE, layer, HardWall(), "approach")
    found = flat.step(flat.separated(), pressed * 1e-9)
    assert found.converged
    np.testing.assert_allclose(found.pressure, pressed * 1e-9 / layer.mean_compliance, rtol=1e-9)
    height, _ = self_affine(32, 8)
    rough = rough_contact(height, SIZE, layer, HardWall(), "approach")
    found = rough.step(rough.separated(), pressed * 1e-9)
    assert found.converged
    assert approach_of(found, height, HardWall(), layer) == pytest.approx(pressed * 1e-9, rel=1e-9)
    closed = pressed >= 20
    assert np.all(found.pressure > 0) == closed
    if closed:
        expected = (pressed * 1e-9 - height.max() + height.mean()) / layer.mean_compliance
        assert found.pressure.mean() == pytest.approx(expected, rel=1e-12)
    # Nothing that the approach does not pay for: no point is pressed further than the base has come.
    assert found.pressure.mean() <= pressed * 1e-9 / layer.mean_compliance


@pytest.mark.parametrize(("control", "target"), [("gap", 1e-9), ("approach", 2e-9)])
def test_the_work_of_all_solves_is_counted(control, target):
    height, grid = self_affine(32, 8)
    contact = HardWallContact(height, grid, Layer(E_STAR, 0.2, 0.02 * SIZE), control)
    found = contact.step(contact.separated(), target)
    assert found.converged
    assert found.fft_pairs == pytest.approx(contact._level.equivalent_pairs(grid), rel=1e-12)
    pressed = HardWallContact(height, grid, contact.elasticity)
    once = pressed.step(pressed.separated(), float(found.pressure.mean()))
    assert found.fft_pairs > 2 * once.fft_pairs, "several solves"


def test_before_first_touch_nothing_deforms():
    height, _ = self_affine(32, 8)
    layer = Layer(E_STAR, 0.2, 0.02 * SIZE)
    wall = rough_contact(height, SIZE, layer, HardWall(), "approach")
    for target in (0.0, -2e-9):
        found = wall.step(wall.separated(), target)
        assert found.converged
        assert not found.detached
        assert not found.pressure.any()
        np.testing.assert_allclose(found.gap, height.max() - height - target, atol=1e-24)
    law = EVERY_LAW["exponential"]
    contact = rough_contact(height, SIZE, layer, law, "approach")
    pressed = contact.step(contact.separated(), 1e-9)
    apart = contact.step(pressed.state, -60 * law.length)
    # e^−60 of the tension is left.
    np.testing.assert_allclose(apart.gap, height.max() - height + 60 * law.length, rtol=1e-6)


def test_flat_surfaces_are_held_where_no_tension_holds_them():
    """p = −σ(d), d = −δ + d_eq + c p: beyond the law's peak stable as long as the layer is the stiffer spring."""
    law = LennardJones104(0.69, R0)
    layer = Layer(E_STAR, 0.2, 0.02 * SIZE)
    spring = 1 / layer.mean_compliance
    assert spring > law.strongest_softening
    contact = rough_contact(np.zeros((8, 8)), SIZE, layer, law, "approach")
    state = contact.separated()
    for distance in (1.1, 1.4, 2.0):
        plane = law.equilibrium_distance + (distance - 1) * R0
        found = contact.step(state, law.equilibrium_distance - plane)
        state = found.state
        expected = brentq(
            lambda gap, plane=plane: spring * (gap - plane) + law.traction(np.array(gap)), R0 / 2, 4 * R0, xtol=1e-20
        )
        assert found.converged
        # The stress of the tolerance over the softest of both springs together.
        np.testing.assert_allclose(found.gap, expected, atol=1e-6 * R0)
    assert found.gap[0, 0] > law.peak_distance
    by_pressure = rough_contact(np.zeros((8, 8)), SIZE, layer, law)
    assert by_pressure.step(state, float(found.pressure.mean())).gap.mean() != pytest.approx(expected, rel=1e-2)


def test_a_sphere_on_a_bed_of_springs():
    """Approach a²/2R; a thickness of 0.04 contact radii is off by its share along the edge."""
    points, size, radius, contact_radius = 128, 1.0, 100.0, 0.25
    axis = Grid((points, points), (size, size)).coordinates[0] - size / 2
    height = -(axis[:, None] ** 2 + axis**2) / (2 * radius)
    layer = Layer(1.0, 0.2, 0.01)
    contact = rough_contact(height, size, layer, HardWall(), "approach")
    found = contact.step(contact.separated(), contact_radius**2 / (2 * radius))
    assert found.converged
    # Second order in thickness over radius, 0.0016.
    peak = contact_radius**2 / (2 * radius * layer.mean_compliance)
    assert found.pressure.max() == pytest.approx(peak, rel=2e-3)
    force = np.pi * contact_radius**4 / (4 * radius * layer.mean_compliance)
    # First order: the edge is a thickness wide.
    assert found.pressure.mean() * size**2 == pytest.approx(force, rel=0.04)


def table(**sections):
    keys = {
        "material": {"poissons_ratio": 0.3},
        "elasticity": {"kind": "layer", "thickness": "2 nm"},
        "loading": {"path": ["-3 nm", "1.2 nm", "0.2 nm", "0.1 nm"], "control": "approach"},
    }
    return study_table(32, size=200e-10, **{**keys, "surface": {"rms_height": 2e-10}, **sections})


def test_own_steps_keep_the_books():
    """−∫p d(mean separation) is stored or dissipated, down to the jump and back."""
    loading = {"path": ["-2 nm", "2 nm", "-2 nm"], "control": "approach", "adaptive": True}
    found = contact_study.run(table(loading=loading), "continuum").isel(case=0, missing_dims="ignore")
    assert np.all(found.converged == 1)
    assert found.dissipated_energy.values[-1] >= 0
    total = (found.elastic_energy + found.interaction_energy).values
    passed = [
        np.stack([found[f"passed_{name}"].values[step] for name in ("pressure", "separation")]) for step in (1, 2)
    ]
    pressure, separation = np.concatenate([part[:, np.isfinite(part[0])] for part in passed], axis=1)
    work = -np.trapezoid(pressure, separation)
    booked = total[-1] - total[0] + found.dissipated_energy.values[-1] - found.dissipated_energy.values[0]
    exchanged = np.sum(0.5 * np.abs((pressure[1:] + pressure[:-1]) * np.diff(separation)))
    # 2 % of each step's exchange is what is not looked at as a jump.
    assert work == pytest.approx(booked, abs=0.02 * exchanged)


def test_the_pressures_of_a_deep_approach_fit_the_bins():
    study = make_study(table(loading={"path": ["40 nm"], "control": "approach"}, interaction={"law": "hard_wall"}))
    (case,) = study.cases
    highest = bins_of(study).pressure_edges[-1]
    assert 40e-9 / case.solid.mean_compliance < highest < 2 * 40e-9 / case.solid.mean_compliance
    hard = make_study(
        table(
            loading={"path": ["40 nm"], "control": "approach"},
            interaction={"law": "hard_wall"},
            material={"poissons_ratio": 0.3, "hardness": "4 GPa"},
        )
    )
    assert 4e9 < bins_of(hard).pressure_edges[-1] < 0.2 * highest
