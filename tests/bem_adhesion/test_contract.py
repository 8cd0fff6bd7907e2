"""What every contact promises, whatever its law, solid, control and boundary.

Equilibrium by code that no solver uses, restart, symmetry, units, the energy balance, all controls, limits.
"""

import re
import warnings
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import contact_study
from bem_adhesion import (
    Exponential,
    HalfSpace,
    HardWall,
    Layer,
    LennardJones104,
    Outcome,
    Repulsive,
    Viscoelastic,
    ViscoelasticContact,
    rough_contact,
)
from bem_adhesion.study.interface import separation_of
from contact_study.inputs.units import quantity
from tests.bem_adhesion.paper_system import (
    E_STAR,
    R0,
    SIZE,
    approach_of,
    law,
    random_heights,
    self_affine,
    stepped,
    study_table,
)
from tests.laws_of_all_kinds import EVERY_LAW, KEYS

pytestmark = pytest.mark.filterwarnings("ignore:grid too coarse")

HEIGHT, GRID = self_affine(64)
SMALL = HEIGHT[::2, ::2] - HEIGHT[::2, ::2].mean()
HALF_SPACE = HalfSpace(E_STAR)
LAYERS = {f"layer {ratio} {share}": Layer(E_STAR, ratio, share * SIZE) for ratio, share in ((0.3, 1), (0.5, 0.01))}
LOADS = {"pressure": (0.2e9, 2e9, 20e9, 1e9), "gap": (6e-10, 2e-10, 0.3e-10, 4e-10)}


def of_one_second(height, size, solid, the_law):
    """A viscoelastic contact whose steps all take one second."""
    contact = ViscoelasticContact(height, size, solid, the_law)
    return SimpleNamespace(separated=contact.separated, step=lambda *given: contact.step(*given, 1.0)[0])


KINDS = {
    "wall": (HardWall(), {}),
    "plastic": (HardWall(), {"hardness": 5e9}),
    "free wall": (HardWall(), {"boundary": "free"}),
    "adhesive": (law(), {}),
    "outside a wall": (EVERY_LAW["exponential"], {}),
    "free": (law(), {"boundary": "free"}),
    "varied": (law(), {"work_of_adhesion": 0.69 * np.linspace(0.8, 1.2, SMALL.size).reshape(SMALL.shape)}),
    "yielding": (law(), {"hardness": 8e9}),
    "yielding outside a wall": (EVERY_LAW["exponential"], {"hardness": 8e9}),
    "viscoelastic": (law(), None),
}
every_kind = pytest.mark.parametrize("kind", KINDS)
every_elastic_kind = pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "viscoelastic"])


def contact_of(kind, height=SMALL, solid=E_STAR, **options):
    the_law, own = KINDS[kind]
    if own is None:
        return of_one_second(height, SIZE, Viscoelastic(E_STAR, (1e10,), (1.0,)), the_law)
    return rough_contact(height, SIZE, solid, the_law, **own, **options)


def elastic_pressure(solid, grid, displacement, mean_stiffness=0.0):
    """K u by NumPy's transform, without its mean (Pa)."""
    stiffness_q = solid.stiffness_on(grid)
    stiffness_q[0, 0] = mean_stiffness
    return np.fft.irfft2(stiffness_q * np.fft.rfft2(displacement), grid.shape)


