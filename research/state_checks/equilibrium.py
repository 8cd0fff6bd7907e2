"""Whether a state is a stable equilibrium: balance, load, energies, changes that cost energy, a second start."""

from collections.abc import Iterator

import numpy as np

from contact_study.numerics.grid import Grid
from research.state_checks.state import ALLOWED, Point, Start, Study, Surfaces

CHANGES = (0, 2, 6)  # widths, in points, of the random changes
CHANGE = 1e-3  # their size over the law's length
# Next to a fold the minimum is narrower than that: from so much less of a change the solver must come back.
NARROW = 1e-2
RETURNED = 1e-3  # gaps over the law's length that are those of one state


def follow(study: Study) -> None:
    """Solve a case's path in plain steps and check its states."""
    contact = study.contact()
    state, verdict = contact.separated(), study.verdict
    for target, _ in study.case.path:
        found = contact.step(state, target)
        state = found.state
        verdict.states += 1
        if found.detached:
            verdict.detached += 1
        elif not found.converged:
            verdict.flagged.append(found.message)
        else:
            check_with_energies(study, Point.of(found), target, lambda start, at=target: contact.step(start, at))


def check_with_energies(
    study: Study, found: Point, target: float, again: Start, surfaces: Surfaces | None = None
) -> None:
    """:func:`check`, and the energies of a case's solid."""
    surfaces = surfaces or study.surfaces
    check(study, found, target, again, surfaces)
    where = f"{study.verdict.law}, {surfaces.control} {target:.4g}"
    displacement = surfaces.heights + found.gap
    compression = study.case.solid.compression_energy(float(found.pressure.mean()))
    elastic = surfaces.elastic.stored(surfaces.heights, found) + compression
    # What is out of balance works along the displacement; sums of it round by its size.
    rounding = 1e-12 * float(np.abs(found.pressure).mean() * np.abs(displacement - displacement.mean()).max())
    margin = surfaces.margin(found) * float(displacement.std() if found.plane is None else np.ptp(displacement))
    study.differs(where, "elastic energy", found.elastic_energy, elastic, margin + rounding + 1e-9 * elastic)
    interaction = float(np.mean(surfaces.law.potential(found.gap)))
    margin = 1e-9 * abs(surfaces.law.work_of_adhesion) + 1e-9 * abs(interaction)
    study.differs(where, "interaction energy", found.interaction_energy, interaction, margin)


def check(study: Study, found: Point, target: float, again: Start, surfaces: Surfaces | None = None) -> None:
    """Check a state that calls itself converged and in contact under what was prescribed."""
    surfaces, verdict = surfaces or study.surfaces, study.verdict
    where = f"{verdict.law}, {surfaces.control} {target:.4g}"
    modulus = surfaces.solid.contact_modulus
    rest = imbalance(surfaces, found)
    verdict.balance = max(verdict.balance, rest / modulus)
    if rest > surfaces.margin(found):
        study.fault(where, f"out of balance by {rest / modulus:.1e} E*")
    _check_load(study, surfaces, found, target, where)
    _check_changes(study, surfaces, found, where)
    for share in (1.0, NARROW):
        second = again(disturbed(surfaces, found, study.rng, share))
        held = second.converged and not second.detached
        error = float(np.abs(second.gap - found.gap).max()) / surfaces.length if held else np.inf
        if error <= RETURNED:
            verdict.return_error = max(verdict.return_error, error)
            verdict.narrow += share < 1
            return
    ends = f"ends {error:.1e} lengths away" if np.isfinite(error) else second.message
    study.fault(where, f"a second start: {ends}")


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


def _check_load(study: Study, surfaces: Surfaces, found: Point, target: float, where: str) -> None:
    distance = surfaces.law.equilibrium_distance
    if surfaces.control == "approach":
        held = surfaces.heights.max() + distance - surfaces.elastic.plane(surfaces.heights, found)
    else:
        held = found.pressure.mean() if surfaces.control == "pressure" else found.gap.mean() - distance
    under_load = surfaces.control == "pressure"
    margin = ALLOWED * surfaces.solid.contact_modulus if under_load else 2e-8 * surfaces.length
    if abs(held - target) > margin + 1e-8 * abs(target):
        study.fault(where, f"{surfaces.control} is {held:.8g}")


def _check_changes(study: Study, surfaces: Surfaces, found: Point, where: str) -> None:
    def energy(gap: np.ndarray) -> float:
        return surfaces.elastic.energy(surfaces.law, surfaces.heights, found, gap, surfaces.control)

    lowest = energy(found.gap)
    for change in changes(surfaces.grid, study.rng):
        moved = found.gap + CHANGE * surfaces.length * change
        if surfaces.law.has_wall:
            moved = np.maximum(moved, 0)
        if surfaces.control == "gap":  # a change of the mean is none that the control allows
            moved += (found.gap.mean() - moved.mean()) * (moved > 0) / max(np.mean(moved > 0), 1e-300)
            if moved.min() < 0:
                continue
        if energy(moved) < lowest - 1e-10 * abs(lowest):
            study.fault(where, "a change lowers the energy")
