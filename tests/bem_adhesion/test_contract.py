"""What every contact promises, whatever its law, solid, control and boundary.

Equilibrium by code that no solver uses, minima, restart, symmetry, units, the energy balance, both controls, limits.
"""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bem_adhesion import (
    Exponential,
    HalfSpace,
    HardWall,
    Layer,
    Outcome,
    Viscoelastic,
    ViscoelasticContact,
    rough_contact,
)
from bem_adhesion.study.state import separation_of
from tests.bem_adhesion.paper_system import E_STAR, R0, law
from tests.bem_adhesion.rough_surfaces import SIZE, self_affine, stepped
from tests.laws_of_all_kinds import EVERY_LAW

pytestmark = pytest.mark.filterwarnings("ignore:grid too coarse")

HEIGHT, GRID = self_affine(64)
SMALL = HEIGHT[::2, ::2] - HEIGHT[::2, ::2].mean()
HALF_SPACE = HalfSpace(E_STAR)
LAYERS = {f"layer {ratio} {share}": Layer(E_STAR, ratio, share * SIZE) for ratio in (0.3, 0.5) for share in (1, 0.01)}
LOADS = {"pressure": (0.2e9, 2e9, 20e9, 1e9), "gap": (6e-10, 2e-10, 0.3e-10, 4e-10)}


class OfOneSecond:
    """A viscoelastic contact whose steps all take one second."""

    def __init__(self, height, solid):
        self._contact = ViscoelasticContact(height, SIZE, solid, law())
        self.separated = self._contact.separated

    def step(self, state, target):
        return self._contact.step(state, target, 1.0)[0]


KINDS = {
    "wall": lambda **options: rough_contact(SMALL, SIZE, E_STAR, HardWall(), **options),
    "plastic": lambda **options: rough_contact(SMALL, SIZE, E_STAR, HardWall(), hardness=5e9, **options),
    "free wall": lambda **options: rough_contact(SMALL, SIZE, E_STAR, HardWall(), boundary="free", **options),
    "adhesive": lambda **options: rough_contact(SMALL, SIZE, E_STAR, law(4.0), **options),
    "outside a wall": lambda **options: rough_contact(SMALL, SIZE, E_STAR, EVERY_LAW["exponential"], **options),
    "free": lambda **options: rough_contact(SMALL, SIZE, E_STAR, law(4.0), boundary="free", **options),
    "viscoelastic": lambda: OfOneSecond(SMALL, Viscoelastic(E_STAR, (1e10,), (1.0,))),
}
every_kind = pytest.mark.parametrize("kind", KINDS)


def elastic_pressure(solid, grid, displacement):
    """K u by NumPy's transform, without its mean (Pa)."""
    stiffness_q = solid.stiffness_on(grid)
    stiffness_q[0, 0] = 0
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
    + [pytest.param(HALF_SPACE, law(ratio), id=f"{ratio} times the depth") for ratio in (4.0, 8.0)]
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
    found = stepped(rough_contact(HEIGHT, GRID.size, E_STAR, the_law), [2e9])[0]

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
    contact = KINDS[kind]()
    first, second = stepped(contact, [1e9, 2e9])
    assert second.pressure.mean() == pytest.approx(2e9, rel=1e-6)
    assert np.count_nonzero(second.pressure > 0) > np.count_nonzero(first.pressure > 0) > 0
    for again in (contact.step(first, 2e9), KINDS[kind]().step(first.state.copy(), 2e9)):
        np.testing.assert_array_equal(again.gap, second.gap)
        np.testing.assert_array_equal(again.pressure, second.pressure)
    np.testing.assert_array_equal(stepped(contact, [1e9])[0].gap, first.gap)


def solved(the_law, height, size=(150e-10, 180e-10), modulus=E_STAR, pressure=2e9):
    return stepped(rough_contact(height, size, modulus, the_law), [pressure])[0]


SYMMETRIC = {"wall": HardWall(), "weak": law(1.0), "strong": law(8.0), "outside a wall": EVERY_LAW["exponential"]}


@pytest.mark.parametrize("the_law", SYMMETRIC.values(), ids=SYMMETRIC)
@settings(max_examples=4)
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


BODIES = {
    "wall": (HALF_SPACE, HardWall(), {}),
    "adhesive": (HALF_SPACE, law(1.0), {}),
    "outside a wall": (HALF_SPACE, EVERY_LAW["exponential"], {}),
    "layer": (Layer(E_STAR, 0.3, 0.2 * SIZE), law(1.0), {}),
    "wall on a layer": (Layer(E_STAR, 0.3, 0.05 * SIZE), HardWall(), {}),
    "free": (HALF_SPACE, law(1.0), {"boundary": "free"}),
    "free wall": (HALF_SPACE, HardWall(), {"boundary": "free"}),
    "plastic": (HALF_SPACE, HardWall(), {"hardness": 0.05 * E_STAR}),
}