def assert_equilibrium(found, height, grid, solid, the_law):
    """Balance, law or wall, and energies, from the fields of a solution alone."""
    assert found.converged, found.message
    assert found.residual <= 1e-8
    np.testing.assert_allclose(found.displacement, height + found.gap, atol=1e-14 * np.abs(height).max())
    elastic = elastic_pressure(solid, grid, found.displacement)
    # The solver's tolerance, 1e-8 E*, and the rounding of the transform.
    np.testing.assert_allclose(elastic + found.pressure.mean(), found.pressure, atol=2.1e-8 * E_STAR)
    touching = found.gap == 0 if the_law.has_wall else np.zeros(grid.shape, bool)
    reaction = found.pressure + (the_law.traction(found.gap) if the_law.attracts or not the_law.has_wall else 0.0)
    assert found.gap.min() >= 0 or not the_law.has_wall
    np.testing.assert_allclose(reaction[~touching], 0, atol=1e-12 * E_STAR)
    if touching.any():
        assert reaction[touching].min() > -1e-8 * E_STAR
        if the_law.attracts:
            pull = max(0, -reaction[touching].min() / E_STAR)
            assert found.complementarity_residual == pytest.approx(pull, abs=1e-14)
    energy = 0.5 * np.mean(elastic * found.displacement) + solid.compression_energy(found.pressure.mean())
    assert found.elastic_energy == pytest.approx(energy, rel=1e-5)
    if the_law.attracts or not the_law.has_wall:
        assert found.interaction_energy == pytest.approx(the_law.potential(found.gap).mean(), rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("control", LOADS)
@pytest.mark.parametrize(
    ("solid", "the_law"),
    [pytest.param(HALF_SPACE, one, id=name) for name, one in EVERY_LAW.items()]
    + [pytest.param(HALF_SPACE, law(8.0), id="eight times the depth")]
    + [pytest.param(HALF_SPACE, Exponential(work, 1.74e-10), id=f"{work} J/m²") for work in (0.1, 2.76)]
    + [pytest.param(solid, law(4.0), id=name) for name, solid in LAYERS.items()]
    + [pytest.param(solid, HardWall(), id=f"wall on {name}") for name, solid in LAYERS.items()],
)  # fmt: skip
def test_states_are_in_equilibrium(the_law, solid, control):
    tolerance = 1e-11 if the_law == HardWall() else None
    contact = rough_contact(HEIGHT, GRID.size, solid, the_law, control, tolerance=tolerance)
    for load, found in zip(LOADS[control], stepped(contact, LOADS[control]), strict=True):
        assert_equilibrium(found, HEIGHT, GRID, solid, the_law)
        met = found.pressure.mean() if control == "pressure" else found.mean_gap
        # 1e-8 of the modulus, or of the law's length.
        unit = E_STAR if control == "pressure" else getattr(the_law, "length", None) or HEIGHT.std()
        assert met == pytest.approx(load, abs=1e-8 * unit, rel=1e-9)


@pytest.mark.parametrize("name", EVERY_LAW)
def test_states_are_minima(name):
    """No small displacement that a wall allows lowers the energy, rough or smooth."""
    the_law, rng = EVERY_LAW[name], np.random.default_rng(0)
    (found,) = stepped(rough_contact(HEIGHT, GRID.size, E_STAR, the_law), [2e9])

    def energy(gap):
        elastic = elastic_pressure(HALF_SPACE, GRID, HEIGHT + gap)
        interaction = 0.0 if the_law == HardWall() else the_law.potential(gap).mean()
        return 0.5 * np.mean((HEIGHT + gap) * elastic) + interaction + 2e9 * gap.mean()

    lowest, scale = energy(found.gap), getattr(the_law, "length", 0) or HEIGHT.std()
    squared = np.fft.fftfreq(64)[:, None] ** 2 + np.fft.fftfreq(64)[None, :] ** 2
    for width in (0, 2, 8):
        taper = np.exp(-0.5 * squared * (2 * np.pi * width) ** 2)
        for size in (1e-3, 1e-2):
            change = np.fft.ifft2(taper * np.fft.fft2(rng.standard_normal(GRID.shape))).real
            moved = found.gap + size * scale * change / np.abs(change).max()
            assert energy(np.maximum(moved, 0) if the_law.has_wall else moved) > lowest


@every_kind
def test_a_step_follows_from_state_and_target_alone(kind):
    height = SMALL.copy()
    contact = contact_of(kind, height)
    first, second = stepped(contact, [1e9, 2e9])
    assert second.pressure.mean() == pytest.approx(2e9, rel=1e-6)
    assert np.count_nonzero(second.pressure > 0) > np.count_nonzero(first.pressure > 0) > 0
    gap = first.gap.copy()
    height *= 1.5
    for field in (first.displacement, first.pressure, first.gap):
        if field.flags.writeable:
            np.multiply(field, 1e9, out=field)
    with pytest.raises(ValueError, match="read-only"):
        first.state[...] = 0
    for again in (contact.step(first, 2e9), contact_of(kind).step(first.state.copy(), 2e9)):
        np.testing.assert_array_equal(again.gap, second.gap)
        np.testing.assert_array_equal(again.pressure, second.pressure)
    np.testing.assert_array_equal(stepped(contact, [1e9])[0].gap, gap)


def solved(the_law, height, size=(150e-10, 180e-10), modulus=E_STAR, pressure=2e9):
    return stepped(rough_contact(height, size, modulus, the_law), [pressure])[0]


SYMMETRIC = {"wall": HardWall(), "weak": law(1.0), "strong": law(8.0), "outside a wall": EVERY_LAW["exponential"]}


@pytest.mark.parametrize("the_law", SYMMETRIC.values(), ids=SYMMETRIC)
@settings(max_examples=3)
@given(
    shift=st.tuples(st.integers(0, 19), st.integers(0, 23)),
    length=st.floats(1e-3, 1e6),
    stress=st.floats(1e-6, 1e3),
    offset=st.floats(-1e-8, 1e-8),
)
def test_translation_mirror_rotation_offset_and_units_change_nothing_else(the_law, shift, length, stress, offset):
    y, x, size = np.arange(20) * 2 * np.pi / 20, np.arange(24) * 2 * np.pi / 24, (150e-10, 180e-10)
    height = 4e-10 * (np.cos(y)[:, None] + np.cos(2 * x + 1)[None, :] * np.sin(y + 0.5)[:, None])
    expected = solved(the_law, height)
    changes = {"length": the_law.length * length, "work_of_adhesion": the_law.work_of_adhesion * length * stress}
    other_law = replace(the_law, **changes) if the_law != HardWall() else the_law
    units = (tuple(length * side for side in size), E_STAR * stress, 2e9 * stress)
    cases = [
        (solved(the_law, np.roll(height, shift, (0, 1))), lambda f: np.roll(f, shift, (0, 1)), 1.0, 1.0),
        (solved(the_law, height[::-1].copy()), lambda f: f[::-1], 1.0, 1.0),
        (solved(the_law, np.rot90(height).copy(), size[::-1]), np.rot90, 1.0, 1.0),
        (solved(the_law, height + offset), lambda f: f, 1.0, 1.0),
        (solved(other_law, height * length, *units), lambda f: f, length, stress),
    ]
    for found, moved, unit, stresses in cases:
        # The state is determined to 1e-8 E* over the softest stiffness, about 1e-3 E*/r0.
        np.testing.assert_allclose(found.gap / unit, moved(expected.gap), atol=1e-4 * R0)
        close = 1e-7 * expected.pressure.max() if the_law == HardWall() else 1e-5 * E_STAR
        np.testing.assert_allclose(found.pressure / stresses, moved(expected.pressure), atol=close)
        np.testing.assert_array_equal(found.gap == 0, moved(expected.gap == 0))
    assert found.iterations == expected.iterations, "units change no number of iterations"


@pytest.mark.parametrize(
    ("kind", "solid"),
    [(kind, HALF_SPACE) for kind in KINDS if kind != "viscoelastic"]
    + [("adhesive", Layer(E_STAR, 0.3, 0.2 * SIZE)), ("wall", Layer(E_STAR, 0.3, 0.05 * SIZE))],
)
def test_the_work_of_the_load_is_stored_or_spent_on_yielding(kind, solid):
    """−∫p ds by the trapezoidal rule: of second order in the steps."""

    def unaccounted(steps):
        contact, pressures = contact_of(kind, solid=solid, tolerance=1e-11), np.linspace(2e9, 2.1e9, steps + 1)
        found = stepped(contact, pressures)
        energy = np.array([one.elastic_energy + one.interaction_energy for one in found])
        energy += [one.plastic_work for one in found]
        work = -np.trapezoid(pressures, [separation_of(one, solid) for one in found])
        return (work - (energy[-1] - energy[0])) / work

    # Edges of contact with a wall pass grid points; smooth laws are of the second order.
    fine = unaccounted(4)
    assert abs(fine) < 1e-4
    if kind in ("varied", "yielding"):  # points pass a bend of their law one by one
        assert abs(unaccounted(32)) < 1e-6
    else:
        assert abs(unaccounted(2) / fine) > 2.5


# A thick layer, one that is next to a bed of springs, one whose uniform compression is the stiffest of all.
SPRINGS = {share: Layer(E_STAR, ratio, share * SIZE) for ratio, share in ((0.3, 0.5), (0.0, 0.01), (0.499, 0.1))}


@pytest.mark.parametrize(
    ("name", "control", "solid"),
    [(name, "gap", HALF_SPACE) for name in ("hard_wall", "lennard_jones_10_4", "exponential", "dugdale", "repulsive")]
    + [("hard_wall", "approach", layer) for layer in SPRINGS.values()]
    + [("exponential", "approach", SPRINGS[0.01]), ("lennard_jones_10_4", "approach", SPRINGS[0.5])]
    + [("repulsive", "approach", SPRINGS[0.1])],
)
def test_every_control_has_the_states_of_the_pressure(name, control, solid):
    the_law = EVERY_LAW[name]
    by_pressure, held = (
        rough_contact(HEIGHT, SIZE, solid, the_law, each, tolerance=1e-10) for each in ("pressure", control)
    )

    def met(found):
        return found.mean_gap if control == "gap" else approach_of(found, HEIGHT, solid, the_law)

    state = by_pressure.separated()
    for pressure in (1e9, 10e9, 0.2e9):
        one = by_pressure.step(state, pressure)
        target, state = met(one), one.state
        found, fresh = held.step(one.state, target), held.step(held.separated(), target)
        for each in (found, fresh):
            assert each.converged
            assert met(each) == pytest.approx(target, abs=1e-8 * R0)
            if control == "approach":
                moved = each.displacement - (HEIGHT.max() + the_law.equilibrium_distance - target)
                elastic = elastic_pressure(solid, GRID, moved, 1 / solid.mean_compliance)
                # The solver's 1e-8 E*; of a wall 1e-10 of the rms height, by the stiffest wave 7e-10 E*.
                np.testing.assert_allclose(elastic, each.pressure, atol=2e-8 * E_STAR, rtol=0)
                assert each.elastic_energy == pytest.approx(0.5 * np.mean(elastic * moved), rel=1e-5)
        np.testing.assert_allclose(found.gap, one.gap, atol=1e-6 * R0)
        np.testing.assert_array_equal(found.gap == 0, one.gap == 0)
        assert found.pressure.mean() == pytest.approx(pressure, abs=2e-8 * E_STAR)
        if the_law != HardWall() and control == "gap":
            assert found.fft_pairs < 20, "the spring's end is known from the state"
        assert held.stiffness(found) == pytest.approx(by_pressure.stiffness(one), rel=1e-4)


@every_elastic_kind
def test_an_iteration_limit_is_reported_with_its_residual(kind):
    [found] = stepped(contact_of(kind, max_iterations=1), [2e9])
    assert found.outcome is Outcome.ITERATION_LIMIT
    assert "max_iterations" in found.message
    assert not found.converged
    assert found.iterations <= 2
    assert found.residual > 1e-8
    [found] = stepped(contact_of(kind, tolerance=1e-18, max_iterations=200), [2e9])
    assert found.outcome in (Outcome.STALLED, Outcome.ITERATION_LIMIT)
    assert found.residual < 1e-12


@every_kind
@pytest.mark.parametrize(
    ("state", "target", "message"),
    [
        (None, 1e9, r"state is None: give contact\.separated\(\), or the solution of an earlier step"),
        (np.zeros((3, 3)), 1e9, r"state has shape \(3, 3\)"),
        ("apart", [1e9], r"target = \[1000000000.0\]: the mean pressure must be a finite number, in Pa"),
        ("apart", np.inf, "target = inf: the mean pressure"),
    ],
)  # fmt: skip
def test_bad_states_and_targets_are_named(kind, state, target, message):
    contact = contact_of(kind)
    with pytest.raises(ValueError, match=message):
        contact.step(contact.separated() if isinstance(state, str) else state, target)
    if kind != "viscoelastic":
        with pytest.raises(TypeError, match="stiffness takes the Solution that step returned, not ndarray"):
            contact.stiffness(contact.separated())


@pytest.mark.parametrize("kind", ["adhesive", "wall", "plastic", "free"])
def test_a_trace_has_the_pairs_and_the_residual_of_the_solution_and_changes_nothing(kind):
    marks = []
    traced = contact_of(kind, HEIGHT, trace=marks.append)
    before = marks[-1].pairs if marks else 0.0
    found = stepped(traced, [2e9])[0]
    phases = [mark.phase for mark in marks]
    extension = {"extension"} if KINDS[kind][0] == HardWall() else set()
    assert set(phases) == {"transform", "spectrum", "points", "iteration"} | extension
    assert marks[-1].pairs - before == pytest.approx(found.fft_pairs, rel=1e-12)
    finest = max(mark.shape for mark in marks)
    assert [mark.residual for mark in marks if (mark.phase, mark.shape) == ("iteration", finest)][-1] == found.residual
    assert phases.count("transform") == phases.count("spectrum") * 2
    np.testing.assert_array_equal(stepped(contact_of(kind, HEIGHT), [2e9])[0].gap, found.gap)


@pytest.mark.parametrize(
    ("solid", "the_law"),
    [(E_STAR, one) for one in EVERY_LAW.values()]
    + [(Layer(E_STAR, 0.3, 5e-9), EVERY_LAW[name]) for name in ("hard_wall", "morse", "exponential")],
)
def test_stiffness_is_the_derivative_of_the_path(the_law, solid):
    contact = rough_contact(HEIGHT, SIZE, solid, the_law, tolerance=1e-11)
    middle = contact.step(contact.separated(), 2e9)
    lower, higher = (contact.step(middle.state, 2e9 * (1 + change)) for change in (-1e-4, 1e-4))
    slope = (higher.pressure.mean() - lower.pressure.mean()) / (lower.gap.mean() - higher.gap.mean())
    # Points that begin to touch, or to be attracted, within the difference; of smooth laws its square.
    assert contact.stiffness(middle) == pytest.approx(slope, rel=2e-3 if the_law.has_wall else 1e-3)


@pytest.mark.parametrize("name", ["lennard_jones_10_4", "exponential", "dugdale"])
def test_a_soft_state_is_not_lost_beside_the_spring_of_the_control(name):
    length = EVERY_LAW[name].length
    contact, step = rough_contact(HEIGHT, SIZE, E_STAR, EVERY_LAW[name], "gap", tolerance=1e-11), 1e-3 * length
    state = contact.separated()
    for gap in (2, 8, 16):
        found, nearer, farther = (contact.step(state, gap * length + shift) for shift in (0.0, -step, step))
        slope, state = (nearer.pressure.mean() - farther.pressure.mean()) / (2 * step), found.state
        # Central differences; of the Dugdale law's edge and the wall's points that come or go within them, a share.
        assert contact.stiffness(found) == pytest.approx(slope, rel=3e-3, abs=1e6)


@pytest.mark.parametrize(("name", "gap"), [("dugdale", 14), ("dugdale_core", 20), ("dugdale_core", 24)])
def test_a_soft_state_is_not_lost_to_single_precision(name, gap):
    the_law = EVERY_LAW[name]
    contact = rough_contact(HEIGHT, SIZE, E_STAR, the_law, "gap")
    found = contact.step(contact.separated(), gap * the_law.length)
    # Where next to nothing is left of the law its mean stiffness: there single precision has three digits and fewer.
    assert contact.stiffness(found) == pytest.approx(float(the_law.stiffness(found.gap).mean()), rel=0.02, abs=0)


def test_surfaces_apart_have_no_stiffness_and_closed_ones_no_end():
    wall, sticky, free = (contact_of(kind) for kind in ("wall", "outside a wall", "free wall"))
    *_, apart = stepped(sticky, [1e9, -2e9])
    assert apart.detached
    assert sticky.stiffness(apart) == 0
    assert wall.stiffness(stepped(wall, [0.0])[0]) == free.stiffness(stepped(free, [0.0])[0]) == 0
    assert wall.stiffness(stepped(wall, [300e9])[0]) == np.inf


# Loads far below tolerance × E*. Of the pressure: what may be missing of a light one with the default tolerance, by its
# share of LIGHT. Of 1 Pa, 4e-12 E*, rounding leaves up to 3e-5.
STIFF, WIDE, SHARE, LIGHT = 230e9, 1e-6, 3e-5, (1.0, 2e3)
ROUGH, ROUGH_GRID = random_heights((48, 48), 2.3, 3)
ROUGH *= 5e-9
SHORT, BED = Exponential(0.05, 1e-9), Repulsive(0.0, 1e-9, 0.05)


def few(the_law, solid=STIFF, height=ROUGH, **options):
    return partial(rough_contact, height, WIDE, solid, the_law, max_iterations=100, **options)


PATHS = {
    **{name: (few(one), LIGHT) for name, one in EVERY_LAW.items()},
    # Weak attraction far away has a mean that hardly anything holds: each of 2000 steps went a ten-thousandth.
    "weak": (few(Exponential(5e-3, 1e-9)), (1.0, 100.0)),
    "far away": (few(LennardJones104(1e-3, 3.4e-10), height=6 * ROUGH), (1.0, 100.0)),
    "after a heavy one": (few(LennardJones104(0.05, 3.28e-10)), (1e8, 1e3, -10.0, 1.0)),
    "yielded": (few(HardWall(), hardness=1e9), (1e8, 1.0)),
    "in time": (partial(of_one_second, ROUGH, WIDE, Viscoelastic(STIFF, (STIFF,), (1.0,)), SHORT), LIGHT),
    **{f"free {one}": (few(one, boundary="free"), LIGHT) for one in (HardWall(), SHORT, BED)},
    **{f"layer {one}": (few(one, Layer(STIFF, 0.3, 1e-7)), LIGHT) for one in (HardWall(), SHORT, BED)},
    "threads": (few(SHORT, threads=2), LIGHT),
}


@pytest.mark.parametrize(("make", "loads"), PATHS.values(), ids=PATHS)
def test_a_light_load_is_carried(make, loads):
    for load, found in zip(loads, stepped(make(), loads), strict=True):
        assert found.converged, found.message
        assert found.pressure.mean() == pytest.approx(load, rel=SHARE)
        assert found.pressure.max() > load


@pytest.mark.parametrize("load", [0.1, 1.0])
def test_stresses_below_the_tolerance_are_in_balance(load):
    [found] = stepped(few(Repulsive(0.0, 1e-9, 1e-3))(), [load])
    elastic = elastic_pressure(HalfSpace(STIFF / WIDE), ROUGH_GRID, found.displacement)
    np.testing.assert_allclose(elastic + load, found.pressure, atol=min(2e-4 * found.pressure.max(), 2e-11 * STIFF))


LAW = LennardJones104(work_of_adhesion=0.2, length=3.28e-10)
NOISE = 3e-11 * np.random.default_rng(0).standard_normal((16, 16))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"height": "a map"}, "height must be an array"),
        ({"height": np.zeros(8)}, r"height has shape \(8,\)"),
        ({"height": np.diag([np.inf] + 7 * [0.0])}, "height is not finite everywhere: 1 point is not"),
        ({"size": "10 nm"}, "size = '10 nm'.*in m"),
        ({"size": (1e-9, -1e-9)}, "size = -1e-09"),
        ({"size": (1e-9,)}, "one period or two"),
        ({"elasticity": -1.0}, "contact_modulus"),
        ({"control": "force"}, "control = 'force'"),
        ({"tolerance": 0.0}, "tolerance"),
        ({"max_iterations": "many"}, "max_iterations"),
        ({"law": "lennard_jones_10_4"}, "law = 'lennard_jones_10_4'"),
        ({"hardness": 0.0}, "hardness"),
        ({"work_of_adhesion": np.ones((8, 4))}, r"work_of_adhesion: has the shape \(8, 4\), the heights \(8, 8\)"),
        ({"work_of_adhesion": np.zeros((8, 8))}, "its smallest value is 0 J/m².*would not repel"),
        ({"work_of_adhesion": -np.eye(8), "law": EVERY_LAW["exponential"]}, "value is -1 J/m²; none may be negative"),
        ({"work_of_adhesion": np.ones((8, 8)), "law": HardWall()}, "work_of_adhesion: HardWall does not attract"),
        ({"boundary": "open"}, "boundary = 'open'"),
        ({"boundary": "free", "control": "gap"}, "'pressure' or 'approach'"),
        ({"boundary": "free", "elasticity": Layer(1e9, 0.3, 1e-9)}, "those of a half-space"),
        ({"elasticity": Viscoelastic(1e9, (1e9,), (1.0,))}, "ViscoelasticContact"),
        ({"control": "approach", "elasticity": HalfSpace(1e9)}, "'approach': .* moves this solid by no finite"),
        ({"control": "approach", "elasticity": Layer(1e9, 0.5, 1e-9), "law": HardWall()}, "moves this solid by no"),
    ],
)
def test_bad_arguments_are_named(arguments, message):
    valid = {"height": np.zeros((8, 8)), "size": 1e-8, "elasticity": 1e9, "law": LAW}
    with pytest.raises(ValueError, match=message):
        rough_contact(**(valid | arguments))


