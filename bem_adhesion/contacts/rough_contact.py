"""The contact of a rough surface: one function that chooses the solver, and what wraps one: free edges, yielding."""

import math
import warnings
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Protocol

import numpy as np

from bem_adhesion.adhesive.contact import AdhesiveContact
from bem_adhesion.contacts.plastic import PlasticContact
from bem_adhesion.free_half_space import PADDING, FreeHalfSpace
from bem_adhesion.hard_wall.contact import HardWallContact
from bem_adhesion.operators import Trace
from bem_adhesion.solution import Solution
from contact_study.inputs.units import length
from contact_study.numerics.arguments import field, grid_of, positive, step_arguments
from contact_study.numerics.grid import Grid
from contact_study.physics.laws import TractionLaw
from contact_study.physics.process_zone import process_zone, resolved_length, resolves, resolving_shape, too_coarse
from contact_study.physics.solids import Elasticity, HalfSpace, Viscoelastic, elasticity_of


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
        """Return the state of separated surfaces, where a path begins: the start of :meth:`step`, out of reach."""

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
    work_of_adhesion: np.ndarray | None = None,
    machine_stiffness: float | None = None,
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
        free ones, for compressible layers and with a ``machine_stiffness``.
    tolerance, max_iterations : float and int, optional
        Residual of a solution and limit of outer iterations, in place of the solver's defaults. A hard wall takes the
        largest gap in contact over the rms height (1e-10), adhesion the largest unbalanced stress over E* (1e-8).
    threads : int, optional
        Threads of the transforms.
    boundary : {"periodic", "free", "free_x", "free_y"}, optional
        Whether surface and solid are periodic, or the surface ends at its last points on a half-space, along both axes
        or along one, with the other periodic. Approaches of the latter count from the surface as far away as ``size``
        along the free axis.
    hardness : float, optional
        Largest pressure; points that reach it are indented permanently (Pa).
    trace : callable, optional
        Called with a :class:`~bem_adhesion.operators.Progress` at each change of phase while a step is solved.
    work_of_adhesion : array_like, shape (y, x), optional
        Local work of adhesion (J/m²) in place of the law's. Its ratio to that of the law multiplies energy and traction
        at the point: attraction and repulsion, outside a wall the attraction, which may vanish there. Equilibrium
        distance and range stay.
    machine_stiffness : float, optional
        Spring in series with the solid under ``control="approach"`` (N/m): the approach is that of the spring's far
        end, the solid's is shorter by force over stiffness. Energies are those without the spring.

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
    options: dict[str, Any] = {
        "tolerance": tolerance,
        "max_iterations": max_iterations,
        "threads": threads,
        "trace": trace,
        "work_of_adhesion": work_of_adhesion,
        "machine_compliance": machine_compliance_of(machine_stiffness, control, grid),
    }
    made = contact_between(heights, grid, elasticity, law, boundary, hardness, control=control, **options)
    warn_of_coarse_grid(grid, elasticity_of(elasticity), law, work_of_adhesion)
    return made


def machine_compliance_of(stiffness: float | None, control: str, grid: Grid) -> float:
    """Return the compliance per area of a machine of a stiffness in N/m (m/Pa); zero of a rigid one."""
    if stiffness is None:
        return 0.0
    if control != "approach":
        raise ValueError(f"machine_stiffness: belongs to control = 'approach', not '{control}'; leave it out")
    return math.prod(grid.size) / positive("machine_stiffness", stiffness, "N/m")


def _local_work(given: np.ndarray, shape: tuple[int, ...], law: TractionLaw) -> np.ndarray:
    """Check a map of the work of adhesion (J/m²) for a law."""
    work = field("work_of_adhesion", given)
    if not law.attracts:
        raise ValueError(f"work_of_adhesion: {type(law).__name__} does not attract; leave it out")
    if work.shape != shape:
        raise ValueError(f"work_of_adhesion: has the shape {work.shape}, the heights {shape}; give one value a point")
    least = float(work.min())
    if least < 0 or not work.any() or (least == 0 and not law.has_wall):
        limit = "negative" if law.has_wall else "zero or less, where the law would not repel either"
        raise ValueError(f"work_of_adhesion: its smallest value is {least:g} J/m²; none may be {limit}")
    return work


