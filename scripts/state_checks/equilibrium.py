"""Whether a state is a stable equilibrium: balance, load, energies, changes that cost energy, a second start."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bem_adhesion import Contact, Solution, rough_contact
from contact_study.numerics.grid import Grid
from contact_study.physics.laws import TractionLaw
from contact_study.physics.solids import Elasticity
from contact_study.study.case import Case
from scripts.state_checks.balance import FreeSurface, PeriodicSurface
from scripts.state_checks.point import Point
from scripts.state_checks.verdict import Verdict

# Largest stress out of balance over E*: twice the solver's tolerance.
ALLOWED = 2e-8
# Share of the largest stresses that a balance formed in another order may miss, beside the solver's tolerance.
ROUNDING = 1e-9
CHANGES = (0, 2, 6)  # widths, in points, of the random changes
CHANGE = 1e-3  # their size over the law's length
# Next to a fold the minimum is narrower than that: from so much less of a change the solver must come back.
NARROW = 1e-2
RETURNED = 1e-3  # gaps over the law's length that are those of one state


@dataclass(frozen=True)
class Surfaces:
    """A rigid surface, an elastic solid and how they interact: what a state has to fit.

    Parameters
    ----------
    law : TractionLaw
        The law.
    solid : Elasticity
        The solid, by its closed form.
    heights : numpy.ndarray
        Of the rigid surface (m).
    grid : Grid
        Its points.
    control : str
        What is prescribed.
    free : bool
        Whether boundaries are free.
    """

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


def contact_of(case: Case, surfaces: Surfaces) -> Contact:
    """The solver of a case, as exact as the library's own: a study asks less of a wall."""
    return rough_contact(
        surfaces.heights,
        surfaces.grid.size,
        case.solid,
        case.law,
        case.loading.control,
        boundary=case.elasticity.boundary,
        hardness=case.material.hardness,
    )


def check_with_energies(
    case: Case,
    surfaces: Surfaces,
    found: Point,
    target: float,
    again: Callable[[np.ndarray], Solution],
    rng: np.random.Generator,
    verdict: Verdict,
) -> None:
    """:func:`check`, and the energies of a case's solid; the other parameters as there."""
    check(surfaces, found, target, again, rng, verdict)
    check_energies(surfaces, found, target, case.solid.compression_energy(float(found.pressure.mean())), verdict)


def check(
    surfaces: Surfaces,
    found: Point,
    target: float,
    again: Callable[[np.ndarray], Solution],
    rng: np.random.Generator,
    verdict: Verdict,
) -> None:
    """Check a state that calls itself converged and in contact.

    Parameters
    ----------
    surfaces : Surfaces
        What it is a state of.
    found : Point
        The state.
    target : float
        What was prescribed.
    again : callable
        A start beside the state (see :func:`disturbed`) -> where the solver ends from there.
    rng : numpy.random.Generator
        Of the changes.
    verdict : Verdict
        What is found is added there.
    """
    where = f"{verdict.law}, {surfaces.control} {target:.4g}"
    modulus = surfaces.solid.contact_modulus
    rest = imbalance(surfaces, found)
    verdict.balance = max(verdict.balance, rest / modulus)
    if rest > surfaces.margin(found):
        verdict.faults.append(f"{where}: out of balance by {rest / modulus:.1e} E*")
    _check_load(surfaces, found, target, where, verdict)
    _check_changes(surfaces, found, rng, where, verdict)
    for share in (1.0, NARROW):
        second = again(disturbed(surfaces, found, rng, share))
        held = second.converged and not second.detached
        error = float(np.abs(second.gap - found.gap).max()) / surfaces.length if held else np.inf
        if error <= RETURNED:
            verdict.return_error = max(verdict.return_error, error)
            verdict.narrow += share < 1
            return
    ends = f"ends {error:.1e} lengths away" if np.isfinite(error) else second.message
    verdict.faults.append(f"{where}: a second start: {ends}")


