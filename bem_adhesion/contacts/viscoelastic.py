"""Contact of a linear viscoelastic half-space, in steps of time.

A branch of modulus E_i and time τ_i carries the displacement h_i, h_i' = u' − h_i/τ_i. Over a step Δt in which the
surface u moves evenly this is exact (the usual update of a Prony series, after R. L. Taylor, K. S. Pister & G. L.
Goudreau (1970)):

    h_i → e_i h_i + a_i (u_new − u),    e_i = exp(−Δt/τ_i),    a_i = (1 − e_i) τ_i/Δt,

so that the pressure at its end is that of an *elastic* half-space of modulus E = E_∞ + Σ E_i a_i under the displacement
u_new + v,

    p = (E q/2) (u_new + v),    v = Σ E_i (e_i h_i − a_i u)/E,

v known. A step of time is one contact of that solid with the heights h + v, by the solvers for elastic solids, whatever
the law. Of the second order in Δt, and exact where the surface does move evenly.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bem_adhesion.contacts.rough_contact import Contact, contact_between, warn_of_coarse_grid
from bem_adhesion.solution import Solution
from contact_study.numerics import fourier
from contact_study.numerics.arguments import field, grid_of, positive, step_arguments
from contact_study.physics.laws.base import TractionLaw
from contact_study.physics.solids import HalfSpace, Viscoelastic


class ViscoelasticContact:
    """One rough surface against a viscoelastic half-space, both continued periodically.

    Parameters
    ----------
    height : array_like, shape (y, x)
        Heights of the rigid surface, toward the half-space (m).
    size : float or pair of float
        Periods along y and x (m).
    solid : Viscoelastic
        The half-space.
    law : TractionLaw
        How the surfaces interact.
    **options
        ``control``, ``tolerance``, ``max_iterations`` and ``threads`` of :func:`rough_contact`.

    Raises
    ------
    ValueError
        As :func:`rough_contact`.

    Warns
    -----
    UserWarning
        As :func:`rough_contact`.
    """

    def __init__(
        self,
        height: np.ndarray,
        size: float | tuple[float, float],
        solid: Viscoelastic,
        law: TractionLaw,
        **options: object,
    ):
        self.height = field("height", height)
        self.solid = solid
        grid = grid_of(self.height, size)
        self._weight = grid.multiplicity * HalfSpace(1.0).stiffness_on(grid)
        self._make: Callable[[np.ndarray, float], Contact] = lambda heights, modulus: contact_between(
            heights,
            grid,
            modulus,
            law,
            **options,  # type: ignore[arg-type]
        )
        self._wall = law.has_wall and not law.attracts
        self._moduli = np.array(solid.branch_moduli)
        self._times = np.array(solid.relaxation_times)
        self._control = str(options.get("control", "pressure"))
        self._apart = self._make(self.height, solid.contact_modulus).separated()
        warn_of_coarse_grid(grid, solid, law)

    @property
    def first_gap(self) -> float:
        """Mean gap of the surfaces before they come within reach of each other (m)."""
        return (
            float(self.height.max() - self.height.mean()) if self._wall else float((self._apart - self.height).mean())
        )

    def separated(self) -> np.ndarray:
        """The state at rest and without contact, shape (2 + branches, y, x), see :meth:`step`."""
        state = np.zeros((2 + self._moduli.size, *self.height.shape))
        state[0] = 0.0 if self._wall else np.inf
        return state

    def step(self, state: np.ndarray | Solution, target: float, duration: float) -> tuple[Solution, float]:
        """The contact after a time in which the surface moves evenly.

        Parameters
        ----------
        state : numpy.ndarray, shape (2 + branches, y, x), or Solution
            The solution of the step before, its ``state``, or :meth:`separated`: where the solver starts from (the gap,
            infinite if surfaces are apart; of a hard wall the pressure), the displacement u, and h_i of each branch
            (m).
        target : float
            Mean pressure (Pa) or mean gap (m) at the end of the step.
        duration : float
            Δt (s).

        Returns
        -------
        Solution
            At the end. ``elastic_energy`` is what all springs store.
        float
            Energy dissipated in the step, per area (J/m²).

        Raises
        ------
        ValueError
            If the duration is not positive, the state has another shape, or as the solver for elastic solids.
        """
        positive("duration", duration, "s")
        shape = (2 + self._moduli.size, *self.height.shape)
        state, target = step_arguments(self._control, target, state, shape)
        start, before, carried = state[0], state[1], state[2:]
        shares = duration / self._times
        decay, gain = np.exp(-shares), -np.expm1(-shares) / shares
        modulus = self.solid.contact_modulus + float(self._moduli @ gain)
        memory = np.tensordot(self._moduli * decay, carried, 1) - float(self._moduli @ gain) * before
        memory /= modulus
        heights = self.height + memory
        contact = self._make(heights, modulus)
        if not self._wall:
            start = heights + start if np.isfinite(start).all() else contact.separated()
        found = contact.step(start, target)
        surface = found.displacement - memory
        displacement = surface - surface.mean()
        change = displacement - before
        after = decay[:, None, None] * carried + gain[:, None, None] * change
        stored, dissipated = self._energies(displacement, change, carried, shares)
        kept = found.state if self._wall else found.gap
        solution = replace(
            found,
            state=np.stack([kept, displacement, *after]),
            displacement=surface,
            elastic_energy=stored,
        )
        return solution, dissipated

    def _energies(
        self, displacement: np.ndarray, change: np.ndarray, carried: np.ndarray, shares: np.ndarray
    ) -> tuple[float, float]:
        """What all springs store at the end of a step, and what it dissipated, per area (J/m²).

        Within the step h = A exp(−t/τ) + B, B = τ u', and a branch dissipates E h²/τ in time.
        """
        product = self._product
        moved, shown = fourier.transform(change), fourier.transform(displacement)
        stored = 0.5 * self.solid.contact_modulus * product(shown, shown)
        dissipated = 0.0
        for modulus, share, first in zip(self._moduli, shares, carried, strict=True):
            even = moved / share
            fading = fourier.transform(first) - even
            last = np.exp(-share) * fading + even
            stored += 0.5 * modulus * product(last, last)
            dissipated += modulus * (
                -0.5 * np.expm1(-2 * share) * product(fading, fading)
                - 2 * np.expm1(-share) * product(fading, even)
                + share * product(even, even)
            )
        return stored, dissipated

    def _product(self, one: np.ndarray, other: np.ndarray) -> float:
        """Mean of f K g over the surface for a contact modulus of one, from the transforms of f and g."""
        return float(np.sum(self._weight * (one.real * other.real + one.imag * other.imag)))
