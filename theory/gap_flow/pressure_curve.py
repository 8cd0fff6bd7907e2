"""Mean pressure over mean gap, and the states along it: what the theories of the local gap have in common."""

from abc import ABC, abstractmethod

import numpy as np

from contact_study.inputs.units import stress
from contact_study.numerics.arguments import finite
from contact_study.physics.laws.base import TractionLaw
from theory.gap_flow.state import GapState

# What helps where a curve ends early.
REMEDY = "use a lower pressure, weaker adhesion or Persson's theory"


class PressureCurve(ABC):
    """The curve p(ū) of a surface, to be asked for the state at a pressure or a mean gap."""

    @property
    @abstractmethod
    def mean_gap(self) -> np.ndarray:
        """Rising mean gaps, from the law's zero, at which :attr:`pressure` stands, shape (n,) (m)."""

    @property
    @abstractmethod
    def pressure(self) -> np.ndarray:
        """p = −∂U/∂ū, shape (n,) (Pa)."""

    @abstractmethod
    def states(self, mean_gaps: np.ndarray) -> list[GapState]:
        """Distribution of the local gap at each mean gap (m); ValueError outside the nodes of the flow."""

    @property
    def _from_contact(self) -> bool:
        """Whether of several stable states at a pressure the one of the smallest gap is asked, not of the largest."""
        return False

    @property
    def _end(self) -> str:
        """Why the curve may end before a pressure."""
        return "adhesion is too strong for it"

    @property
    def pull_off_pressure(self) -> float:
        """Lowest pressure of the curve, the end of adhesion under pressure control (Pa)."""
        return float(self.pressure.min())

    def gap_at(self, pressure: float) -> float:
        """Mean gap, from the law's zero, at a pressure (m); NaN where no stable state carries it.

        Of several stable states (p falling with ū) it is the one of the largest gap, which an approaching block meets
        first, or on an unloading branch of the smallest, which a retracting block leaves last. ValueError if the
        pressure is no number, or higher than the nodes of the flow reach.
        """
        p, gap = self.pressure, self.mean_gap
        finite("pressure", pressure, "Pa")
        if pressure > p.max():
            raise ValueError(
                f"pressure: the flow has no equilibrium at {stress(pressure)}, it ends at {stress(float(p.max()))}: "
                f"{self._end}, or its nodes end there; {REMEDY}"
            )
        crossings = np.flatnonzero((p[:-1] > pressure) & (p[1:] <= pressure))
        if crossings.size == 0:
            return float("nan")
        i = crossings[0 if self._from_contact else -1]
        weight = (p[i] - pressure) / (p[i] - p[i + 1])
        return float((1 - weight) * gap[i] + weight * gap[i + 1])

    def pressure_at(self, mean_gap: float) -> float:
        """Pressure at a mean gap within the nodes (Pa)."""
        return float(np.interp(mean_gap, self.mean_gap, self.pressure))

    def at_pressure(self, pressure: float) -> GapState:
        """The distribution of gaps at a mean pressure (Pa), of the stable state that :meth:`gap_at` chooses.

        ValueError if there is none.
        """
        gap = self.gap_at(pressure)
        if np.isnan(gap):
            lowest = self.pull_off_pressure
            reason = f"below the pull-off at {lowest:.3g} Pa" if np.isfinite(lowest) else "no state found carries it"
            raise ValueError(f"pressure = {pressure:g} Pa: {reason}")
        return self.states(np.array([gap]))[0]


def core_of(law: TractionLaw) -> float:
    """The equilibrium distance, at which a law's core ends (m); ValueError if there is a wall in its place."""
    if law.has_wall:
        raise ValueError(f"law: {law.title}: has a wall, which no flow of the local gap goes through; take a core")
    return law.equilibrium_distance


def positions(mean_gaps: np.ndarray, lowest: float, highest: float) -> np.ndarray:
    """Mean gaps (m) as an array; ValueError if one is outside the two ends, or no number."""
    asked = np.atleast_1d(np.asarray(mean_gaps, dtype=float))
    wrong = ~((asked >= lowest) & (asked <= highest))
    if wrong.any():
        raise ValueError(
            f"mean_gaps: {asked[wrong][0]:.6g} m is outside the nodes of the flow, {lowest:.6g} m to {highest:.6g} m"
        )
    return asked
