"""Mean separation from the interfacial energy: ū(p) = ∫_p^∞ (dU/dp') dp'/p'.

Yang, Persson, Israelachvili and Rosenberg, EPL 84, 46004 (2008), eq. (6): the work of the pressure is the energy that
the interface stores. The integral runs along the adhered branch, from full contact at high pressure downward, and
never through p = 0: without sticking ū diverges there as −ln p; with it dU/dp does not vanish and the integral
diverges too, so ū stands for p > 0 only and the derivative at zero is given for itself.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline

from theory.persson.contact import PerssonContact
from theory.persson.solver import MAX_ITERATIONS, TOLERANCE, solve
from theory.persson.theory import PerssonTheory

# Pressure beyond which contact is full to 1e-12, in standard deviations of the full-contact stress.
_FULL_CONTACT = 7.0


class NegativeSeparation(UserWarning):
    """The energy of the theory is not monotonic in pressure, so that its mean separation falls below zero."""


class NotConverged(UserWarning):
    """States of a sweep, on which a mean gap or a limit of adhesion rests, did not converge."""


@dataclass(frozen=True)
class SeparationCurve:
    """Mean separation over pressure on the adhered branch.

    Attributes
    ----------
    pressure : numpy.ndarray
        Increasing pressures > 0 of the sweep (Pa).
    contacts : tuple of PerssonContact
        The state at each.
    """

    pressure: np.ndarray
    contacts: tuple[PerssonContact, ...]

    @property
    def energy(self) -> np.ndarray:
        """U at each pressure (J/m²)."""
        return np.array([contact.energy for contact in self.contacts])

    @property
    def unconverged(self) -> np.ndarray:
        """Pressures of the sweep whose state did not converge (Pa)."""
        return self.pressure[[not contact.converged for contact in self.contacts]]

    def converged_above(self, pressure: float) -> bool:
        """Whether all states converged that the mean gap at a pressure is integrated from."""
        first = max(int(np.searchsorted(self.pressure, pressure, side="right")) - 1, 0)
        return all(contact.converged for contact in self.contacts[first:])

    def mean_gap(self, pressure: np.ndarray | float) -> np.ndarray:
        """ū at pressures within the sweep (m); NaN where p <= 0.

        Warns
        -----
        NegativeSeparation
            Where ū < 0; the value is kept.
        """
        p = np.asarray(pressure, dtype=float)
        swept = (p > 0) & (p >= self.pressure[0] * (1 - 1e-12))
        x = np.log(np.where(swept, np.minimum(p, self.pressure[-1]), self.pressure[-1]))
        gap = np.where(swept, self._remaining(x), np.nan)
        if np.any(gap < 0):
            warnings.warn(
                f"mean separation down to {np.nanmin(gap):.3g} m: strong adhesion, U(p) is not monotonic",
                NegativeSeparation,
                stacklevel=2,
            )
        return gap

    @cached_property
    def _spline(self) -> CubicSpline:
        """U over x = ln p."""
        return CubicSpline(np.log(self.pressure), self.energy)

    def detachment_stress_at(self, pressure: float) -> np.ndarray:
        """σ_a at a pressure of the sweep, between its states by a spline of γ_eff: an estimate to start from (Pa).

        Beyond the sweep it is that of the nearest end.
        """
        x = np.log(np.clip(pressure, *self.pressure[[0, -1]]))
        return self.contacts[0].theory.detachment_stress(self._effective_work(x))

    @cached_property
    def _effective_work(self) -> CubicSpline:
        """γ_eff at all magnifications over x = ln p."""
        works = [contact.effective_work_of_adhesion for contact in self.contacts]
        return CubicSpline(np.log(self.pressure), works)

    def _integral(self, start: np.ndarray, end: np.ndarray) -> np.ndarray:
        """∫ (dU/dx) e^(−x) dx between points of one interval of the spline, by Gauss's rule."""
        points, weights = np.polynomial.legendre.leggauss(6)
        half = 0.5 * (end - start)
        inside = start[..., None] + half[..., None] * (1 + points)
        return half * np.sum(weights * self._spline(inside, 1) * np.exp(-inside), axis=-1)

    @cached_property
    def _above(self) -> np.ndarray:
        """ū at the pressures of the sweep; beyond its end the rest of U is gained at that pressure."""
        parts = self._integral(self._spline.x[:-1], self._spline.x[1:])
        end = self.contacts[-1]
        rest = (end.theory.full_contact_energy - end.energy) / self.pressure[-1]
        return np.concatenate([np.cumsum(parts[::-1])[::-1], [0.0]]) + rest

    def _remaining(self, x: np.ndarray) -> np.ndarray:
        """ū at x = ln p within the sweep."""
        nodes = self._spline.x
        interval = np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, nodes.size - 2)
        return self._above[interval + 1] + self._integral(x, nodes[interval + 1])


