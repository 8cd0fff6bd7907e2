"""Records of a contact's states, and the entries of their quantities in a dataset."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from contact_study.numerics.distributions import Bins

Value = float | int | bool | str | np.ndarray

FLAG = {"flag_values": np.array([-1, 0, 1], np.int8), "flag_meanings": "absent no yes"}

# Columns of :attr:`InterfaceState.passed`.
PASSED = ("pressure", "separation", "energy")


class Solved(Protocol):
    """Attributes of the solutions of all solvers."""

    @property
    def pressure(self) -> np.ndarray: ...
    @property
    def relative_contact_area(self) -> float: ...
    @property
    def mean_gap(self) -> float: ...
    @property
    def converged(self) -> bool: ...
    @property
    def detached(self) -> bool: ...
    @property
    def residual(self) -> float: ...
    @property
    def iterations(self) -> int: ...
    @property
    def fft_pairs(self) -> float: ...
    @property
    def message(self) -> str: ...


def in_two_lines(solution: Solved) -> str:
    """Summarise a solution for the prompt."""
    return (
        f"<{type(solution).__name__}: mean pressure {np.mean(solution.pressure):.4g} Pa, relative contact area "
        f"{solution.relative_contact_area:.4g}, mean gap {solution.mean_gap:.4g} m,\n "
        f"{' x '.join(map(str, solution.pressure.shape))} points, residual {solution.residual:.1e}, "
        f"{solution.iterations} iterations: {solution.message}>"
    )


@dataclass(frozen=True)
class SolverReport:
    """Outcome and work of a solver for a state.

    Attributes
    ----------
    converged : bool
        Whether the tolerance is met.
    detached : bool
        Whether the surfaces are detached; never at a prescribed gap or approach.
    residual : float
        Error left in the equations, in units of their own scales.
    iterations : int
        Iterations of the solver.
    fft_pairs : float
        Pairs of Fourier transforms, in equivalents of the finest grid in double precision.
    force_evaluations : int or None
        Evaluations of the interface forces, if the model counts them.
    message : str
        Message on the step; empty if there is none.
    complementarity_residual : float or None
        Violation of the conditions of a wall, if the law has one beside its tractions.
    acceptance_rate : float or None
        Accepted fraction of the proposals of thermal sampling.
    """

    converged: bool
    detached: bool
    residual: float
    iterations: int
    fft_pairs: float
    force_evaluations: int | None = None
    message: str = ""
    complementarity_residual: float | None = None
    acceptance_rate: float | None = None

    @classmethod
    def of(cls, solution: Solved, **known: int | float | None) -> "SolverReport":
        """Make the report on a solution, with further fields ``known``; a plain equilibrium has no message."""
        return cls(
            solution.converged,
            solution.detached,
            solution.residual,
            solution.iterations,
            solution.fft_pairs,
            message="" if solution.converged and not solution.detached else solution.message,
            **known,  # type: ignore[arg-type]
        )


def usable(record: Any) -> Any:
    """Whether a state is converged and in contact: the one rule for every record of states.

    Parameters
    ----------
    record : mapping
        Quantities by name, of which ``relative_contact_area``, ``converged`` and ``detached`` count where present: an
        :class:`xarray.Dataset`, or a mapping of arrays or numbers.

    Returns
    -------
    bool, array or xarray.DataArray
        Of the shape of these quantities.
    """
    there: Any = np.True_
    if "relative_contact_area" in record:
        there = ~np.isnan(record["relative_contact_area"])
    if "converged" in record:
        there = there & (record["converged"] == 1)
    return there & (record["detached"] != 1) if "detached" in record else there


@dataclass(frozen=True)
class ThermalMotion:
    """Clock and energies of atoms in motion.

    Attributes
    ----------
    time : float
        Time since the motion began (s).
    temperature : float
        Kinetic, against a driven plane, of the velocities in the middle of time steps (K).
    kinetic_energy : float
        Of all nodes and the rigid plane against the substrate, of the velocities at the end of the time step, per
        nominal area (J/m²).
    mechanical_energy : float
        That, the whole elastic and the interaction energy, and the load's, its pressure times the height of the rigid
        plane over the substrate's mean plane (J/m²).
    """

    time: float
    temperature: float
    kinetic_energy: float
    mechanical_energy: float


@dataclass(frozen=True)
class SlowMotion:
    """Time of overdamped motion, over the friction of a unit of area (m/Pa), and mean pressure (Pa)."""

    time: float
    load: float


@dataclass(frozen=True)
class Plasticity:
    """Plastic indentation of each point so far (m), shape (ny, nx), and hardness (Pa)."""

    indentation: np.ndarray
    hardness: float


@dataclass(frozen=True)
class Relaxation:
    """Time of a viscoelastic solid since the path began (s), and its dissipated energy (J/m²)."""

    time: float
    dissipated: float


@dataclass(frozen=True)
class OwnSteps:
    """Energy dissipated by jumps of a path with adaptive steps.

    Attributes
    ----------
    dissipated : float
        Per nominal area (J/m²).
    uncertain : float
        Uncertainty, as the position of a jump within its step is unknown (J/m²).
    """

    dissipated: float
    uncertain: float


@dataclass(frozen=True)
class InterfaceState:
    """State of a contact that a simulation yields for a point of the loading path.

    Attributes
    ----------
    gap : numpy.ndarray, shape (ny, nx)
        Local gap (m); infinite if the surfaces are detached under a load.
    pressure : numpy.ndarray, shape (ny, nx)
        Local pressure (Pa), compression positive.
    contact : numpy.ndarray, shape (ny, nx)
        Whether a point counts as contact.
    equilibrium_distance : float
        Distance of flat surfaces without load, from which mean gaps are measured (m).
    mean_separation : float
        Distance of the mean planes of block and surface minus the equilibrium distance (m).
    elastic_energy, interaction_energy : float
        Per nominal area (J/m²).
    report : SolverReport
        The solver's.
    restart : mapping
        State that the next point of the path starts from.
    spacing : tuple of float or None
        Distance of points along y and x (m).
    contact_stiffness : float or None
        −dp/dū (Pa/m), if the study asks for it.
    own_steps : OwnSteps or None
        Dissipation of a path with adaptive steps.
    passed : numpy.ndarray, shape (n, 3), or None
        Mean pressure (Pa), mean separation (m) and energy (J/m²) of each state since the last point, this one last, of
        a path with steps between its points. Detached surfaces have the load and an infinite separation.
    motion : ThermalMotion or None
        Clock and energies of atoms in motion.
    slow_motion : SlowMotion or None
        Clock and load of overdamped motion.
    atoms : mapping
        The atoms one by one, as :mod:`contact_study.results.observables.atoms` names them, where the study asks for
        them.
    plasticity : Plasticity or None
        Indentation of a contact with a hardness.
    relaxation : Relaxation or None
        Clock and dissipation of a viscoelastic solid.
    periodic : bool
        Whether the map continues at its opposite edges; False for free boundaries.
    """

    gap: np.ndarray
    pressure: np.ndarray
    contact: np.ndarray
    equilibrium_distance: float
    mean_separation: float
    elastic_energy: float
    interaction_energy: float
    report: SolverReport
    restart: Mapping[str, np.ndarray] = field(default_factory=dict)
    spacing: tuple[float, float] | None = None
    contact_stiffness: float | None = None
    own_steps: OwnSteps | None = None
    passed: np.ndarray | None = None
    motion: ThermalMotion | None = None
    slow_motion: SlowMotion | None = None
    atoms: Mapping[str, np.ndarray] = field(default_factory=dict)
    plasticity: Plasticity | None = None
    relaxation: Relaxation | None = None
    periodic: bool = True


@dataclass(frozen=True)
class Ensemble:
    """States of one point of the loading path, to be averaged, or of which the last one counts.

    Attributes
    ----------
    states : iterator of InterfaceState
        One after the other, as often as they are to count; read once. The ``restart`` of each holds all that the next
        one follows from; the ``report`` of the last one is the point's.
    discarded : int or None, optional
        How many of them come before those whose mean is taken; None: only the last one counts. The series has all.
    """

    states: Iterator[InterfaceState]
    discarded: int | None = 0


@dataclass(frozen=True)
class Variable:
    """Entry of a quantity in a dataset.

    Parameters
    ----------
    units : str
        UDUNITS.
    long_name : str
        Meaning, as a noun phrase of at most 90 characters.
    dims : tuple of str
        Dimensions beyond those of the sweep.
    kind : str
        ``"float"``, ``"count"``, ``"flag"`` or ``"text"``.
    attrs : dict
        Further attributes.
    """

    units: str
    long_name: str
    dims: tuple[str, ...] = ("step",)
    kind: str = "float"
    attrs: dict[str, Any] = field(default_factory=dict)

    @property
    def empty(self) -> Any:
        """Value for a missing point."""
        return {"float": np.nan, "count": np.int32(-1), "flag": np.int8(-1), "text": ""}[self.kind]

    @property
    def dtype(self) -> Any:
        """Type in memory."""
        return {"float": np.float64, "count": np.int32, "flag": np.int8, "text": object}[self.kind]

    @property
    def encoding(self) -> dict[str, Any]:
        """Encoding in the file."""
        if self.kind == "text":
            return {}
        if self.kind == "flag":  # integers for the reader too; "absent" is one of the flag's values
            return {"_FillValue": None}
        fill = np.nan if self.kind == "float" else self.empty
        compressed = {"zlib": True, "complevel": 1, "shuffle": True} if len(self.dims) > 1 else {}
        return {"_FillValue": fill, **compressed}


@dataclass(frozen=True)
class Observable:
    """Quantities that one function reads off a state.

    Parameters
    ----------
    variables : mapping
        Their entries by name.
    read : callable
        Function of a state and the study's bins that returns the quantities by name, as far as the state has them.
    averaged : bool, optional
        Whether an ensemble has the mean over its states, not the value of the last one.
    """

    variables: Mapping[str, Variable]
    read: Callable[[InterfaceState, Bins], Mapping[str, Value]]
    averaged: bool = True
