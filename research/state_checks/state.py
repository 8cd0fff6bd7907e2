"""A state to be checked, what it has to fit, and what was found of a study and of many."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from bem_adhesion import Contact, Solution, rough_contact
from contact_study.numerics.grid import Grid
from contact_study.physics.laws import TractionLaw
from contact_study.physics.solids import Elasticity
from contact_study.physics.surfaces.surface import Surface
from contact_study.results.state import InterfaceState
from contact_study.study.case import Case
from research.state_checks.balance import FreeSurface, PeriodicSurface

# Largest stress out of balance over E*: twice the solver's tolerance.
ALLOWED = 2e-8
# Share of the largest stresses that a balance formed in another order may miss, beside the solver's tolerance.
ROUNDING = 1e-9

Start = Callable[[np.ndarray], Solution]
"""A start beside a state -> where the solver ends from there."""


@dataclass(frozen=True)
class Point:
    """A state as a solver or a path gives it, SI; ``state`` is what a next step starts from."""

    gap: np.ndarray
    pressure: np.ndarray
    state: np.ndarray
    plane: float | None  # of free boundaries, where the surface would be undeformed
    elastic_energy: float
    interaction_energy: float

    @classmethod
    def of(cls, found: Solution) -> "Point":
        """Of what a solver has found."""
        return cls(found.gap, found.pressure, found.state, found.plane, found.elastic_energy, found.interaction_energy)

    @classmethod
    def on_path(cls, found: InterfaceState, free: bool) -> "Point":
        """Of what a path has come to, with free boundaries or not."""
        plane = found.mean_separation + found.equilibrium_distance if free else None
        energies = found.elastic_energy, found.interaction_energy
        return cls(found.gap, found.pressure, found.restart["state"], plane, *energies)


@dataclass(frozen=True)
class Surfaces:
    """A rigid surface (m), an elastic solid by its closed form, and how they interact: what a state has to fit."""

    law: TractionLaw
    solid: Elasticity
    heights: np.ndarray
    grid: Grid
    control: str
    free: bool

    @cached_property
    def elastic(self) -> PeriodicSurface | FreeSurface:
        """The solid's response."""
        return (FreeSurface if self.free else PeriodicSurface)(self.solid, self.grid)

    @property
    def bare(self) -> bool:
        """Whether there is a wall and nothing else."""
        return self.law.has_wall and not self.law.attracts

    @property
    def length(self) -> float:
        """What changes of a gap are measured by (m)."""
        return self.law.length or float(self.heights.std())

    def margin(self, found: Point) -> float:
        """Stress that may be out of balance (Pa)."""
        # A wall alone bounds gaps, 1e-10 of the rms height, which stiff short waves turn into stress.
        wall = 1e-8 * float(self.heights.std()) / max(self.grid.size) if self.bare else 0.0
        return (ALLOWED + wall) * self.solid.contact_modulus + ROUNDING * float(np.abs(found.pressure).max())


@dataclass
class Verdict:
    """What was found of one study."""

    number: int
    law: str
    subjects: tuple[str, ...] = ()
    states: int = 0
    detached: int = 0
    flagged: list[str] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    narrow: int = 0
    balance: float = 0.0
    return_error: float = 0.0


@dataclass(frozen=True)
class Study:
    """A case and its surface, the same as the checks know it, a source of changes, and where what they find goes."""

    case: Case
    surface: Surface
    surfaces: Surfaces
    rng: np.random.Generator
    verdict: Verdict

    def contact(self) -> Contact:
        """The solver of the case, as exact as the library's own: a study asks less of a wall."""
        return rough_contact(
            self.surfaces.heights,
            self.surfaces.grid.size,
            self.case.solid,
            self.case.law,
            self.case.loading.control,
            boundary=self.case.elasticity.boundary,
            hardness=self.case.material.hardness,
        )

    def fault(self, where: str, words: str) -> None:
        """Add a fault."""
        self.verdict.faults.append(f"{where}: {words}")

    def differs(self, where: str, name: str, reported: float, expected: float, margin: float) -> None:
        """Add a fault if a number is further than that from what it has to be."""
        if abs(reported - expected) > margin:
            self.fault(where, f"{name} {reported:.8g}, not {expected:.8g}")


@dataclass
class Tally:
    """Sums over studies."""

    studies: int = 0
    states: int = 0
    detached: int = 0
    flagged: int = 0
    narrow: int = 0
    wrong: int = 0
    balance: float = 0.0
    return_error: float = 0.0

    def add(self, verdict: Verdict) -> None:
        """Count one study."""
        self.studies += 1
        self.states += verdict.states
        self.detached += verdict.detached
        self.flagged += len(verdict.flagged)
        self.narrow += verdict.narrow
        self.wrong += len(verdict.faults)
        self.balance = max(self.balance, verdict.balance)
        self.return_error = max(self.return_error, verdict.return_error)

    def cells(self) -> tuple[object, ...]:
        """A line of the table."""
        counts = self.studies, self.states, self.detached, self.flagged, self.narrow, self.wrong
        return *counts, f"{self.balance:.0e}", f"{self.return_error:.0e}"
