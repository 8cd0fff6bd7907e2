"""One face of both continuum solvers: a state and a target in, a solution out."""

import warnings
from collections.abc import Sequence
from functools import partial
from typing import Any, Protocol

import numpy as np

from bem_adhesion.adhesive.contact import AdhesiveContact
from bem_adhesion.contacts.free_boundary import FreeBoundaryContact
from bem_adhesion.contacts.plastic import PlasticContact
from bem_adhesion.hard_wall.contact import HardWallContact
from bem_adhesion.operators.trace import Trace
from bem_adhesion.process_zone import process_zone, resolved_length, resolves, resolving_shape, too_coarse
from bem_adhesion.solution import Solution
from contact_study.numerics.arguments import field, grid_of, positive
from contact_study.numerics.grid import Grid
from contact_study.physics.laws.base import TractionLaw
from contact_study.physics.solids import Elasticity, Viscoelastic, elasticity_of
from contact_study.units import length


class Contact(Protocol):
    """One rough surface against an elastic solid, to be solved at any number of loads."""

    def separated(self) -> np.ndarray:
        """The state of surfaces out of reach of each other, where a path begins, shape (y, x)."""

    def step(self, state: np.ndarray | Solution, target: float) -> Solution:
        """The state that follows from one under a new load.

        Parameters
        ----------
        state : numpy.ndarray or Solution
            :meth:`separated`, or the solution of an earlier step, or its ``state``.
        target : float
            Mean pressure (Pa), mean gap or approach (m), as ``control`` of :func:`rough_contact` says.

        Returns
        -------
        Solution
            The state; whether it converged it says itself.

        Raises
        ------
        ValueError
            If the target is no finite number or the state is none of this contact.
        """

    def stiffness(self, solution: Solution) -> float:
        """−dp/dū of a state of this contact (Pa/m), by its linearised equations."""


def rough_contact(
    height: np.ndarray,
    size: float | Sequence[float],
    elasticity: Elasticity | float,
    law: TractionLaw,
    control: str = "pressure",
    tolerance: float | None = None,
    max_iterations: int | None = None,
    threads: int = 1,
    boundary: str = "periodic",
    hardness: float | None = None,
    trace: Trace | None = None,
) -> Contact:
    """The contact of a rigid rough surface with an elastic solid, by the solver that its law asks for.

    The contact keeps a copy of the heights. Threads that share one take turns; to solve at the same time each needs
    one of its own.

    Parameters
    ----------
    height : array_like, shape (y, x)
        Heights of the rigid surface, toward the elastic solid (m), continued periodically.
    size : float or pair of float
        Periods along y and x; one number is both (m).
    elasticity : Elasticity or float
        The solid; a number is the contact modulus E* = E / (1 − ν²) of a half-space (Pa).
    law : TractionLaw
        How the surfaces interact.
    control : {"pressure", "gap", "approach"}
        What a step prescribes: the mean pressure (Pa), or the mean gap less the law's equilibrium distance (m), or how
        far the solid comes beyond the place where, undeformed, its surface has that distance to the highest point (m).
        The gap is for periodic boundaries, the approach for free ones and for compressible layers.
    tolerance, max_iterations : optional
        As the solvers' own: :class:`HardWallContact`, :class:`NewtonSolver`.
    threads : int, optional
        Threads of the transforms.
    boundary : {"periodic", "free"}, optional
        Whether surface and solid go on periodically, or the surface ends with its heights and a half-space goes on.
    hardness : float, optional
        Largest pressure that a hard wall without adhesion transmits; points that reach it give way for good (Pa), see
        :class:`PlasticContact`.
    trace : callable, optional
        Called with a :class:`~bem_adhesion.operators.trace.Progress` at each change of phase while a step is solved.

    Raises
    ------
    ValueError
        If an argument is not what it should be; the message names it.

    Warns
    -----
    UserWarning
        Where the grid does not resolve the law, and what would.

    Examples
    --------
    >>> import numpy as np
    >>> from bem_adhesion import LennardJones104, rough_contact
    >>> height = 1e-10 * np.random.default_rng(0).standard_normal((32, 32))
    >>> contact = rough_contact(height, 10e-9, 93.7e9, LennardJones104(work_of_adhesion=0.1, length=3.28e-10))
    >>> pressed = contact.step(contact.separated(), 1e9)
    >>> pulled = contact.step(pressed, -0.1e9)
    >>> bool(pressed.converged and pulled.gap.mean() > pressed.gap.mean())
    True
    """
    if isinstance(elasticity, Viscoelastic):
        raise ValueError("elasticity: a viscoelastic solid needs times; use ViscoelasticContact")
    heights = field("height", height)
    grid = grid_of(heights, size)
    made = contact_between(
        heights, grid, elasticity, law, control, tolerance, max_iterations, threads, boundary, hardness, trace
    )
    warn_of_coarse_grid(grid, elasticity_of(elasticity), law)
    return made


def warn_of_coarse_grid(grid: Grid, solid: Elasticity, law: TractionLaw) -> None:
    """Say to who made a contact where its grid does not resolve its law, as the review of a study does."""
    zone = process_zone(solid.softest_modulus(max(grid.size), 2 * min(grid.spacing)), law)
    spacing = max(grid.spacing)
    if resolves(spacing, zone):
        return
    y, x = resolving_shape(grid.size, zone)
    warnings.warn(
        f"{too_coarse(spacing, zone)}; {y} x {x} points resolve it, or the law with a length of "
        f"{length(resolved_length(law, spacing, zone))} and the same work of adhesion",
        stacklevel=3,
    )


def contact_between(
    heights: np.ndarray,
    grid: Grid,
    elasticity: Elasticity | float,
    law: TractionLaw,
    control: str = "pressure",
    tolerance: float | None = None,
    max_iterations: int | None = None,
    threads: int = 1,
    boundary: str = "periodic",
    hardness: float | None = None,
    trace: Trace | None = None,
) -> Contact:
    """As :func:`rough_contact`, of heights that are the contact's own, on their grid, without a word about it."""
    options: dict[str, Any] = {"control": control, "threads": threads, "trace": trace}
    options |= {} if tolerance is None else {"tolerance": tolerance}
    options |= {} if max_iterations is None else {"max_iterations": max_iterations}
    if not isinstance(law, TractionLaw):
        raise ValueError(
            f"law = {law!r}: must be a law such as LennardJones104(work_of_adhesion, length) or HardWall()"
        )
    if boundary not in ("periodic", "free"):
        raise ValueError(f"boundary = {boundary!r}: must be 'periodic' or 'free'")
    bare_wall = law.has_wall and not law.attracts
    if hardness is not None:
        if not bare_wall:
            raise ValueError(
                f"hardness: known of a hard wall without adhesion, not of {type(law).__name__}; leave one out"
            )
        options["hardness"] = positive("hardness", hardness, "Pa")
    if boundary == "free":
        if hardness is None:
            return FreeBoundaryContact(heights, grid, elasticity, law, **options)
        return PlasticContact(
            heights, partial(FreeBoundaryContact, grid=grid, elasticity=elasticity, law=law, **options)
        )
    if bare_wall:
        if hardness is None:
            return HardWallContact(heights, grid, elasticity, **options)
        return PlasticContact(heights, partial(HardWallContact, grid=grid, elasticity=elasticity, **options))
    return AdhesiveContact(heights, grid, elasticity, law, **options)
