"""The contact of a rough surface: one function that chooses the solver, and the protocol of what it returns."""

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
from contact_study.inputs.units import length
from contact_study.numerics.arguments import field, grid_of, positive
from contact_study.numerics.grid import Grid
from contact_study.physics.laws import TractionLaw
from contact_study.physics.solids import Elasticity, Viscoelastic, elasticity_of


class Contact(Protocol):
    """One rough surface against an elastic solid, for any number of loads.

    Examples
    --------
    >>> import numpy as np
    >>> from bem_adhesion import HardWall, rough_contact
    >>> height = 1e-9 * np.cos(np.linspace(0, 2 * np.pi, 32, endpoint=False)) * np.ones((32, 1))
    >>> contact = rough_contact(height, 1e-7, 1e11, HardWall(), control="gap")
    >>> solution = contact.step(contact.separated(), 0.5e-9)
    >>> bool(solution.converged), float(round(solution.mean_gap * 1e9, 6))
    (True, 0.5)
    """

    def separated(self) -> np.ndarray:
        """Return the state of separated surfaces, where a path begins.

        Returns
        -------
        numpy.ndarray
            Start of :meth:`step`, out of reach of the law.
        """

    def step(self, state: np.ndarray | Solution, target: float) -> Solution:
        """Find the state that follows from another under a new load.

        Parameters
        ----------
        state : numpy.ndarray or Solution
            :meth:`separated`, or the solution of an earlier step of this contact, or its ``state``.
        target : float
            Depends on ``control`` of :func:`rough_contact`. ``"pressure"``: mean pressure, positive in compression
            (Pa). ``"gap"``: mean gap minus the law's equilibrium distance (m). ``"approach"``: displacement of the
            solid beyond the position where its undeformed surface is the equilibrium distance from the highest point
            (m).

        Returns
        -------
        Solution
            The state. Check ``converged``: a step that reaches the iteration limit raises no error.

        Raises
        ------
        ValueError
            If the target is no finite number or the state does not belong to this contact.
        """

    def stiffness(self, solution: Solution) -> float:
        """Compute the contact stiffness −dp/dū of a state, mean pressure over mean gap, by its linearised equations.

        Parameters
        ----------
        solution : Solution
            A converged solution of this contact.

        Returns
        -------
        float
            Stiffness (Pa/m): zero for separated surfaces, infinite in full contact with a wall, negative where the
            tension falls as the gap grows, NaN where it cannot be computed.

        Raises
        ------
        TypeError
            If the argument is not a Solution.

        Examples
        --------
        >>> import numpy as np
        >>> from bem_adhesion import HardWall, rough_contact
        >>> height = 1e-9 * np.cos(np.linspace(0, 2 * np.pi, 32, endpoint=False)) * np.ones((32, 1))
        >>> contact = rough_contact(height, 1e-7, 1e11, HardWall())
        >>> solution = contact.step(contact.separated(), 1e8)
        >>> contact.stiffness(solution) > 0
        True
        """


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
    """Return the contact of a rigid rough surface with an elastic solid, with the solver that the law needs.

    The contact keeps a copy of the heights. Threads that share one contact take turns; for solves at the same time each
    needs its own contact.

    Parameters
    ----------
    height : array_like, shape (y, x)
        Heights of the rigid surface, toward the elastic solid (m).
    size : float or pair of float
        Periods along y and x, or one number for both (m).
    elasticity : Elasticity or float
        The solid; a number is the contact modulus E* = E / (1 − ν²) of a half-space (Pa).
    law : TractionLaw
        The law of interaction.
    control : {"pressure", "gap", "approach"}
        Quantity that a step prescribes, see :meth:`Contact.step`. The gap is for periodic boundaries, the approach for
        free ones and for compressible layers.
    tolerance, max_iterations : float and int, optional
        Residual of a solution and limit of outer iterations, in place of the solver's defaults. A hard wall takes the
        largest gap in contact over the rms height (1e-10), adhesion the largest unbalanced stress over E* (1e-8).
    threads : int, optional
        Threads of the transforms.
    boundary : {"periodic", "free"}, optional
        Whether surface and solid are periodic, or the surface ends at its last points on a half-space.
    hardness : float, optional
        Largest pressure of a hard wall without adhesion; points that reach it are indented permanently (Pa).
    trace : callable, optional
        Called with a :class:`~bem_adhesion.operators.trace.Progress` at each change of phase while a step is solved.

    Returns
    -------
    Contact
        The contact, to be stepped through loads.

    Raises
    ------
    ValueError
        If an argument is invalid; the message names it.

    Warns
    -----
    UserWarning
        If the grid does not resolve the law; the message names a grid that does.

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
    options = {"tolerance": tolerance, "max_iterations": max_iterations, "threads": threads, "trace": trace}
    made = contact_between(heights, grid, elasticity, law, boundary, hardness, control=control, **options)
    warn_of_coarse_grid(grid, elasticity_of(elasticity), law)
    return made


def warn_of_coarse_grid(grid: Grid, solid: Elasticity, law: TractionLaw) -> None:
    """Warn the caller of a public function if its grid does not resolve the law, as the review of a study does."""
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
    boundary: str = "periodic",
    hardness: float | None = None,
    **options: Any,
) -> Contact:
    """Return the contact as :func:`rough_contact`, without a copy of the heights and without a warning."""
    options = {key: value for key, value in options.items() if value is not None}
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
    make: Any = partial(FreeBoundaryContact, law=law)
    if boundary == "periodic":
        make = HardWallContact if bare_wall else partial(AdhesiveContact, law=law)
    make = partial(make, grid=grid, elasticity=elasticity, **options)
    return make(heights) if hardness is None else PlasticContact(heights, make)
