"""Compiled passes do what the functions of the law say; steps land where the docstring says."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bem_adhesion.kernels import law as law_passes
from bem_adhesion.kernels.law import LawKernels
from bem_adhesion.kernels.local_energy import kernels_of
from tests.study.test_laws import gaps, laws


@laws
@pytest.mark.parametrize("single", [np.float64, np.float32])
def test_fused_pass_equals_the_separate_functions(law, single):
    gap = gaps(law).reshape(1, -1)
    traction, stiffness = np.empty_like(gap), np.empty(gap.shape, single)
    total = kernels_of(law).evaluate(gap, traction, stiffness)
    assert total == pytest.approx(law.potential(gap).sum(), rel=1e-13)
    np.testing.assert_allclose(traction, law.traction(gap), rtol=1e-11, atol=1e-14 * law.peak_tensile_stress)
    np.testing.assert_allclose(
        stiffness, law.stiffness(gap), rtol=1e-6, atol=4 * np.finfo(single).eps * law.equilibrium_stiffness
    )


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
    monkeypatch.setattr(law_passes, "BLOCK", 10)
    rng, passes = np.random.default_rng(1), LawKernels(law)
    gap = law.length * rng.uniform(0.8, 2.0, (13, 2))
    step = law.length * rng.uniform(-0.5, 0.5, gap.shape).astype(np.float32)
    traction, stiffness, out = (np.full(gap.shape, np.nan) for _ in range(3))
    total = passes.evaluate(gap, traction, stiffness)
    passes.advance(gap, step, 0.4, out)
    assert total == pytest.approx(sum(law.potential(each).item() for each in gap.reshape(-1, 1)), rel=1e-12)
    for at in np.ndindex(gap.shape):
        one = np.empty((1, 1))
        passes.advance(gap[at].reshape(1, 1), step[at].reshape(1, 1), 0.4, one)
        # Functions of single points and of vectors may round differently.
        assert out[at] == pytest.approx(one.item(), rel=1e-12)
        assert traction[at] == pytest.approx(law.traction(gap[at]), rel=1e-12, abs=1e-12 * law.peak_tensile_stress)
        assert stiffness[at] == pytest.approx(law.stiffness(gap[at]), rel=1e-9, abs=1e-9 * law.equilibrium_stiffness)


@laws
def test_advance_is_newtons_step_to_first_order(law):
    gap = gaps(law).reshape(1, -1)
    # Not where a step crosses equilibrium: there the new gap follows the tangent of the other side.
    gap = gap[np.abs(gap - law.equilibrium_distance) > 0.01 * law.length].reshape(1, -1)
    out = np.empty_like(gap)

    def error(h):
        step = np.full(gap.shape, h * law.length)
        kernels_of(law).advance(gap, step, 0.4, out)
        return np.max(np.abs(out - gap - step))

    assert error(1e-4) / error(5e-5) > 3.9
