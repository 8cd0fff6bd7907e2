"""Kernels compute what the functions of a law say; steps end where the docstring says."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bem_adhesion.kernels import law as law_kernels
from bem_adhesion.kernels.law import LawKernels, WallKernels, blocks, kernels_of
from tests.laws_of_all_kinds import EVERY_LAW

SOFT = {name: law for name, law in EVERY_LAW.items() if name != "hard_wall"}
laws = pytest.mark.parametrize("law", [law for law in SOFT.values() if law.attracts and not law.has_wall])
# What sums beside one round where a tension is the rest of it; differences of the default, over the largest stiffness.
ROUNDING, DIFFERENCES = {"exponential": 1e-12, "dugdale": 1e-11}, {"exponential": 0.0, "dugdale": 1e-10}


@pytest.mark.parametrize("name", SOFT)
@pytest.mark.parametrize("single", [np.float64, np.float32])
def test_fused_kernels_equal_the_separate_functions(name, single, monkeypatch):
    monkeypatch.setattr(law_kernels, "BLOCK", 10)
    law = SOFT[name]
    kernels, gap = kernels_of(law), law.equilibrium_distance + law.length * np.linspace(-0.3, 3, 38).reshape(-1, 2)
    if law.has_wall:
        assert isinstance(kernels, WallKernels)
        gap = np.concatenate([[0.0], np.geomspace(1e-6, 30, 40), np.linspace(0.5, 1.5, 41), [800.0, 1e5]])
        gap = law.length * gap.reshape(-1, 2)
    traction, stiffness = np.full(gap.shape, np.nan), np.full(gap.shape, np.nan, single)
    total = kernels.evaluate(gap, traction, stiffness)
    assert total == pytest.approx(law.potential(gap).sum(), rel=1e-12)
    # The kernel lets no exponential fall below e⁻⁷⁰⁰ = 1e-304.
    least = 1e-303 if law.has_wall else 1e-13
    rounding = ROUNDING.get(name, 1e-11)
    np.testing.assert_allclose(traction, law.traction(gap), rtol=rounding, atol=least * np.abs(traction).max())
    differences = max(DIFFERENCES.get(name, 1e-9), 4 * np.finfo(single).eps if single is np.float32 else 0, least)
    largest = np.abs(stiffness).max()
    np.testing.assert_allclose(stiffness, law.stiffness(gap), rtol=1e-6, atol=differences * largest)
    if not law.has_wall:
        # A repelled point moves in its traction: a step that relieves it ends where the law carries that.
        repelled = gap[law.traction(gap) < 0].reshape(-1, 1)
        step = 1e-3 * (law.equilibrium_distance - repelled)
        LawKernels(law).advance(repelled, step, 0.4, out := np.empty_like(repelled))
        wanted = law.traction(repelled) + law.stiffness(repelled) * step
        np.testing.assert_allclose(law.traction(out), wanted, rtol=1e-9, atol=1e-9 * np.abs(wanted).max())


def test_a_block_has_whole_rows_and_no_more_than_one_of_very_long_ones(monkeypatch):
    monkeypatch.setattr(law_kernels, "BLOCK", 10)
    assert [[len(field[here]) for here in blocks(field)] for field in (np.empty((5, 4)), np.empty((2, 99)))] == [
        [2, 2, 1],
        [1, 1],
    ]


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


def test_points_enter_a_repulsion_without_a_peak_on_its_tangent():
    law = EVERY_LAW["repulsive"]
    gap, out = np.full((1, 1), 1.05 * law.length), np.empty((1, 1))
    LawKernels(law).advance(gap, np.full((1, 1), -0.1 * law.length), 0.4, out)
    assert law.traction(out).item() == pytest.approx(-0.05 * law.length * law.equilibrium_stiffness, rel=1e-9)
