"""Contact of a linear viscoelastic half-space, in steps of time.

A branch of modulus E_i and time τ_i has the displacement h_i, h_i' = u' − h_i/τ_i. Over a step Δt in which the surface
u moves at a constant rate this is exact (R. L. Taylor, K. S. Pister & G. L. Goudreau (1970)):

    h_i → e_i h_i + a_i (u_new − u),    e_i = exp(−Δt/τ_i),    a_i = (1 − e_i) τ_i/Δt,

so that the pressure at its end is that of an *elastic* half-space of modulus E = E_∞ + Σ E_i a_i against the heights
h + v, v = Σ E_i (e_i h_i − a_i u)/E. The method is of second order in Δt.
"""

from dataclasses import replace

import numpy as np

from bem_adhesion.contacts.rough_contact import (
    Contact,
    contact_between,
    machine_compliance_of,
    warn_of_coarse_grid,
)
from bem_adhesion.solution import Solution
from contact_study.numerics import fourier
from contact_study.numerics.arguments import field, grid_of, positive, step_arguments
from contact_study.physics.laws import TractionLaw
from contact_study.physics.solids import HalfSpace, Viscoelastic


class ViscoelasticContact:
    """One rough surface against a viscoelastic half-space, both periodic.

    Parameters
    ----------
    height : array_like, shape (y, x)
        Heights of the rigid surface, toward the half-space (m).
    size : float or pair of float
        Periods along y and x (m).
    solid : Viscoelastic
        The half-space.
    law : TractionLaw
        The law of interaction.
    machine_stiffness : float, optional
        Spring in series with the solid, for ``control="approach"``, as of :func:`rough_contact` (N/m).
    **options
        ``control``, ``tolerance``, ``max_iterations``, ``threads``, ``trace`` and ``work_of_adhesion`` of
        :func:`rough_contact`.

    Raises
    ------
    ValueError
        As :func:`rough_contact`.

    Warns
    -----
    UserWarning
        As :func:`rough_contact`.

    Examples
    --------
    >>> import numpy as np
    >>> from bem_adhesion import HardWall, Viscoelastic, ViscoelasticContact
    >>> height = 1e-6 * np.cos(np.linspace(0, 2 * np.pi, 32, endpoint=False)) * np.ones((32, 1))
    >>> contact = ViscoelasticContact(height, 1e-4, Viscoelastic(1e6, (9e6,), (1e-3,)), HardWall())
    >>> solution, dissipated = contact.step(contact.separated(), 1e4, duration=1e-4)
    >>> bool(solution.converged and dissipated > 0)
    True
    """

    def __init__(
        self,
        height: np.ndarray,
        size: float | tuple[float, float],
        solid: Viscoelastic,
        law: TractionLaw,
        machine_stiffness: float | None = None,
        **options: object,
    ):
        self.height = field("height", height)
        self.solid = solid
        self._grid = grid_of(self.height, size)
        self._law = law
        self._options = options
        self._weight = self._grid.multiplicity * HalfSpace(1.0).stiffness_on(self._grid)
        self._wall = law.bare_wall
        self._moduli, self._times = np.array(solid.branch_moduli), np.array(solid.relaxation_times)
        self._control = str(options.get("control", "pressure"))
        self._highest = float(self.height.max())
        options["machine_compliance"] = machine_compliance_of(machine_stiffness, self._control, self._grid)
        apart = self._elastic_contact(self.height, solid.contact_modulus).separated()
        mean = self.height.mean()
        # Mean gap of the surfaces before the law acts between them (m).
        self.first_gap = float(self._highest - mean if self._wall else (apart - self.height).mean())
        warn_of_coarse_grid(self._grid, solid, law, options.get("work_of_adhesion"))  # type: ignore[arg-type]

    def _elastic_contact(self, heights: np.ndarray, modulus: float) -> Contact:
        return contact_between(heights, self._grid, modulus, self._law, **self._options)  # type: ignore[arg-type]

    def separated(self) -> np.ndarray:
        """Return the state at rest and without contact, shape (2 + branches, y, x), see :meth:`step`."""
        state = np.zeros((2 + self._moduli.size, *self.height.shape))
        state[0] = 0.0 if self._wall else np.inf
        return state

    def step(self, state: np.ndarray | Solution, target: float, duration: float) -> tuple[Solution, float]:
        """Find the contact after a time in which the surface moves at a constant rate.

        Parameters
        ----------
        state : numpy.ndarray, shape (2 + branches, y, x), or Solution
            The solution of the step before, its ``state``, or :meth:`separated`: the start of the solver (a gap,
            infinite for separated surfaces, or a hard wall's pressure), the displacement u, and h_i of each branch (m).
        target : float
            Mean pressure (Pa), mean gap or approach of the spring's far end (m) at the end of the step.
        duration : float
            Δt (s).

        Returns
        -------
        Solution
            State at the end; ``elastic_energy`` is that of all springs.
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
        memory = (np.tensordot(self._moduli * decay, carried, 1) - float(self._moduli @ gain) * before) / modulus
        heights = self.height + memory
        contact = self._elastic_contact(heights, modulus)
        if self._control == "approach":  # from first touch of the surface itself
            target += float(heights.max()) - self._highest
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
            found, state=np.stack([kept, displacement, *after]), displacement=surface, elastic_energy=stored
        )
        return solution, dissipated

    def _energies(
        self, displacement: np.ndarray, change: np.ndarray, carried: np.ndarray, shares: np.ndarray
    ) -> tuple[float, float]:
        """Return the energy of all springs at the end of a step, and the energy dissipated in it, per area (J/m²)."""

        def product(one: np.ndarray, other: np.ndarray) -> float:
            return float(np.sum(self._weight * (one.real * other.real + one.imag * other.imag)))

        moved, shown = fourier.transform(change), fourier.transform(displacement)
        stored = 0.5 * self.solid.contact_modulus * product(shown, shown)
        dissipated = 0.0  # within the step h = A exp(−t/τ) + B, B = τ u', and a branch dissipates E h²/τ per time
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
