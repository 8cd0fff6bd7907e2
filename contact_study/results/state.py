"""States of a contact on their way from a model to a file, and the entries of their quantities in a dataset."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from contact_study.numerics.distributions import Bins

Value = float | int | bool | str | np.ndarray

FLAG = {"flag_values": np.array([-1, 0, 1], np.int8), "flag_meanings": "absent no yes"}
# Columns of :attr:`InterfaceState.passed`, the last one only of adaptive steps in time.
PASSED = ("pressure", "separation", "energy", "viscous_dissipation")


def in_two_lines(solution: Any) -> str:
    """Summarise a solution of any solver for the prompt."""
    return (
        f"<{type(solution).__name__}: mean pressure {np.mean(solution.pressure):.4g} Pa, relative contact area "
        f"{solution.relative_contact_area:.4g}, mean gap {solution.mean_gap:.4g} m,\n "
        f"{' x '.join(map(str, solution.pressure.shape))} points, residual {solution.residual:.1e}, "
        f"{solution.iterations} iterations: {solution.message}>"
    )


@dataclass(frozen=True)
class SolverReport:
    """Outcome and work of a solver for a state, by their names in a dataset; None where a model has none."""

    converged: bool
    detached: bool  # never at a prescribed gap or approach
    residual: float  # in units of the equations' own scales
    iterations: int
    fft_pairs: float  # in equivalents of the finest grid in double precision
    force_evaluations: int | None = None
    message: str = ""
    complementarity_residual: float | None = None  # of a law with a wall beside its tractions
    acceptance_rate: float | None = None  # of the proposals of thermal sampling

    @classmethod
    def of(cls, solution: Any, **known: int | float | None) -> "SolverReport":
        """Report on the solution of any solver, with further fields ``known``; a plain equilibrium has no message."""
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
    """Whether a state is converged and in contact, of a dataset or mapping, as far as it says: the one rule for all."""
    there: Any = np.True_
    if "relative_contact_area" in record:
        there = ~np.isnan(record["relative_contact_area"])
    if "converged" in record:
        there = there & (record["converged"] == 1)
    return there & (record["detached"] != 1) if "detached" in record else there


@dataclass(frozen=True)
class InterfaceState:
    """State of a contact that a simulation yields for a point of the loading path; fields have the shape (ny, nx)."""

    gap: np.ndarray  # local (m); infinite if the surfaces are detached under a load
    pressure: np.ndarray  # local (Pa), compression positive
    contact: np.ndarray  # whether a point counts as contact
    equilibrium_distance: float  # of flat surfaces without load, from which mean gaps are measured (m)
    mean_separation: float  # distance of the mean planes of block and surface minus the equilibrium distance (m)
    elastic_energy: float  # per nominal area (J/m²)
    interaction_energy: float
    report: SolverReport
    restart: Mapping[str, np.ndarray] = field(default_factory=dict)  # from which the next point of the path starts
    spacing: tuple[float, float] | None = None  # of points along y and x (m)
    # Mean pressure (Pa), mean separation (m), energy (J/m²) and perhaps viscous dissipation so far (J/m²) of each state
    # since the last point, this one last, shape (n, 3 or 4), of a path with steps between its points. Detached surfaces
    # have the load and an infinite separation.
    passed: np.ndarray | None = None
    plastic_indentation: np.ndarray | None = None  # so far (m), of a contact with a hardness
    further: Mapping[str, float] = field(default_factory=dict)  # what only its model has, by names in a dataset
    atoms: Mapping[str, np.ndarray] = field(default_factory=dict)  # one by one, where the study asks for them
    periodic: bool = True  # whether the map continues at its opposite edges; False for free boundaries
    highest_point: float | None = None  # of the rigid surface, above its mean plane (m)
    wall_bounded: tuple[str, ...] = ("contact", "repulsive")  # areas whose edge a wall makes; others are level sets


@dataclass(frozen=True)
class Ensemble:
    """States of one point of the loading path, to be averaged, or of which the last one counts."""

    # One after the other, as often as they are to count; read once. The ``restart`` of each holds all that the next one
    # follows from; the ``report`` of the last one is the point's.
    states: Iterator[InterfaceState]
    # How many of them come before those whose mean is taken; None: only the last one counts. The series has all.
    discarded: int | None = 0


@dataclass(frozen=True)
class Step:
    """A finished point of a loading path, as it goes to disk."""

    # Quantities by the keys of the schema, ``"name"`` or ``"label/name"``. A theory gives a distribution as a function
    # of the bins' edges, shape (n + 1,), that returns the densities, shape (n,).
    values: Mapping[str, Any]
    fields: Mapping[str, np.ndarray] = field(default_factory=dict)  # over (y, x), and atoms, if the study keeps them
    restart: Mapping[str, np.ndarray] = field(default_factory=dict)  # from which the next step starts
    bins: Bins | None = None  # of its distributions, set by the campaign


@dataclass(frozen=True)
class Variable:
    """Entry of a quantity in a dataset."""

    units: str  # UDUNITS
    long_name: str  # meaning, as a noun phrase of at most 90 characters
    dims: tuple[str, ...] = ("step",)  # beyond those of the sweep
    kind: str = "float"  # or "count", "flag", "text"
    attrs: dict[str, Any] = field(default_factory=dict)

    @property
    def empty(self) -> Any:
        """Value for a missing point."""
        return {"float": np.nan, "count": np.int32(-1), "flag": np.int8(-1), "text": ""}[self.kind]

    @property
    def dtype(self) -> Any:
        return {"float": np.float64, "count": np.int32, "flag": np.int8, "text": object}[self.kind]

    @property
    def encoding(self) -> dict[str, Any]:
        if self.kind == "text":
            return {}
        if self.kind == "flag":  # integers for the reader too; "absent" is one of the flag's values
            return {"_FillValue": None}
        compressed = {"zlib": True, "complevel": 1, "shuffle": True} if len(self.dims) > 1 else {}
        return {"_FillValue": self.empty, **compressed}


def noted(units: str, long_name: str, comment: str, dims: tuple[str, ...] = ("step",)) -> Variable:
    """Return the entry of a quantity with a comment."""
    return Variable(units, long_name, dims, attrs={"comment": comment})


@dataclass(frozen=True)
class Observable:
    """Quantities that one function reads off a state: their entries by name, and as many of them as the state has."""

    variables: Mapping[str, Variable]
    read: Callable[[InterfaceState, Bins], Mapping[str, Value]]
    averaged: bool = True  # whether an ensemble has the mean over its states, not the value of the last one
    option: str = ""  # key of [output] that asks for it; default always
