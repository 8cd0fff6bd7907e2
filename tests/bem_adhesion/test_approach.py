"""A prescribed approach of a solid that a uniform pressure moves: the same states as under pressure, and more."""

import numpy as np
import pytest

from bem_adhesion import HardWall, Layer, rough_contact
from bem_adhesion.hard_wall.contact import HardWallContact
from contact_study.study.bins import bins_of
from contact_study.study.study import make_study
from tests.bem_adhesion.paper_system import E_STAR, R0, SIZE
from tests.bem_adhesion.rough_surfaces import self_affine
from tests.bem_adhesion.test_studies import on_layer
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


@pytest.mark.parametrize("pressed", [1e-6, 20.0, 3e4])
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


def test_the_pressures_of_a_deep_approach_fit_the_bins():
    study = make_study(on_layer(loading={"path": ["40 nm"], "control": "approach"}, interaction={"law": "hard_wall"}))
    (case,) = study.cases
    highest = bins_of(study).pressure_edges[-1]
    assert 40e-9 / case.solid.mean_compliance < highest < 2 * 40e-9 / case.solid.mean_compliance
    hard = make_study(
        on_layer(
            loading={"path": ["40 nm"], "control": "approach"},
            interaction={"law": "hard_wall"},
            material={"poissons_ratio": 0.3, "hardness": "4 GPa"},
        )
    )
    assert 4e9 < bins_of(hard).pressure_edges[-1] < 0.2 * highest
