"""Mean separation ū(p) = ∫_p^∞ (dU/dp') dp'/p' along the adhered branch, from full contact downward; pull-off.

Yang, Persson, Israelachvili and Rosenberg, EPL 84, 46004 (2008), eq. (6). At p = 0 it diverges.
"""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline

from theory.persson.interface import IterationOptions
from theory.persson.theory import PerssonContact, PerssonTheory, gap_integral

TOLERANCE, MAX_ITERATIONS = IterationOptions.tolerance, IterationOptions.max_iterations


class NegativeSeparation(UserWarning):
    """The energy of the theory is not monotonic in pressure, so that its mean separation falls below zero."""


class NotConverged(UserWarning):
    """States of a sweep, which determine a mean gap or a limit of adhesion, did not converge."""


@dataclass(frozen=True)
class SeparationCurve:
    """Hold the mean separation over pressure on the adhered branch.

    Attributes
    ----------
    pressure, contacts : numpy.ndarray, tuple of PerssonContact
        Increasing pressures > 0 of the sweep (Pa), and the state at each.

    Examples
    --------
    :func:`separation_curve` returns one.
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
        """True if all states converged that contribute to the mean gap at a pressure."""
        first = max(int(np.searchsorted(self.pressure, pressure, side="right")) - 1, 0)
        return all(contact.converged for contact in self.contacts[first:])

    def mean_gap(self, pressure: np.ndarray | float) -> np.ndarray:
        """ū at pressures within the sweep (m); NaN where p <= 0, with a NegativeSeparation warning where ū < 0."""
        p = np.asarray(pressure, dtype=float)
        swept = (p > 0) & (p >= self.pressure[0] * (1 - 1e-12))
        x = np.log(np.where(swept, np.minimum(p, self.pressure[-1]), self.pressure[-1]))
        gap = np.where(swept, self._integral(x), np.nan)
        if np.any(gap < 0):
            words = f"mean separation down to {np.nanmin(gap):.3g} m: strong adhesion, U(p) is not monotonic"
            warnings.warn(words, NegativeSeparation, stacklevel=2)
        return gap

    def detachment_stress_at(self, pressure: float) -> np.ndarray:
        """Estimate of σ_a at a pressure of the sweep, by a spline of γ_eff; beyond the sweep that of its end (Pa)."""
        x = np.log(np.clip(pressure, *self.pressure[[0, -1]]))
        return self.contacts[0].theory.detachment_stress(self._effective_work(x))

    @cached_property
    def _integral(self) -> Callable[[np.ndarray], np.ndarray]:
        return gap_integral(self.contacts)

    @cached_property
    def _effective_work(self) -> CubicSpline:
        return CubicSpline(np.log(self.pressure), [contact.effective_work_of_adhesion for contact in self.contacts])


def separation_curve(
    theory: PerssonTheory,
    lowest: float,
    per_decade: int = 12,
    tolerance: float = TOLERANCE,
    max_iterations: int = MAX_ITERATIONS,
) -> SeparationCurve:
    """Sweep the pressure from full contact down to ``lowest`` > 0, each state started from those before.

    Parameters
    ----------
    theory, lowest, per_decade : PerssonTheory, float, int
        The interface, the smallest pressure of interest (Pa), and pressures per decade.
    tolerance, max_iterations : optional
        Limits of the iteration of each state, see :meth:`PerssonTheory.at_pressure`.

    Returns
    -------
    SeparationCurve
        The states and the mean gap over pressure, with a NotConverged warning if states did not converge.

    Raises
    ------
    ValueError
        If ``lowest`` is not positive or beyond full contact.

    Examples
    --------
    >>> from theory import PerssonTheory, SelfAffineSpectrum, separation_curve
    >>> theory = PerssonTheory(SelfAffineSpectrum(0.8, 1e-9, 6e7, 1.8e8, 7.2e8), 93.7e9, 0.1)
    >>> gaps = separation_curve(theory, lowest=1e8).mean_gap([1e8, 1e9])
    >>> bool(gaps[0] > gaps[1] > 0)
    True
    """
    contacts = theory.sweep(lowest, per_decade, tolerance, max_iterations)
    _warn_of_unconverged("mean gap", contacts)
    return SeparationCurve(np.array([contact.pressure for contact in contacts]), contacts)


def _warn_of_unconverged(quantity: str, contacts: Sequence[PerssonContact]) -> None:
    lost = sorted((contact for contact in contacts if not contact.converged), key=lambda contact: contact.pressure)
    if lost:
        where = f"at pressures from {lost[0].pressure:.3g} to {lost[-1].pressure:.3g} Pa; {lost[0].advice}"
        words = f"{quantity}: {len(lost)} of {len(contacts)} states did not converge, {where}"
        warnings.warn(words, NotConverged, stacklevel=3)


def energy_defect(theory: PerssonTheory, tolerance: float = TOLERANCE, max_iterations: int = MAX_ITERATIONS) -> float:
    """Differentiate the energy at p = 0 on the adhered branch.

    Parameters
    ----------
    theory, tolerance, max_iterations
        As for :func:`separation_curve`.

    Returns
    -------
    float
        dU/dp (m): zero without sticking; otherwise it makes ū diverge as p falls. NotConverged warns if a state did
        not converge.

    Examples
    --------
    >>> from theory import PerssonTheory, SelfAffineSpectrum, energy_defect
    >>> spectrum = SelfAffineSpectrum(0.8, 1e-9, 6e7, 1.8e8, 7.2e8)
    >>> [energy_defect(PerssonTheory(spectrum, 93.7e9, work)) > 0 for work in (0.1, 5.5)]
    [False, True]
    """
    at_rest = theory.at_pressure(0.0, "adhered", tolerance, max_iterations)
    if at_rest.detached:
        _warn_of_unconverged("energy defect", [at_rest])
        return 0.0
    # Central difference: its error is of second order in a step that the iteration's tolerance still allows.
    step, stress = 1e-3 * theory.stress_scale, at_rest.detachment_stress
    pressed, pulled = (theory.at_pressure(p, stress, tolerance, max_iterations) for p in (step, -step))
    _warn_of_unconverged("energy defect", [at_rest, pressed, pulled])
    if pulled.detached:
        return (pressed.energy - at_rest.energy) / step
    return (pressed.energy - pulled.energy) / (2 * step)


def pull_off_pressure(
    theory: PerssonTheory, accuracy: float = 1e-3, tolerance: float = TOLERANCE, max_iterations: int = MAX_ITERATIONS
) -> float:
    """Find the pressure at which the adhered branch ends.

    Steps double until one fails, then halve; smooth surfaces take some thirty states.

    Parameters
    ----------
    theory, tolerance, max_iterations
        As for :func:`separation_curve`. A state that does not converge counts as detached.
    accuracy : float, optional
        Accuracy over the stress scale, or over the pull-off pressure where that is larger.

    Returns
    -------
    float
        Pressure <= 0 (Pa); zero where nothing sticks. NotConverged warns of states that did not converge.

    Examples
    --------
    >>> from theory import PerssonTheory, SelfAffineSpectrum, pull_off_pressure
    >>> spectrum = SelfAffineSpectrum(0.8, 1e-9, 6e7, 1.8e8, 7.2e8)
    >>> [pull_off_pressure(PerssonTheory(spectrum, 93.7e9, work)) < 0 for work in (0.1, 5.5)]
    [False, True]
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