def check_energies(surfaces: Surfaces, found: Point, target: float, compression: float, verdict: Verdict) -> None:
    """Hold the energies that a state reports to their definitions.

    Parameters
    ----------
    compression : float
        What the uniform compression of the solid that was solved for stores (J/m²); the others as of :func:`check`.
    """
    where = f"{verdict.law}, {surfaces.control} {target:.4g}"
    displacement = surfaces.heights + found.gap
    elastic = surfaces.elastic.stored(surfaces.heights, found) + compression
    # What is out of balance works along the displacement; sums of it round by its size.
    rounding = 1e-12 * float(np.abs(found.pressure).mean() * np.abs(displacement - displacement.mean()).max())
    margin = surfaces.margin(found) * float(displacement.std() if found.plane is None else np.ptp(displacement))
    if abs(elastic - found.elastic_energy) > margin + rounding + 1e-9 * elastic:
        verdict.faults.append(f"{where}: elastic energy {found.elastic_energy:.8g}, not {elastic:.8g}")
    interaction = float(np.mean(surfaces.law.potential(found.gap)))
    if abs(interaction - found.interaction_energy) > 1e-9 * abs(surfaces.law.work_of_adhesion) + 1e-9 * abs(
        interaction
    ):
        verdict.faults.append(f"{where}: interaction energy {found.interaction_energy:.8g}, not {interaction:.8g}")


def imbalance(surfaces: Surfaces, found: Point) -> float:
    """Largest stress that is out of balance, or that a wall would have to pull (Pa)."""
    interface = found.pressure + surfaces.law.traction(found.gap)
    elastic = surfaces.elastic.imbalance(surfaces.heights + found.gap, found)
    if not surfaces.law.has_wall:
        return float(max(np.abs(interface).max(), np.abs(elastic).max()))
    free = found.gap > 0
    pulled = max(0.0, -float(interface[~free].min(initial=0.0)))
    return float(max(np.abs(interface[free]).max(initial=0.0), pulled, np.abs(elastic).max()))


def disturbed(surfaces: Surfaces, found: Point, rng: np.random.Generator, share: float = 1.0) -> np.ndarray:
    """A state next to another: of a wall alone its pressure, else the displacement of points that touch no wall."""
    if surfaces.bare:
        return found.state * (1 + share * rng.uniform(-0.1, 0.1, found.state.shape))
    state = found.state.copy()
    rows, columns = found.gap.shape
    away = share * CHANGE * np.minimum(surfaces.law.length, np.abs(found.gap)) * rng.uniform(-1, 1, found.gap.shape)
    state[:rows, :columns] += away
    return state


def changes(grid: Grid, rng: np.random.Generator) -> Iterator[np.ndarray]:
    """Random fields of unit size, from rough to smooth."""
    y, x = (np.fft.fftfreq(count) for count in grid.shape)
    for width in CHANGES:
        taper = np.exp(-0.5 * (2 * np.pi * width) ** 2 * (y[:, None] ** 2 + x**2))
        change = np.fft.ifft2(taper * np.fft.fft2(rng.standard_normal(grid.shape))).real
        yield change / np.abs(change).max()


def _check_load(surfaces: Surfaces, found: Point, target: float, where: str, verdict: Verdict) -> None:
    distance = surfaces.law.equilibrium_distance
    if surfaces.control == "approach":
        held = surfaces.heights.max() + distance - surfaces.elastic.plane(surfaces.heights, found)
    else:
        held = found.pressure.mean() if surfaces.control == "pressure" else found.gap.mean() - distance
    under_load = surfaces.control == "pressure"
    margin = ALLOWED * surfaces.solid.contact_modulus if under_load else 2e-8 * surfaces.length
    if abs(held - target) > margin + 1e-8 * abs(target):
        verdict.faults.append(f"{where}: {surfaces.control} is {held:.8g}")


def _check_changes(surfaces: Surfaces, found: Point, rng: np.random.Generator, where: str, verdict: Verdict) -> None:
    def energy(gap: np.ndarray) -> float:
        return surfaces.elastic.energy(surfaces.law, surfaces.heights, found, gap, surfaces.control)

    lowest = energy(found.gap)
    for change in changes(surfaces.grid, rng):
        moved = found.gap + CHANGE * surfaces.length * change
        if surfaces.law.has_wall:
            moved = np.maximum(moved, 0)
        if surfaces.control == "gap":  # a change of the mean is none that the control allows
            moved += (found.gap.mean() - moved.mean()) * (moved > 0) / max(np.mean(moved > 0), 1e-300)
            if moved.min() < 0:
                continue
        if energy(moved) < lowest - 1e-10 * abs(lowest):
            verdict.faults.append(f"{where}: a change lowers the energy")