def separation_curve(
    theory: PerssonTheory,
    lowest: float,
    per_decade: int = 12,
    tolerance: float = TOLERANCE,
    max_iterations: int = MAX_ITERATIONS,
) -> SeparationCurve:
    """Sweep the pressure from full contact down to ``lowest`` > 0, each state started from the one before.

    Parameters
    ----------
    theory : PerssonTheory
        Interface and choices.
    lowest : float
        Smallest pressure of interest (Pa).
    per_decade : int, optional
        Pressures per decade.
    tolerance, max_iterations : optional
        Of each state, see :func:`theory.persson.solver.solve`.

    Raises
    ------
    ValueError
        If ``lowest`` is not positive or beyond full contact.

    Warns
    -----
    NotConverged
        If states of the sweep did not converge.
    """
    highest = _FULL_CONTACT * theory.stress_scale
    if not 0 < lowest < highest:
        raise ValueError(f"lowest = {lowest:g} Pa: must lie between 0 and full contact at {highest:g} Pa")
    count = max(8, int(np.ceil(per_decade * np.log10(highest / lowest))))
    pressure = np.geomspace(highest, lowest, count + 1)
    contacts: list[PerssonContact] = []
    for p in pressure:
        contacts.append(solve(theory, float(p), _extrapolated(contacts[-3:]), tolerance, max_iterations))
    curve = SeparationCurve(pressure[::-1], tuple(reversed(contacts)))
    _warn_of_unconverged("mean gap", contacts)
    return curve


def _extrapolated(contacts: Sequence[PerssonContact]) -> np.ndarray | str:
    """First σ_a of the next state of a sweep, from up to three before: γ_eff as a polynomial of ln p."""
    if not contacts:
        return "adhered"
    coefficients = {1: (1,), 2: (-1, 2), 3: (1, -3, 3)}[len(contacts)]
    works = [contact.effective_work_of_adhesion for contact in contacts]
    work = sum(share * each for share, each in zip(coefficients, works, strict=True))
    return contacts[-1].theory.detachment_stress(np.asarray(work))


def _warn_of_unconverged(quantity: str, contacts: Sequence[PerssonContact]) -> None:
    lost = sorted((contact for contact in contacts if not contact.converged), key=lambda contact: contact.pressure)
    if lost:
        warnings.warn(
            f"{quantity}: {len(lost)} of {len(contacts)} states did not converge, "
            f"at pressures from {lost[0].pressure:.3g} to {lost[-1].pressure:.3g} Pa; {lost[0].advice}",
            NotConverged,
            stacklevel=3,
        )


def energy_defect(theory: PerssonTheory, tolerance: float = TOLERANCE, max_iterations: int = MAX_ITERATIONS) -> float:
    """dU/dp at p = 0 on the adhered branch (m): zero without sticking, else what makes ū diverge there.

    Parameters
    ----------
    theory : PerssonTheory
        Interface and choices.
    tolerance, max_iterations : optional
        Of each state, see :func:`theory.persson.solver.solve`.

    Warns
    -----
    NotConverged
        If a state that it is taken from did not converge.
    """
    at_rest = solve(theory, 0.0, "adhered", tolerance, max_iterations)
    if at_rest.detached:
        _warn_of_unconverged("energy defect", [at_rest])
        return 0.0
    # Central difference: its error is of second order in a step that the iteration's tolerance still allows.
    step = 1e-3 * theory.stress_scale
    pressed = solve(theory, step, at_rest.detachment_stress, tolerance, max_iterations)
    pulled = solve(theory, -step, at_rest.detachment_stress, tolerance, max_iterations)
    _warn_of_unconverged("energy defect", [at_rest, pressed, pulled])
    if pulled.detached:
        return (pressed.energy - at_rest.energy) / step
    return (pressed.energy - pulled.energy) / (2 * step)


def pull_off_pressure(
    theory: PerssonTheory,
    accuracy: float = 1e-3,
    tolerance: float = TOLERANCE,
    max_iterations: int = MAX_ITERATIONS,
) -> float:
    """Pressure <= 0 at which the adhered branch ends (Pa); zero where nothing sticks.

    Steps double until one fails and halve from there: smooth surfaces, whose pull-off is many times the stress of their
    roughness, take some thirty states.

    Parameters
    ----------
    theory : PerssonTheory
        Interface and choices.
    accuracy : float, optional
        Accuracy over the stress scale, or over the pull-off pressure where that is larger.
    tolerance, max_iterations : optional
        Of each state, see :func:`theory.persson.solver.solve`. A state that does not converge counts as lost.

    Warns
    -----
    NotConverged
        If a state of the search did not converge.
    """
    contact = solve(theory, 0.0, "adhered", tolerance, max_iterations)
    tried = [contact]
    step, growth, held = 0.05 * theory.stress_scale, 2.0, 0.0
    while not contact.detached and step > accuracy * max(theory.stress_scale, -held):
        trial = solve(theory, held - step, contact.detachment_stress, tolerance, max_iterations)
        tried.append(trial)
        if trial.detached or not trial.converged:
            step, growth = step / 2, 1.0
        else:
            held, contact, step = held - step, trial, growth * step
    _warn_of_unconverged("pull-off pressure", tried)
    return 0.0 if contact.detached else held - step
