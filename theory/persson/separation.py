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

from theory.persson.gap_integral import GapIntegral
from theory.persson.iteration import IterationOptions
from theory.persson.theory import PerssonContact, PerssonTheory, gap_integral

TOLERANCE, MAX_ITERATIONS = IterationOptions.tolerance, IterationOptions.max_iterations


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
        gap = np.where(swept, self._integral.gap(x), np.nan)
        if np.any(gap < 0):
            warnings.warn(
                f"mean separation down to {np.nanmin(gap):.3g} m: strong adhesion, U(p) is not monotonic",
                NegativeSeparation,
                stacklevel=2,
            )
        return gap

    @cached_property
    def _integral(self) -> GapIntegral:
        return gap_integral(self.contacts)

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
        Of each state, see :meth:`PerssonTheory.at_pressure`.

    Raises
    ------
    ValueError
        If ``lowest`` is not positive or beyond full contact.

    Warns
    -----
    NotConverged
        If states of the sweep did not converge.
    """
    contacts = theory.sweep(lowest, per_decade, tolerance, max_iterations)
    curve = SeparationCurve(np.array([contact.pressure for contact in contacts]), contacts)
    _warn_of_unconverged("mean gap", contacts)
    return curve


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
        Of each state, see :meth:`PerssonTheory.at_pressure`.

    Warns
    -----
    NotConverged
        If a state that it is taken from did not converge.
    """
    at_rest = theory.at_pressure(0.0, "adhered", tolerance, max_iterations)
    if at_rest.detached:
        _warn_of_unconverged("energy defect", [at_rest])
        return 0.0
    # Central difference: its error is of second order in a step that the iteration's tolerance still allows.
    step = 1e-3 * theory.stress_scale
    pressed = theory.at_pressure(step, at_rest.detachment_stress, tolerance, max_iterations)
    pulled = theory.at_pressure(-step, at_rest.detachment_stress, tolerance, max_iterations)
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
        Of each state, see :meth:`PerssonTheory.at_pressure`. A state that does not converge counts as lost.

    Warns
    -----
    NotConverged
        If a state of the search did not converge.
    """
    contact = theory.at_pressure(0.0, "adhered", tolerance, max_iterations)
    tried = [contact]
    step, growth, held = 0.05 * theory.stress_scale, 2.0, 0.0
    while not contact.detached and step > accuracy * max(theory.stress_scale, -held):
        trial = theory.at_pressure(held - step, contact.detachment_stress, tolerance, max_iterations)
        tried.append(trial)
        if trial.detached or not trial.converged:
            step, growth = step / 2, 1.0
        else:
            held, contact, step = held - step, trial, growth * step
    _warn_of_unconverged("pull-off pressure", tried)
    return 0.0 if contact.detached else held - step
