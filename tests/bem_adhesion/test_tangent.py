"""Contact stiffness by the linearised problem: against differences of states and closed forms."""

import numpy as np
import pytest

import contact_study
from bem_adhesion import HalfSpace, HardWall, Layer, Repulsive, rough_contact
from tests.bem_adhesion.paper_system import E_STAR, study_table
from tests.bem_adhesion.rough_surfaces import self_affine
from tests.laws_of_all_kinds import EVERY_LAW

pytestmark = pytest.mark.filterwarnings("ignore:grid too coarse")


@pytest.mark.parametrize("solid", [HalfSpace(E_STAR), Layer(E_STAR, 0.3, 5e-9)], ids=["half-space", "layer"])
@pytest.mark.parametrize("law", EVERY_LAW.values(), ids=EVERY_LAW)
def test_it_is_the_derivative_of_the_path(law, solid):
    height, grid = self_affine(48)
    contact = rough_contact(height, grid.size, solid, law, tolerance=1e-11)
    middle = contact.step(contact.separated(), 2e9)
    found = contact.stiffness(middle)
    errors = []
    for share in (2e-4, 1e-4):
        lower, higher = (contact.step(middle.state, 2e9 * (1 + sign * share)) for sign in (-1, 1))
        slope = (higher.pressure.mean() - lower.pressure.mean()) / (lower.gap.mean() - higher.gap.mean())
        errors.append(abs(slope / found - 1))
    # Points that begin to touch, or to be attracted, within the difference; of smooth laws its square.
    assert min(errors) < (2e-3 if law.has_wall else 1e-3)


@pytest.mark.parametrize("name", ["lennard_jones_10_4", "exponential", "dugdale"])
def test_a_soft_state_is_not_lost_beside_the_spring_of_the_control(name):
    """The spring is as stiff as the shortest wave, 1e22 Pa/m; out of reach the law's tail is all that is left."""
    height, grid = self_affine(48)
    law = EVERY_LAW[name]
    contact = rough_contact(height, grid.size, E_STAR, law, "gap", tolerance=1e-11)
    state, step = contact.separated(), 1e-3 * law.length
    for gap in (2, 8, 16):
        found, nearer, farther = (contact.step(state, gap * law.length + shift) for shift in (0.0, -step, step))
        slope = (nearer.pressure.mean() - farther.pressure.mean()) / (2 * step)
        # Central differences; of the Dugdale law's edge and the wall's points that come or go within them, a share.
        assert contact.stiffness(found) == pytest.approx(slope, rel=3e-3, abs=1e6)
        state = found.state


@pytest.mark.parametrize(("name", "gap"), [("dugdale", 14), ("dugdale_core", 20), ("dugdale_core", 24)])
def test_where_next_to_nothing_is_left_of_the_law_it_is_its_mean_stiffness(name, gap):
    """Tensions of 1e-24 Pa and less, whose squares single precision does not know: nothing bends any more."""
    height, grid = self_affine(48)
    law = EVERY_LAW[name]
    contact = rough_contact(height, grid.size, E_STAR, law, "gap")
    found = contact.step(contact.separated(), gap * law.length)
    # Numbers of single precision near its end have three digits and fewer.
    assert contact.stiffness(found) == pytest.approx(float(law.stiffness(found.gap).mean()), rel=0.02, abs=0)


@pytest.mark.parametrize("control", ["pressure", "approach"])
def test_hertzs_sphere(control):
    """dF/dδ = 2E*a; the contact's points count whole, half a cell along the edge of 27 across."""
    size, radius, points = 0.3, 0.1, 128
    axis = (np.arange(points) - points / 2) * size / points
    height = -(axis[:, None] ** 2 + axis**2) / 2
    contact = rough_contact(height, size, 1.0, HardWall(), control, boundary="free")
    found = contact.step(contact.separated(), 4 * radius**3 / 3 / size**2 if control == "pressure" else radius**2)
    assert contact.stiffness(found) * size**2 == pytest.approx(2 * radius, rel=5e-3)
    assert contact.stiffness(contact.step(contact.separated(), 0.0)) == 0


def test_surfaces_apart_have_none_and_closed_ones_no_end():
    height, grid = self_affine(32)
    for law in (HardWall(), EVERY_LAW["exponential"], Repulsive(0.0, 3e-10, 0.1)):
        contact = rough_contact(height, grid.size, E_STAR, law)
        if law.has_wall and law.attracts:
            pressed = contact.step(contact.separated(), 1e9)
            apart = contact.step(pressed.state, -2e9)
            assert apart.detached
            assert contact.stiffness(apart) == 0
        elif law.has_wall:
            assert contact.stiffness(contact.step(contact.separated(), 0.0)) == 0
            assert contact.stiffness(contact.step(contact.separated(), 300e9)) == np.inf


def test_a_study_has_it_when_asked():
    table = study_table(64, size=500e-10, loading={"path": [1e9, 2e9]})
    assert "contact_stiffness" not in contact_study.run(table, "continuum")
    asked = contact_study.run({**table, "output": {"stiffness": True}}, "continuum")
    stiffness = asked.contact_stiffness.values
    gap = asked.mean_gap.values
    mean = 1e9 / (gap[0] - gap[1])
    assert stiffness[0] < mean < stiffness[1], "between the two states the chord's"