@pytest.mark.parametrize(("law", "words"), [(LAW, "gaps <= 0"), (Exponential(0.5, 1e-10), "gaps < 0")])
def test_a_start_inside_the_surface_is_refused(law, words):
    contact = rough_contact(NOISE, 7e-9, E_STAR, law)
    with pytest.raises(ValueError, match=words):
        contact.step(NOISE - 1e-10, 1e9)


@pytest.mark.parametrize("name", ["lennard_jones_10_4", "exponential", "hard_wall"])
def test_a_solution_has_the_numbers_of_a_dataset_and_compares_by_identity(name):
    surface = {"heights": NOISE, "size": 7e-9}
    dataset = contact_study.run(study_table(16) | {"surface": surface, "interaction": {"law": name, **KEYS[name]}})
    contact = rough_contact(NOISE, 7e-9, E_STAR, EVERY_LAW[name], tolerance=1e-8)
    one, other = (contact.step(contact.separated(), 1e9) for _ in range(2))
    assert one.relative_contact_area == dataset.relative_contact_area.item() > 0
    assert one.mean_gap == pytest.approx(dataset.mean_gap.item(), rel=1e-6)
    assert len({one, one, other}) == 2
    assert re.search(rf"relative contact area {one.relative_contact_area:.4g}, mean gap.*\n.*converged", repr(one))