def warn_of_coarse_grid(
    grid: Grid, solid: Elasticity, law: TractionLaw, work_of_adhesion: np.ndarray | None = None
) -> None:
    """Warn the caller of a public function if its grid does not resolve the law, as the review of a study does."""
    zone = process_zone(solid.softest_modulus(max(grid.size), 2 * min(grid.spacing)), law)
    if work_of_adhesion is not None:
        zone *= law.work_of_adhesion / float(np.max(work_of_adhesion))
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
    if boundary not in ("periodic", *PADDING):
        raise ValueError(f"boundary = {boundary!r}: must be 'periodic', 'free', 'free_x' or 'free_y'")
    if "work_of_adhesion" in options:
        options["work_of_adhesion"] = _local_work(options["work_of_adhesion"], heights.shape, law)
    if hardness is not None:
        options["hardness"] = positive("hardness", hardness, "Pa")
        if law.bare_wall:  # of errors: a surface flattened everywhere has no rms height
            options["unit"] = float(heights.std()) or None
    adhesive: Any = AdhesiveContact if boundary == "periodic" else partial(FreeBoundaryContact, boundary=boundary)
    make: Any = HardWallContact if law.bare_wall and boundary == "periodic" else partial(adhesive, law=law)
    make = partial(make, grid=grid, elasticity=elasticity, **options)
    return make(heights) if hardness is None else PlasticContact(heights, make, hardness)


class FreeBoundaryContact:
    """A surface of finite extent along one or both axes, its points centres of cells, on a half-space.

    It is under a force or at an approach.
    """

    def __init__(
        self,
        height: np.ndarray,
        grid: Grid,
        elasticity: Elasticity | float,
        law: TractionLaw,
        machine_compliance: float = 0.0,
        boundary: str = "free",
        **options: Any,
    ):
        solid = elasticity_of(elasticity)
        if type(solid) is not HalfSpace:
            raise ValueError(f"elasticity = {solid!r}: free boundaries are those of a half-space")
        control = options.get("control", "pressure")
        if control not in ("pressure", "approach"):
            raise ValueError(f"control = {control!r}: with free boundaries 'pressure' or 'approach'")
        self.height, self.law, self.control = height, law, control
        self.window = slice(grid.shape[0]), slice(grid.shape[1])
        down, across = PADDING[boundary]
        shape, size = (down * grid.shape[0], across * grid.shape[1]), (down * grid.size[0], across * grid.size[1])
        self._grid = Grid(shape, size)
        free = FreeHalfSpace(solid.contact_modulus, boundary)
        self._mean_stiffness = free.mean_stiffness_on(self._grid)
        self.share = grid.points / self._grid.points
        options["machine_compliance"] = machine_compliance / self.share
        heights = np.full(self._grid.shape, -np.inf if law.bare_wall else float(height.min()))
        heights[self.window] = height
        self.padded: HardWallContact | AdhesiveContact
        if law.bare_wall:
            self.padded = HardWallContact(heights, self._grid, free, **options)
        else:
            self.padded = AdhesiveContact(heights, self._grid, free, law, window=self.window, **options)

    def separated(self) -> np.ndarray:
        """Return the state of separated surfaces, on the padded grid."""
        return self.padded.separated()

    def step(self, state: np.ndarray | Solution, target: float) -> Solution:
        """Find the state under a load, see :meth:`Contact.step`; its ``state`` alone is on the padded grid."""
        state, target = step_arguments(self.control, target, state, self._grid.shape)
        found = self.padded.step(state, target * self.share if self.control == "pressure" else target)
        fields = found.gap, found.pressure, found.displacement, found.plastic_indentation
        inside: Any = [None if each is None else np.ascontiguousarray(each[self.window]) for each in fields]
        gap, pressure, displacement, yielded = inside
        mean_pressure = float(pressure.mean())
        plane = float(found.displacement.mean()) - mean_pressure * self.share / self._mean_stiffness
        # Half the work of the pressures, at each point from the undeformed surface to the displacement.
        elastic = 0.5 * float(np.mean(pressure * (displacement - plane)))
        return replace(
            found,
            displacement=displacement,
            gap=gap,
            pressure=pressure,
            plastic_indentation=yielded,
            elastic_energy=elastic,
            interaction_energy=found.interaction_energy / self.share,
            plane=plane,
        )

    def stiffness(self, solution: Solution) -> float:
        """Return −dp/d(position of the undeformed surface), p the force over the area of the grid (Pa/m)."""
        inner = self.padded.stiffness(solution)
        # In series: the mean of the padded surface, and the undeformed surface beyond it.
        return 1 / (self.share * (1 / inner + 1 / self._mean_stiffness)) if inner else 0.0
