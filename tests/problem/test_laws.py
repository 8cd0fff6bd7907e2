import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contact_study.problem.laws.base import TractionLaw
from contact_study.problem.laws.lennard_jones_9_3 import LennardJones93
from contact_study.problem.laws.lennard_jones_10_4 import LennardJones104, work_of_adhesion

R0 = 3.28e-10
LAWS = [LennardJones104(0.69, R0), LennardJones104(5.52, R0), LennardJones104(0.05, 2e-9), LennardJones93(0.69, R0)]
laws = pytest.mark.parametrize("law", LAWS, ids=lambda law: f"{type(law).__name__}-{law.work_of_adhesion}")


def gaps(law):
    return law.length * np.geomspace(0.7, 6.0, 41)


@laws
@pytest.mark.parametrize(("function", "derivative"), [("potential", "traction"), ("traction", "stiffness")])
def test_derivatives_are_those_of_the_potential_to_second_order(law, function, derivative):
    gap = gaps(law)
    f, df = getattr(law, function), getattr(law, derivative)

    def error(h):
        return np.max(np.abs((f(gap + h) - f(gap - h)) / (2 * h) - df(gap))) / np.max(np.abs(df(gap)))

    coarse, fine = error(1e-3 * law.length), error(5e-4 * law.length)
    # Central differences: halving h divides the error by four.
    assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.02)


@laws
def test_characteristic_points(law):
    gap = law.length * np.linspace(0.9, 3.0, 200001)
    at = np.array(law.equilibrium_distance)
    assert abs(law.traction(at)) < 1e-12 * law.peak_tensile_stress
    assert law.potential(at) == pytest.approx(-law.work_of_adhesion, rel=1e-13)
    assert law.stiffness(at) == pytest.approx(law.equilibrium_stiffness, rel=1e-13)
    # The maxima of sampled smooth functions are low by the curvature times the square of the spacing, 1e-5.
    assert law.traction(gap).max() == pytest.approx(law.peak_tensile_stress, rel=1e-8)
    assert gap[np.argmax(law.traction(gap))] == pytest.approx(law.peak_distance, rel=1e-5)
    assert -law.stiffness(gap).min() == pytest.approx(law.strongest_softening, rel=1e-8)


def test_maugis_parameter_of_the_two_laws():
    # λ = 2 σ0 (9R/16πwE*²)^(1/3) in units of Tabor's μ: the factors for each law's peak stress.
    for law, factor in ((LennardJones93(1.0, 1.0), 1.1570), (LennardJones104(1.0, 1.0), 2.125)):
        assert 2 * law.peak_tensile_stress * (9 / (16 * np.pi)) ** (1 / 3) == pytest.approx(factor, rel=3e-4)


def test_values_of_the_paper():
    law = LennardJones104(0.69, R0)
    assert law.peak_tensile_stress == pytest.approx(1.8850 * 0.69 / R0, rel=1e-4)
    assert law.peak_distance == pytest.approx(3.741e-10, rel=1e-4)
    assert law.equilibrium_stiffness == pytest.approx(40 * 0.69 / R0**2, rel=1e-12)
    assert law.strongest_softening == pytest.approx(3.788 * 0.69 / R0**2, rel=1e-4)
    block, substrate = 1 / 2.6e-10**2, (647 / 1040e-10) ** 2
    # The sum over discrete atoms gives 0.6924; smearing them costs 0.06 %.
    assert work_of_adhesion(18.6e-3 * 1.602176634e-19, R0, block, substrate) == pytest.approx(0.6924, rel=1e-3)


@laws
def test_repulsive_gap_inverts_the_traction(law):
    traction = -law.peak_tensile_stress * np.concatenate([[0.0], np.geomspace(1e-12, 1e6, 60)])
    gap = law.repulsive_gap(traction)
    assert np.all(gap <= law.equilibrium_distance * (1 + 1e-15))
    # Near equilibrium the traction of a rounded gap is uncertain by eps times gap times stiffness.
    floor = 4 * np.finfo(float).eps * law.equilibrium_stiffness * law.equilibrium_distance
    np.testing.assert_allclose(law.traction(gap), traction, rtol=1e-12, atol=floor)


@laws
@pytest.mark.parametrize("single", [np.float64, np.float32])
def test_fused_pass_equals_the_separate_functions(law, single):
    gap = gaps(law).reshape(1, -1)
    traction, stiffness = np.empty_like(gap), np.empty(gap.shape, single)
    total = law.evaluate(gap, traction, stiffness)
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
    TractionLaw.advance(law, gap, move, 0.4, general)
    law.advance(gap, move, 0.4, compiled)
    # Three Newton iterations instead of convergence: 3 % at a thousand times the peak stress, less below.
    moved = abs((general - gap).item())
    assert abs((compiled - general).item()) <= 0.03 * moved + 1e-12 * law.length


@laws
def test_advance_is_newtons_step_to_first_order(law):
    gap = gaps(law).reshape(1, -1)
    # Not where a step crosses equilibrium: there the new gap follows the tangent of the other side.
    gap = gap[np.abs(gap - law.equilibrium_distance) > 0.01 * law.length].reshape(1, -1)
    out = np.empty_like(gap)

    def error(h):
        step = np.full(gap.shape, h * law.length)
        law.advance(gap, step, 0.4, out)
        return np.max(np.abs(out - gap - step))

    assert error(1e-4) / error(5e-5) > 3.9


@laws
def test_scaling_changes_units_only(law):
    length, stress = 3e-10, 9e10
    scaled = law.scaled(length, stress)
    gap = gaps(law)
    np.testing.assert_allclose(scaled.traction(gap / length) * stress, law.traction(gap), rtol=1e-11, atol=1e-3)
    np.testing.assert_allclose(scaled.potential(gap / length) * stress * length, law.potential(gap), rtol=1e-12)