@pytest.mark.filterwarnings("default:grid too coarse")
@pytest.mark.parametrize("options", [{}, {"boundary": "free"}])
def test_a_grid_that_does_not_resolve_its_law_is_told_of(options):
    strong = LennardJones104(5.52, 3.28e-10)

    def told(points, law, **further):
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            rough_contact(np.zeros((points, points)), SIZE, E_STAR, law, **options, **further)
        return [str(each.message) for each in said]

    (line,) = told(64, strong)
    assert line.startswith("grid too coarse: its spacing is 1.625 nm, the process zone")
    assert "slow loading" in line
    points = int(re.search(r"; (\d+) x \1 points resolve it", line)[1])
    length = quantity(re.search(r"a length of (\S+ \S+) and", line)[1], "m", "")
    assert told(points, strong) == told(64, LennardJones104(5.52, length)) == []
    assert told(points - 64, strong) != [] != told(64, LennardJones104(5.52, 0.95 * length))
    # A map has the process zone of its strongest adhesion.
    work = np.full((64, 64), 0.5)
    work[20, 30] = 5.52
    (of_map,) = told(64, LennardJones104(1.38, 3.28e-10), work_of_adhesion=work)
    assert of_map.partition(";")[0] == line.partition(";")[0]
    assert told(64, HardWall()) == told(64, Repulsive(0.0, 3.28e-10, 5.52)) == []


