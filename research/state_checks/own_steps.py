"""A path in steps of its own: its points are equilibria, its books add up, small steps come to the same."""

from dataclasses import dataclass

import numpy as np

from bem_adhesion import Contact, Solution
from bem_adhesion.study.model import solve_path
from contact_study.results.state import InterfaceState
from contact_study.study.case import Case
from research.state_checks import equilibrium
from research.state_checks.state import Point, Study

SMALL_STEPS = 24
# Share of what was exchanged by which the losses of two ways through the same states may differ.
SAME = 1e-3
# Times the median that a gap changes by at most in a small step of no jump.
JUMP = 5
# What a step may leave unaccounted for of what it exchanged (docs, "Loading"), and of the work of adhesion.
SHARE, NOISE = 0.02, 1e-6


@dataclass
class Books:
    """Pressures (Pa), separations (m) and energies (J/m²) of the states of a path, shape (n, 3)."""

    states: np.ndarray

    @property
    def lost(self) -> np.ndarray:
        """Work of the load that is not in the energy, by the trapezoidal rule, of each step (J/m²)."""
        return self._work - np.diff(self.states[:, 2])

    @property
    def exchanged(self) -> np.ndarray:
        """Work and energy exchanged in each step, of either sign (J/m²)."""
        pressure, separation, energy = self.states.T
        pushed = 0.5 * (np.abs(pressure[1:]) + np.abs(pressure[:-1])) * np.abs(np.diff(separation))
        return pushed + np.abs(np.diff(energy))

    @property
    def undecided(self) -> float:
        """By how much that may be off as the places of jumps within their steps are unknown (J/m²)."""
        pressure, separation, _ = np.diff(self.states, axis=0).T
        return 0.5 * float(np.abs(pressure * separation)[self.jumps(0.0)].sum())

    @property
    def _work(self) -> np.ndarray:
        pressure, separation, _ = self.states.T
        return -0.5 * (pressure[1:] + pressure[:-1]) * np.diff(separation)

    def jumps(self, noise: float) -> np.ndarray:
        """Which steps hold more than the rule may leave: jumps, if they were short."""
        return np.abs(self.lost) > np.maximum(SHARE * self.exchanged, noise)


def follow(study: Study) -> None:
    """Solve a case's path and check its points."""
    case, surfaces, verdict = study.case, study.surfaces, study.verdict
    contact = study.contact()
    points: list[InterfaceState] = []
    for written, (target, _) in zip(solve_path(case, study.surface), case.path, strict=True):
        verdict.states += 1
        points.append(written)
        if not written.report.converged:
            verdict.flagged.append(written.report.message)
            return
        if written.report.detached:
            verdict.detached += 1
            continue
        point = Point.on_path(written, surfaces.free)
        equilibrium.check_with_energies(study, point, target, lambda start, at=target: contact.step(start, at))
    _check_books(study, points)
    number = int(study.rng.integers(1, len(points)))
    _check_small_steps(study, contact, points[number - 1], points[number], number)


def _check_books(study: Study, points: list[InterfaceState]) -> None:
    """Each written energy is a state's; the jumps' losses add up to what is said to be dissipated."""
    noise = NOISE * study.case.law.work_of_adhesion
    previous = None
    for number, point in enumerate(points):
        where = f"adaptive, point {number}"
        passed = point.passed
        assert passed is not None
        if not point.report.detached and not np.allclose(passed[-1], _last(point), rtol=1e-9, atol=0):
            study.fault(where, "the last state passed is not the point's")
        if previous is not None and np.isfinite(previous).all() and len(passed):
            books = Books(np.vstack([previous, passed]))
            if np.isfinite(books.states).all():
                booked = float(np.maximum(books.lost, 0)[books.jumps(noise)].sum())
                added = point.further["dissipated_energy"] - points[number - 1].further["dissipated_energy"]
                if abs(added - booked) > 1e-6 * booked + noise:
                    study.fault(where, f"dissipated {added:.6g}, its jumps lost {booked:.6g} J/m²")
        previous = passed[-1] if len(passed) else previous


def _check_small_steps(
    study: Study, contact: Contact, before: InterfaceState, after: InterfaceState, number: int
) -> None:
    """From one point to the next in many even steps: to the same state, unless one of the two ways jumps."""
    case, surfaces = study.case, study.surfaces
    begin, end = case.path[number - 1][0], case.path[number][0]
    where = f"adaptive, {surfaces.control} {begin:.4g} to {end:.4g}"
    if before.report.detached:
        return
    state, gap, passed, moves = before.restart["state"], before.gap, [_last(before)], []
    for position in np.linspace(begin, end, SMALL_STEPS + 1)[1:]:
        found = contact.step(state, float(position))
        if not found.converged:
            return
        if found.detached:
            break
        passed.append(_books_of(case, found))
        moves.append(float(np.abs(found.gap - gap).max()) / surfaces.length)
        state, gap = found.state, found.gap
    small = Books(np.array(passed))
    assert after.passed is not None
    own = Books(np.vstack([_last(before), after.passed]))
    if found.detached or after.report.detached:
        if found.detached != after.report.detached:
            study.fault(where, "apart in the one way only")
        return
    away = float(np.abs(found.gap - after.gap).max()) / surfaces.length
    # Behind a jump two ways may go on along other branches, and lose what those do.
    if away > 1e-3 and own.jumps(NOISE * case.law.work_of_adhesion).any():
        return
    apart = abs(own.lost.sum() - small.lost.sum())
    if apart > SHARE * own.exchanged.sum() + own.undecided + small.undecided:
        study.fault(where, f"lost {own.lost.sum():.4g}, in small steps {small.lost.sum():.4g} J/m²")
    # Where points move further in one small step than in the others they jump, and cheaper than a step has to see.
    smooth = max(moves) <= JUMP * np.median(moves) and apart <= SAME * own.exchanged.sum()
    if smooth and away > 1e-3:
        study.fault(where, f"small steps end {away:.1e} lengths away without a jump")


def _books_of(case: Case, found: Solution) -> np.ndarray:
    """Mean pressure, separation and energy of a state, as the books of a path have them."""
    pressure = float(found.pressure.mean())
    plane = found.plane
    separation = float(found.gap.mean()) - case.solid.compression(pressure) if plane is None else plane
    energy = found.elastic_energy + found.interaction_energy
    return np.array([pressure, separation - case.law.equilibrium_distance, energy])


def _last(point: InterfaceState) -> np.ndarray:
    """The same of a point as it is written."""
    energy = point.elastic_energy + point.interaction_energy
    return np.array([point.pressure.mean(), point.mean_separation, energy])
