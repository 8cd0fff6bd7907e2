"""Kernels compute what the functions of a law say; steps end where the docstring says."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bem_adhesion.kernels import law as law_kernels
from bem_adhesion.kernels.law import LawKernels, WallKernels, kernels_of
from contact_study.physics.laws import Dugdale, Exponential
from tests.laws_of_all_kinds import EVERY_LAW

RANGE = 1.74e-10
SOFT = {name: law for name, law in EVERY_LAW.items() if name != "hard_wall"}
laws = pytest.mark.parametrize("law", [law for law in SOFT.values() if law.attracts and not law.has_wall])


@pytest.mark.parametrize("law", SOFT.values(), ids=SOFT)
@pytest.mark.parametrize("single", [np.float64, np.float32])
def test_fused_kernels_equal_the_separate_functions(law, single):
    gap = law.equilibrium_distance + law.length * np.linspace(-0.3 if not law.has_wall else 0, 3, 40).reshape(1, -1)
    traction, stiffness = np.empty_like(gap), np.empty(gap.shape, single)
    total = kernels_of(law).evaluate(gap, traction, stiffness)
    assert total == pytest.approx(law.potential(gap).sum(), rel=1e-12)
    np.testing.assert_allclose(traction, law.traction(gap), rtol=1e-11, atol=1e-13 * np.abs(traction).max())
    rounding = max(1e-9, 4 * np.finfo(single).eps) * np.abs(stiffness).max()
    np.testing.assert_allclose(stiffness, law.stiffness(gap), rtol=1e-6, atol=rounding)
    if not law.has_wall:
        # A repelled point moves in its traction: a step that relieves it ends where the law carries that.
        repelled = gap[law.traction(gap) < 0].reshape(1, -1)
        step = 1e-3 * (law.equilibrium_distance - repelled)
        LawKernels(law).advance(repelled, step, 0.4, out := np.empty_like(repelled))
        wanted = law.traction(repelled) + law.stiffness(repelled) * step
        np.testing.assert_allclose(law.traction(out), wanted, rtol=1e-9, atol=1e-9 * np.abs(wanted).max())


@laws
@given(start=st.floats(0.75, 4.0), step=st.floats(-3.0, 3.0))
def test_compiled_advance_equals_the_general_one(law, start, step):
    gap, move = np.full((1, 1), start * law.length), np.full((1, 1), step * law.length, np.float32)
    general, compiled = np.empty((1, 1)), np.empty((1, 1))
    LawKernels(law).advance(gap, move, 0.4, general)
    kernels_of(law).advance(gap, move, 0.4, compiled)
    # Three Newton iterations instead of convergence: 3 % at a thousand times the peak stress, less below.
    moved = abs((general - gap).item())
    assert abs((compiled - general).item()) <= 0.03 * moved + 1e-12 * law.length


@laws
def test_blocks_of_points_are_as_single_points(law, monkeypatch):
    """Of 26 points in rows of two, blocks of 10: the last one is shorter."""
    monkeypatch.setattr(law_kernels, "BLOCK", 10)
    rng, kernels = np.random.default_rng(1), LawKernels(law)
    gap = law.length * rng.uniform(0.8, 2.0, (13, 2))
    step = law.length * rng.uniform(-0.5, 0.5, gap.shape).astype(np.float32)
    traction, stiffness, out = (np.full(gap.shape, np.nan) for _ in range(3))
    total = kernels.evaluate(gap, traction, stiffness)
    kernels.advance(gap, step, 0.4, out)
    assert total == pytest.approx(sum(law.potential(each).item() for each in gap.reshape(-1, 1)), rel=1e-12)
    for at in np.ndindex(gap.shape):
        kernels.advance(gap[at].reshape(1, 1), step[at].reshape(1, 1), 0.4, one := np.empty((1, 1)))
        # Functions of single points and of vectors may round differently.
        assert out[at] == pytest.approx(one.item(), rel=1e-12)
        assert traction[at] == pytest.approx(law.traction(gap[at]), rel=1e-12, abs=1e-12 * law.peak_tensile_stress)
        assert stiffness[at] == pytest.approx(law.stiffness(gap[at]), rel=1e-9, abs=1e-9 * law.equilibrium_stiffness)


@laws
def test_advance_is_newtons_step_to_first_order(law):
    gap = (law.length * np.geomspace(0.7, 6.0, 41)).reshape(1, -1)
    # Not where a step crosses equilibrium: there the new gap follows the tangent of the other side.
    gap = gap[np.abs(gap - law.equilibrium_distance) > 0.01 * law.length].reshape(1, -1)
    out = np.empty_like(gap)

    def error(h):
        step = np.full(gap.shape, h * law.length)
        kernels_of(law).advance(gap, step, 0.4, out)
        return np.max(np.abs(out - gap - step))

    assert error(1e-4) / error(5e-5) > 3.9


def test_points_enter_a_repulsion_without_a_peak_on_its_tangent():
    """With no force there the descent would leave them at the onset of repulsion."""
    law = EVERY_LAW["repulsive"]
    gap, out = np.full((1, 1), 1.05 * law.length), np.empty((1, 1))
    LawKernels(law).advance(gap, np.full((1, 1), -0.1 * law.length), 0.4, out)
    assert law.traction(out).item() == pytest.approx(-0.05 * law.length * law.equilibrium_stiffness, rel=1e-9)


# What sums beside one round where a tension is the rest of it; differences of the default, over the largest stiffness.
@pytest.mark.parametrize(
    ("law", "rounding", "differences"),
    [(Exponential(0.69, RANGE), 1e-12, 0.0), (Dugdale(0.69, RANGE, 0.02), 1e-11, 1e-10)],
)
def test_kernels_outside_a_wall_equal_the_functions_of_the_law(law, rounding, differences):
    kernels = kernels_of(law)
    assert isinstance(kernels, WallKernels)
    # On the ramp, and to where an exponential is less than the smallest number.
    gap = RANGE * np.concatenate([[0.0], np.geomspace(1e-6, 30, 40), np.linspace(0.5, 1.5, 41), [800.0, 1e5]])
    one, two = (np.empty((2, 1, gap.size)) for _ in range(2))
    assert kernels.evaluate(gap[None], *one) == pytest.approx(LawKernels(law).evaluate(gap[None], *two), rel=1e-13)
    # The kernel lets no exponential fall below e⁻⁷⁰⁰ = 1e-304.
    least = 1e-303 * np.abs(two).max(axis=-1)
    np.testing.assert_allclose(one[0], two[0], rtol=rounding, atol=least[0].item())
    largest = np.abs(two[1]).max()
    np.testing.assert_allclose(one[1], two[1], rtol=1e-8, atol=max(differences * largest, least[1].item()))