@pytest.mark.filterwarnings("error:grid too coarse")
def test_a_study_and_a_viscoelastic_contact_say_it_once():
    with pytest.warns(UserWarning, match="grid too coarse"):
        contact = ViscoelasticContact(NOISE, 100e-9, Viscoelastic(1e9, (1e9,), (1.0,)), LAW)
    contact.step(contact.separated(), 1e6, 0.1)  # a warning here were an error
    elastic = study_table(32, size=500e-10, interaction={"length": 1e-10})
    branch = {"kind": "viscoelastic", "branch_youngs_moduli": [5e9], "relaxation_times": ["1 s"]}
    time = {"path": [1e9], "duration": "1 s", "time_steps": 2}
    for table in (elastic, {**elastic, "elasticity": branch, "loading": time}):
        with pytest.warns(UserWarning, match="grid too coarse") as said:
            contact_study.run(table, "continuum")
        assert len(said) == 1


@pytest.mark.parametrize("the_law", [LAW, HardWall()])
def test_threads_that_share_a_contact_take_turns(the_law):
    contact = rough_contact(HEIGHT, SIZE, E_STAR, the_law)
    start, loads = contact.separated(), np.linspace(0.5e9, 4e9, 8)
    alone = [contact.step(start, load) for load in loads]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda load: contact.step(start, load), loads))
    for one, other in zip(alone, together, strict=True):
        np.testing.assert_array_equal(one.gap, other.gap)