@pytest.mark.parametrize(("solid", "the_law", "options"), BODIES.values(), ids=BODIES)
def test_the_work_of_the_load_is_stored_or_spent_on_yielding(solid, the_law, options):
    """−∫p ds by the trapezoidal rule: of second order in the steps."""

    def unaccounted(steps):
        contact = rough_contact(SMALL, SIZE, solid, the_law, tolerance=1e-11, **options)
        pressures = np.linspace(2e9, 2.1e9, steps + 1)
        found = stepped(contact, pressures)
        energy = np.array([one.elastic_energy + one.interaction_energy for one in found])
        if "hardness" in options:
            energy += options["hardness"] * np.array([one.plastic_indentation.mean() for one in found])
        work = -np.trapezoid(pressures, [separation_of(one, solid) for one in found])
        return (work - (energy[-1] - energy[0])) / work

    # Edges of contact with a wall pass grid points; smooth laws are of the second order.
    fine = unaccounted(4)
    assert abs(fine) < 1e-4
    assert abs(unaccounted(2) / fine) > 2.5


@pytest.mark.parametrize("name", ["hard_wall", "lennard_jones_10_4", "exponential", "dugdale", "repulsive"])
def test_controls_of_gap_and_pressure_have_the_same_states(name):
    the_law = EVERY_LAW[name]
    by_pressure, by_gap = (
        rough_contact(HEIGHT, SIZE, E_STAR, the_law, control, tolerance=1e-10) for control in ("pressure", "gap")
    )
    state = by_pressure.separated()
    for pressure in (1e9, 10e9, 0.2e9):
        one = by_pressure.step(state, pressure)
        other = by_gap.step(one.state, one.mean_gap)
        state = one.state
        assert other.converged
        assert other.mean_gap == pytest.approx(one.mean_gap, abs=1e-8 * R0)
        np.testing.assert_allclose(other.gap, one.gap, atol=1e-6 * R0)
        np.testing.assert_array_equal(other.gap == 0, one.gap == 0)
        assert other.pressure.mean() == pytest.approx(pressure, abs=2e-8 * E_STAR)
        if the_law != HardWall():
            assert other.fft_pairs < 20, "the spring's end is known from the state"
        if the_law.attracts or the_law == HardWall():
            assert by_gap.stiffness(other) == pytest.approx(by_pressure.stiffness(one), rel=1e-4)


@every_kind
def test_an_iteration_limit_is_reported_with_its_residual(kind):
    if kind == "viscoelastic":
        pytest.skip("options of the solver are those of the elastic contact")
    found = stepped(KINDS[kind](max_iterations=1), [2e9])[0]
    assert found.outcome is Outcome.ITERATION_LIMIT
    assert not found.converged
    assert found.iterations <= 2
    assert found.residual > 1e-8
    assert "max_iterations" in found.message


@pytest.mark.parametrize("kind", ["wall", "adhesive", "outside a wall"])
def test_a_tolerance_below_rounding_is_reported(kind):
    found = stepped(KINDS[kind](tolerance=1e-18, max_iterations=200), [2e9])[0]
    assert found.outcome in (Outcome.STALLED, Outcome.ITERATION_LIMIT)
    assert found.residual < 1e-12


@pytest.mark.parametrize("boundary", ["periodic", "free"])
def test_stiffness_takes_a_solution_alone(boundary):
    for the_law, options in ((law(), {}), (HardWall(), {}), (HardWall(), {"hardness": 5e9})):
        contact = rough_contact(SMALL, SIZE, E_STAR, the_law, boundary=boundary, **options)
        with pytest.raises(TypeError, match="stiffness takes the Solution that step returned, not ndarray"):
            contact.stiffness(contact.separated())


@pytest.mark.parametrize("zone", [0.05, 0.09, 0.16])
@pytest.mark.parametrize("name", ["lennard_jones_10_4", "exponential", "dugdale"])
def test_steps_on_grids_far_coarser_than_the_process_zone_converge(name, zone):
    """Points then snap in one after the other, and within the iteration limit."""
    the_law, points = EVERY_LAW[name], 32
    height = HEIGHT[::2, ::2]
    length = the_law.work_of_adhesion * E_STAR / the_law.peak_tensile_stress**2 / zone
    contact = rough_contact(height, points * length, E_STAR, the_law)
    for found in stepped(contact, [0.01e9, 0.1e9, 1e9, 0.05e9]):
        assert found.converged, found.message
