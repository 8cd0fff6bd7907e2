"""Contact stiffness by the linearised problem: against differences of states and closed forms."""

import numpy as np
import pytest

from bem_adhesion import Layer, rough_contact
from tests.bem_adhesion.paper_system import E_STAR, self_affine, stepped
from tests.laws_of_all_kinds import EVERY_LAW

pytestmark = pytest.mark.filterwarnings("ignore:grid too coarse")


@pytest.mark.parametrize(
    ("solid", "law"),
    [(E_STAR, law) for law in EVERY_LAW.values()]
    + [(Layer(E_STAR, 0.3, 5e-9), EVERY_LAW[name]) for name in ("hard_wall", "morse", "exponential")],
)
def test_it_is_the_derivative_of_the_path(law, solid):
    height, grid = self_affine(48)
    contact = rough_contact(height, grid.size, solid, law, tolerance=1e-11)
    middle = contact.step(contact.separated(), 2e9)
    lower, higher = (contact.step(middle.state, 2e9 * (1 + change)) for change in (-1e-4, 1e-4))
    slope = (higher.pressure.mean() - lower.pressure.mean()) / (lower.gap.mean() - higher.gap.mean())
    # Points that begin to touch, or to be attracted, within the difference; of smooth laws its square.
    assert contact.stiffness(middle) == pytest.approx(slope, rel=2e-3 if law.has_wall else 1e-3)


@pytest.mark.parametrize("name", ["lennard_jones_10_4", "exponential", "dugdale"])
def test_a_soft_state_is_not_lost_beside_the_spring_of_the_control(name):
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
    height, grid = self_affine(48)
    law = EVERY_LAW[name]
    contact = rough_contact(height, grid.size, E_STAR, law, "gap")
    found = contact.step(contact.separated(), gap * law.length)
    # Numbers of single precision near its end have three digits and fewer.
    assert contact.stiffness(found) == pytest.approx(float(law.stiffness(found.gap).mean()), rel=0.02, abs=0)


def test_surfaces_apart_have_none_and_closed_ones_no_end():
    height, grid = self_affine(32)
    wall, sticky = (rough_contact(height, grid.size, E_STAR, EVERY_LAW[name]) for name in ("hard_wall", "exponential"))
    *_, apart = stepped(sticky, [1e9, -2e9])
    assert apart.detached
    assert sticky.stiffness(apart) == 0
    assert wall.stiffness(stepped(wall, [0.0])[0]) == 0
    assert wall.stiffness(stepped(wall, [300e9])[0]) == np.inf
