"""Gradients of states by the adjoint equations, against central differences of solved states."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from bem_adhesion import HalfSpace, Layer, LennardJones104, Plate, Sheet, fold_gradient, gradient, rough_contact
from bem_adhesion.gradients.linearised import LinearisedState
from bem_adhesion.gradients.numbers import number_of
from tests.laws_of_all_kinds import EVERY_LAW

SHAPE, SIZE, MODULUS = (12, 16), (45e-10, 64e-10), 90e9
NUMBERS = ("pressure", "total_force", "approach", "mean_gap", "elastic_energy", "interaction_energy", "energy")
# Boundary, control, target and stiffness of a machine.
LOADS = {
    "pressure": ("periodic", "pressure", 2e9, None),
    "gap": ("periodic", "gap", 1e-10, None),
    "machine": ("periodic", "approach", 3e-10, 50.0),
    "free": ("free", "pressure", 2e9, None),
    "free approach": ("free", "approach", 3e-10, None),
    "free machine": ("free", "approach", 3e-10, 50.0),
    "free along x": ("free_x", "approach", 3e-10, None),
}
# Roundings and tolerance of the solves over the step, and the step's third-order term: the issue is 1e-6.
AGREES, STEP = 1e-6, 1e-5
WIDTH = 0.3e-10  # of the smoothed area


@dataclass(frozen=True)
class Stiffened(HalfSpace):
    """A half-space with waves around one that are stiffer."""

    more: float = 0.0
    around: float = 3e9

    def scaled(self, length, stress):
        return replace(super().scaled(length, stress), around=self.around * length)

    def stiffness(self, wavenumber):
        return super().stiffness(wavenumber) * (1 + self.bump(wavenumber) * self.more)

    def bump(self, wavenumber):
        return np.exp(-((np.asarray(wavenumber) / self.around - 1) ** 2))


@pytest.fixture(scope="module")
def heights():
    rng = np.random.default_rng(2)
    waves = np.hypot(np.fft.fftfreq(12, 1 / 12)[:, None], np.fft.rfftfreq(16, 1 / 16))
    rough = np.fft.irfft2(np.fft.rfft2(rng.standard_normal(SHAPE)) * np.exp(-(waves**2) / 6), s=SHAPE)
    return 1.5e-10 * rough / rough.std()


@dataclass
class Given:
    """What a state follows from."""

    height: np.ndarray
    law: object
    solid: object
    load: tuple
    target: float
    work: np.ndarray | None = None

    def contact(self):
        boundary, control, _, machine = self.load
        options = {"control": control, "boundary": boundary, "tolerance": 1e-13, "max_iterations": 400}
        local = {} if self.work is None else {"work_of_adhesion": self.work}
        return rough_contact(self.height, SIZE, self.solid, self.law, machine_stiffness=machine, **options, **local)

    def numbers(self, near):
        contact, start = self.contact(), near.state
        if self.law.has_wall and self.law.attracts:  # points that touch go on touching
            start, inside = start.copy(), tuple(map(slice, SHAPE))
            start[inside] = np.where(near.gap == 0, self.height, np.maximum(start[inside], self.height))
        state = LinearisedState(contact, contact.step(start, self.target))
        return np.array([number_of(state, name, WIDTH).value for name in self.known])

    @property
    def known(self):
        return [*NUMBERS, *(["contact_area"] if not self.law.bare_wall else [])]


def check(given, changes):
    """Compare all derivatives of all numbers; ``changes`` are by a number ε and what it does to the gradient."""
    contact = given.contact()
    found = contact.step(contact.separated(), given.target)
    assert found.converged
    gradients = [gradient(contact, found, name, WIDTH) for name in given.known]
    for name, (changed, along) in changes.items():
        differences = given_numbers(given, found, changed)
        for number, by, difference in zip(given.known, gradients, differences, strict=True):
            parts = np.asarray(along(by))
            # Where a derivative is a small difference of large parts, its error is that of the parts.
            scale = max(np.abs(parts).sum(), abs(by.value))
            assert parts.sum() == pytest.approx(difference, abs=AGREES * scale, rel=AGREES), (name, number)


def given_numbers(given, found, changed):
    above, below = (changed(given, step).numbers(found) for step in (STEP, -STEP))
    return (above - below) / (2 * STEP)


def changes_of(given):
    """Relative changes of everything that a state follows from."""
    rng = np.random.default_rng(3)
    way = rng.standard_normal(SHAPE) * 1e-11
    changes = {
        "heights": (lambda g, e: replace(g, height=g.height + e * way), lambda by: by.heights * way),
        "load": (lambda g, e: replace(g, target=g.target * (1 + e)), lambda by: [by.load * given.target]),
        "modulus": (
            lambda g, e: replace(g, solid=replace(g.solid, contact_modulus=MODULUS * (1 + e))),
            lambda by: [by.contact_modulus * MODULUS],
        ),
    }
    if not given.law.bare_wall:
        # All lengths of the law, at the same work of adhesion.
        changes["lengths"] = (
            lambda g, e: replace(g, law=g.law.scaled(1 / (1 + e), 1 + e)),
            lambda by: [by.length_scale],
        )
    if given.law.attracts:
        work = given.law.work_of_adhesion * np.ones(SHAPE) if given.work is None else given.work
        share = rng.standard_normal(SHAPE)
        changes["work"] = (
            lambda g, e: replace(g, work=work * (1 + e * share)),
            lambda by: by.work_of_adhesion * work * share,
        )
    return changes


QUICK = {"lennard_jones_10_4", "exponential", "hard_wall"}
LAWS = [pytest.param(law, marks=[] if law in QUICK else pytest.mark.validation) for law in EVERY_LAW]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("load", ["pressure", "gap", "free approach"])
def test_derivatives_are_those_of_solved_states(heights, law, load):
    given = Given(heights, EVERY_LAW[law], HalfSpace(MODULUS), LOADS[load], LOADS[load][2])
    check(given, changes_of(given))


@pytest.mark.validation
@pytest.mark.parametrize("law", sorted(QUICK))
@pytest.mark.parametrize("load", ["machine", "free", "free machine", "free along x"])
def test_derivatives_under_other_controls_and_boundaries(heights, law, load):
    given = Given(heights, EVERY_LAW[law], HalfSpace(MODULUS), LOADS[load], LOADS[load][2])
    check(given, changes_of(given))


@pytest.mark.parametrize("law", ["lennard_jones_10_4", "exponential"])
def test_derivatives_with_a_map_of_the_work_of_adhesion(heights, law):
    work = EVERY_LAW[law].work_of_adhesion * (1 + 0.5 * np.sin(np.arange(16) / 16 * 2 * np.pi) * np.ones(SHAPE))
    given = Given(heights, EVERY_LAW[law], HalfSpace(MODULUS), LOADS["gap"], LOADS["gap"][2], work)
    check(given, changes_of(given))


@pytest.mark.parametrize(
    "solid",
    [
        Layer(MODULUS, poissons_ratio=0.3, thickness=40e-10),
        Plate(MODULUS, thickness=40e-10),
        Sheet(MODULUS, bending_stiffness=1e-18, tension=10.0, foundation=1e20),
    ],
    ids=["layer", "plate", "sheet"],
)
@pytest.mark.parametrize("control", ["pressure", "gap", "approach"])
def test_derivatives_on_other_solids(heights, solid, control):
    if control == "approach" and not solid.mean_compliance:
        pytest.skip("a uniform pressure moves it by no finite distance")
    target = {"pressure": 2e9, "gap": 1e-10, "approach": 3e-10}[control]
    given = Given(heights, EVERY_LAW["lennard_jones_10_4"], solid, ("periodic", control, target, None), target)
    changes = changes_of(given)
    if isinstance(solid, Sheet):  # its modulus is the unit of stresses alone
        del changes["modulus"]
    check(given, changes)


@pytest.mark.parametrize("law", ["lennard_jones_10_4", "hard_wall"])
@pytest.mark.parametrize("load", ["pressure", "gap"])
def test_derivatives_by_the_stiffness_of_waves(heights, law, load):
    given = Given(heights, EVERY_LAW[law], Stiffened(MODULUS), LOADS[load], LOADS[load][2])
    grid = given.contact().grid
    waves = given.solid.stiffness_on(grid) * given.solid.bump(grid.wavenumber)
    changes = {"waves": (lambda g, e: replace(g, solid=Stiffened(MODULUS, e)), lambda by: by.stiffness * waves)}
    check(given, changes)


def test_a_number_of_the_gaps_by_its_own_derivative(heights):
    given = Given(heights, EVERY_LAW["lennard_jones_10_4"], HalfSpace(MODULUS), LOADS["pressure"], 2e9)
    contact = given.contact()
    found = contact.step(contact.separated(), 2e9)
    mean, own = gradient(contact, found, "mean_gap"), gradient(contact, found, np.full(SHAPE, 1 / np.prod(SHAPE)))
    assert own.heights == pytest.approx(mean.heights, rel=1e-9)
    assert own.load == pytest.approx(mean.load, rel=1e-9)
    assert np.isnan(own.value)


def test_the_error_of_the_linearised_number_is_of_second_order(heights):
    given = Given(heights, EVERY_LAW["lennard_jones_10_4"], HalfSpace(MODULUS), LOADS["pressure"], 2e9)
    contact = given.contact()
    found = contact.step(contact.separated(), 2e9)
    by = gradient(contact, found, "elastic_energy")
    way = np.random.default_rng(4).standard_normal(SHAPE) * 1e-12
    errors = []
    for step in (1.0, 0.5):
        moved = replace(given, height=heights + step * way).numbers(found)[NUMBERS.index("elastic_energy")]
        errors.append(abs(moved - by.value - step * float(np.sum(by.heights * way))))
    # A quarter, but for the third order.
    assert errors[1] / errors[0] == pytest.approx(0.25, abs=0.02)


def test_at_most_two_linear_solves(heights):
    for load, solves in (("pressure", 1), ("free approach", 1), ("gap", 2)):
        given = Given(heights, EVERY_LAW["lennard_jones_10_4"], HalfSpace(MODULUS), LOADS[load], LOADS[load][2])
        contact = given.contact()
        found = gradient(contact, contact.step(contact.separated(), given.target), "energy")
        assert (found.solves, found.at_fold) == (solves, False)
        assert 0 < found.iterations < 100


def branch_end(given, start, inside, outside, lengths):
    """Bisect the target at which a branch ends, and return the last state on it."""
    contact = given.contact()
    last = start
    while abs(outside - inside) > 1e-13 * lengths:
        middle = 0.5 * (inside + outside)
        found = contact.step(last, middle)
        if found.detached or found.relative_contact_area == 0:
            outside = middle
        else:
            inside, last = middle, found
    return contact, last, inside


@pytest.mark.parametrize("control", ["pressure", pytest.param("approach", marks=pytest.mark.validation)])
def test_derivatives_of_the_load_at_the_end_of_a_branch(control):
    axis = np.arange(16) / 16 * 2 * np.pi
    heights = 1e-10 * (np.cos(axis)[:, None] + np.cos(axis)[None, :])
    machine, first, outside = {"pressure": (None, 1e9, -6e9), "approach": (1.0, 2e-10, -400e-10)}[control]
    law = LennardJones104(0.3, 3.28e-10)
    given = Given(heights, law, HalfSpace(MODULUS), ("periodic", control, first, machine), first)
    scale = abs(outside)

    def end(**changed):
        other = replace(given, **changed)
        contact = other.contact()
        return branch_end(other, contact.step(contact.separated(), first), first, outside, scale)

    contact, last, position = end()
    by = fold_gradient(contact, last)
    # The branch's end is found to 1e-13 of the way.
    assert by.value == pytest.approx(position, abs=1e-10 * scale)
    way = np.random.default_rng(5).standard_normal(heights.shape) * 1e-11
    step = 1e-3
    for changed, along in (
        (lambda e: {"height": heights + e * way}, float(np.sum(by.heights * way))),
        (lambda e: {"law": law.scaled(1.0, 1 / (1 + e))}, float(by.work_of_adhesion.sum()) * law.work_of_adhesion),
        (lambda e: {"law": law.scaled(1 / (1 + e), 1 + e)}, by.length_scale),
        (lambda e: {"solid": HalfSpace(MODULUS * (1 + e))}, by.contact_modulus * MODULUS),
    ):
        difference = (end(**changed(step))[2] - end(**changed(-step))[2]) / (2 * step)
        # The mode at the state differs from that at the end by some roots of 1e-13.
        assert along == pytest.approx(difference, rel=3e-5, abs=3e-5 * abs(position))
    with pytest.warns(UserWarning, match="the branch ends about"):
        assert gradient(contact, last, "mean_gap").at_fold
    # Farther away the distance is estimated by a parabola.
    before = contact.step(contact.step(contact.separated(), first), 0.99 * position)
    assert fold_gradient(contact, before).fold_distance == pytest.approx(0.01 * position, rel=0.2)


def test_a_jump_since_the_state_before_is_named(heights):
    given = Given(2 * heights, LennardJones104(1.2, 3.28e-10), HalfSpace(MODULUS), LOADS["gap"], 8e-10)
    contact = given.contact()
    apart = contact.step(contact.separated(), 8e-10)
    for target, jumps in ((7.99e-10, False), (0.5e-10, True)):
        found = contact.step(apart, target)
        if jumps:
            with pytest.warns(UserWarning, match="were lost since the state before, in a jump"):
                gradient(contact, found, "pressure", before=apart)
        else:
            gradient(contact, found, "pressure", before=apart)


def test_what_has_no_gradient_says_so(heights):
    law = EVERY_LAW["lennard_jones_10_4"]
    contact = rough_contact(heights, SIZE, MODULUS, law)
    found = contact.step(contact.separated(), 2e9)
    yielding = rough_contact(heights, SIZE, MODULUS, law, hardness=20e9)
    wall = rough_contact(heights, SIZE, MODULUS, EVERY_LAW["hard_wall"])
    for contact_, solution, of, words in (
        (contact, found, "area", "of = 'area': expected one of pressure, total_force"),
        (contact, found, np.ones(3), r"of has shape \(3,\): must be an array"),
        (contact, found, np.ones((16, 12)), r"of: has the shape \(16, 12\), the heights \(12, 16\)"),
        (contact, contact.step(contact.separated(), -1e9), "pressure", "must be a converged state in contact"),
        (contact, found.gap, "pressure", "must be a converged state in contact"),
        (yielding, found, "pressure", "PlasticContact has no gradients; leave hardness"),
        (wall, wall.step(wall.separated(), 1e9), "contact_area", "of a hard wall it changes by jumps"),
    ):
        with pytest.raises(ValueError, match=words):
            gradient(contact_, solution, of)
    with pytest.raises(ValueError, match="width = 0"):
        gradient(contact, found, "contact_area", width=0.0)
