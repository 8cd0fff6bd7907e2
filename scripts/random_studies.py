"""Random studies of the continuum, each state checked by other means than the solver's.

Law, solid, boundaries, roughness, grid, control and path are drawn at random. Of every state that calls itself
converged

- the balance is formed anew in float64, by NumPy's transforms or, with free boundaries, by direct convolution, from
  K(q) or the displacement of a cell, and from the law's own functions: none of the solver's passes, kernels or sums;
- no small random change, rough or smooth, that a wall allows may lower the energy: it is a minimum;
- a second start, from the state after such a change, must come back to it.

A state that is none of that is wrong; one that is flagged is counted, and no fault.

    python -m scripts.random_studies --studies 100
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from bem_adhesion import Contact, Solution, rough_contact
from contact_study.campaign.command import Parser, guarded
from contact_study.fields.grid import Grid
from contact_study.problem.case import Case
from contact_study.problem.errors import InputError
from contact_study.problem.laws import LAWS, LennardJones104, TractionLaw
from contact_study.problem.study import make_study
from contact_study.problem.surface import realise
from scripts.independent_balance import FreeSurface, PeriodicSurface

SIZE = 100e-9
MODULUS = (1e9, 100e9)  # Young's, log-uniform
SHAPES = ((32, 32), (48, 48), (33, 33), (31, 45), (24, 64), (64, 40))
# Share of the largest stresses that a balance formed in another order may miss, beside the solver's tolerance.
ROUNDING = 1e-9
CHANGES = (0, 2, 6)  # widths, in points, of the random changes
CHANGE = 1e-3  # their size over the law's length


def main(arguments: Sequence[str] | None = None) -> int:
    return guarded("random_studies", lambda: _main(arguments), interrupted="nothing is written")


def parser() -> Parser:
    made = Parser(
        description=__doc__.splitlines()[0], formatter_class=argparse.ArgumentDefaultsHelpFormatter, allow_abbrev=False
    )
    made.add_argument("--studies", type=int, default=500, help="how many")
    made.add_argument("--first", type=int, default=0, help="number of the first: each study follows from its number")
    made.add_argument(
        "--extreme",
        action="store_true",
        help="thinner layers, bases of more different moduli, transversely isotropic half-spaces with free boundaries",
    )
    return made


def _main(arguments: Sequence[str] | None) -> int:
    given = parser().parse_args(arguments)
    tallies: dict[str, Tally] = {}
    for number in range(given.first, given.first + given.studies):
        verdict = checked(number, given.extreme)
        tallies.setdefault(verdict.law, Tally()).add(verdict)
        for fault in verdict.faults:
            print(f"study {number}: {fault}", file=sys.stderr, flush=True)
    print("| law | studies | states | detached | flagged | wrong | worst balance | worst return |")
    print("|---|---|---|---|---|---|---|---|")
    total = Tally()
    for law, tally in sorted(tallies.items()):
        print(tally.row(law))
        total.merge(tally)
    print(total.row("all"))
    return 1 if total.wrong else 0


@dataclass
class Verdict:
    """What was found of one study."""

    number: int
    law: str
    states: int = 0
    detached: int = 0
    flagged: list[str] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    balance: float = 0.0
    return_error: float = 0.0


@dataclass
class Tally:
    """Sums over studies."""

    studies: int = 0
    states: int = 0
    detached: int = 0
    flagged: int = 0
    wrong: int = 0
    balance: float = 0.0
    return_error: float = 0.0

    def add(self, verdict: Verdict) -> None:
        """Count one study."""
        self.merge(
            Tally(
                1,
                verdict.states,
                verdict.detached,
                len(verdict.flagged),
                len(verdict.faults),
                verdict.balance,
                verdict.return_error,
            )
        )

    def merge(self, other: "Tally") -> None:
        """Count what another has counted."""
        for name in ("studies", "states", "detached", "flagged", "wrong"):
            setattr(self, name, getattr(self, name) + getattr(other, name))
        self.balance, self.return_error = max(self.balance, other.balance), max(self.return_error, other.return_error)

    def row(self, name: str) -> str:
        """A line of the table."""
        return (
            f"| {name} | {self.studies} | {self.states} | {self.detached} | {self.flagged} | {self.wrong} | "
            f"{self.balance:.0e} | {self.return_error:.0e} |"
        )


def study_of(number: int, extreme: bool = False) -> dict[str, Any]:
    """The table of a random study; the number decides all, but how far solids go and which may be free."""
    thinnest, least, most = (1e-10, 1e-3, 1e3) if extreme else (5e-9, 0.1, 10)
    rng = np.random.default_rng([20, number])

    def between(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    names = list(LAWS)
    law = names[number % len(names)]
    shape = SHAPES[rng.integers(len(SHAPES))]
    size = [SIZE, SIZE * shape[1] / shape[0]] if rng.random() < 0.5 else [SIZE, SIZE]
    modulus, ratio = between(*MODULUS), float(rng.choice([0.0, 0.3, 0.45, 0.5]))
    contact_modulus = modulus / (1 - ratio**2)
    cutoff = int(rng.integers(3, min(shape) // 4 + 1))
    slope = between(0.02, 0.5)
    height = slope * max(size) / (2 * np.pi * cutoff) * between(1, 3)
    length = height * between(0.1, 2.0)
    # Over E* × length: from hardly sticky to many states.
    work = contact_modulus * length * between(1e-3, 0.1)
    solids = {
        "half_space": {},
        "layer": {"thickness": between(thinnest, 1e-7)},
        "layered": {
            "thickness": between(thinnest, 1e-7),
            "base_youngs_modulus": modulus * between(least, most),
            "base_poissons_ratio": 0.3,
        },
        "transversely_isotropic": {
            "axial_modulus": modulus * between(1, 5),
            "axial_poissons_ratio": 0.2,
            "axial_shear_modulus": modulus * between(0.2, 1),
        },
    }
    kind = str(rng.choice(list(solids)))
    if kind == "transversely_isotropic":  # constants that a solid can have
        ratio = min(ratio, 0.3)
    free = (kind == "half_space" and rng.random() < 0.5) or (extreme and kind == "transversely_isotropic")
    control = str(rng.choice(["pressure", "approach" if free else "gap"]))
    return {
        "surface": {
            "kind": "self_affine",
            "size": size,
            "shape": list(shape),
            "hurst_exponent": float(rng.uniform(0.2, 1.0)),
            "rms_height": height,
            "roll_off_mode": int(rng.integers(1, cutoff + 1)),
            "cutoff_mode": cutoff,
            "seed": number,
        },
        "material": {"youngs_modulus": modulus, "poissons_ratio": ratio},
        "elasticity": {"kind": kind, "boundary": "free" if free else "periodic", **solids[kind]},
        "interaction": {"law": law, **_keys_of_law(law, work, length, rng)},
        "loading": {
            "control": control,
            "path": _path(control, law, contact_modulus * slope, height, length, work, rng),
        },
    }


def _keys_of_law(law: str, work: float, length: float, rng: np.random.Generator) -> dict[str, Any]:
    if law == "hard_wall":
        return {}
    if law == "repulsive":
        return {"repulsion": work, "length": length}
    if law == "tabulated":
        source = LennardJones104(work, length)
        gap = length * np.concatenate([np.linspace(0.6, 2, 70), np.geomspace(2.05, 8, 40)])
        return {"gap": gap.tolist(), "traction": source.traction(gap).tolist()}
    keys: dict[str, Any] = {"work_of_adhesion": work, "length": length}
    share = float(rng.uniform(0.2, 0.6))
    if law == "morse":
        keys |= {"range": share * length}
    elif law == "exponential_core":
        keys |= {"range": share * length, "core": share * length * float(rng.uniform(0.1, 0.6))}
    elif law == "dugdale_core":
        keys |= {"range": share * length, "ramp": 0.2, "core": 0.1 * share * length}
    return keys


def _path(
    control: str, law: str, stress: float, height: float, length: float, work: float, rng: np.random.Generator
) -> list[float]:
    """There and back; in the end under a little tension, where the law has some."""
    if control == "pressure":
        up = sorted(float(value) for value in stress * np.exp(rng.uniform(np.log(3e-3), np.log(0.5), 3)))
        down = [up[0]] if law in ("hard_wall", "repulsive") else [up[0], -0.02 * work / length]
        return [*up, *down]
    if control == "gap":
        return [float(value) * height for value in (*sorted(rng.uniform(0.1, 2.5, 3))[::-1], 1.0)]
    return [float(value) * height for value in (*sorted(rng.uniform(0.2, 2.0, 3)), 0.1)]


def checked(number: int, extreme: bool = False) -> Verdict:
    """Solve and check one study."""
    table = study_of(number, extreme)
    verdict = Verdict(number, table["interaction"]["law"])
    try:
        case = make_study(table).cases[0]
    except InputError as error:
        # Constants that fit no solid or path: an answer, in one line.
        verdict.flagged.append(str(error))
        return verdict
    surface = realise(case)
    heights, grid = surface.sampled, surface.grid
    contact = rough_contact(
        heights, grid.size, case.solid, case.law, case.loading.control, boundary=case.elasticity.boundary
    )
    rng = np.random.default_rng([21, number])
    state = contact.separated()
    for target, _ in case.path:
        found = contact.step(state, target)
        state = found.state
        verdict.states += 1
        if found.detached:
            verdict.detached += 1
        elif not found.converged:
            verdict.flagged.append(found.message)
        else:
            _check(case, contact, heights, grid, target, found, rng, verdict)
    return verdict


def _check(
    case: Case,
    contact: Contact,
    heights: np.ndarray,
    grid: Grid,
    target: float,
    found: Solution,
    rng: np.random.Generator,
    verdict: Verdict,
) -> None:
    law, modulus = case.law, case.solid.contact_modulus
    where = f"{verdict.law}, {case.loading.control} {target:.4g}"
    solid = FreeSurface(case.solid, grid) if case.elasticity.boundary == "free" else PeriodicSurface(case.solid, grid)
    allowed = 2e-8 * modulus
    rest = _imbalance(solid, law, heights, found)
    verdict.balance = max(verdict.balance, rest / modulus)
    largest = float(np.abs(found.pressure).max())
    scale = float(heights.std()) / max(grid.size) if law.has_wall and not law.attracts else 0.0
    # A wall alone bounds gaps, 1e-10 of the rms height, which stiff short waves turn into stress.
    if rest > allowed + ROUNDING * largest + 1e-8 * scale * modulus:
        verdict.faults.append(f"{where}: out of balance by {rest / modulus:.1e} E*")
    held = {
        "pressure": found.pressure.mean(),
        "gap": found.gap.mean() - law.equilibrium_distance,
        "approach": heights.max() + law.equilibrium_distance - (found.plane or 0.0),
    }[case.loading.control]
    length = law.length or float(heights.std())
    margin = allowed if case.loading.control == "pressure" else 2e-8 * length
    if abs(held - target) > margin + 1e-8 * abs(target):
        verdict.faults.append(f"{where}: {case.loading.control} is {held:.8g}")
    lowest = solid.energy(law, heights, found, found.gap, case.loading.control)
    for change in _changes(grid, rng):
        moved = found.gap + CHANGE * length * change
        if law.has_wall:
            moved = np.maximum(moved, 0)
        if case.loading.control == "gap":  # a change of the mean is none that the control allows
            moved += (found.gap.mean() - moved.mean()) * (moved > 0) / max(np.mean(moved > 0), 1e-300)
            if moved.min() < 0:
                continue
        if solid.energy(law, heights, found, moved, case.loading.control) < lowest - 1e-10 * abs(lowest):
            verdict.faults.append(f"{where}: a change lowers the energy")
    again = contact.step(_disturbed(found, law, rng), target)
    if again.converged and not again.detached:
        error = float(np.abs(again.gap - found.gap).max()) / length
        verdict.return_error = max(verdict.return_error, error)
        if error > 1e-3:
            verdict.faults.append(f"{where}: a second start ends {error:.1e} lengths away")
    else:
        verdict.faults.append(f"{where}: a second start: {again.message}")


def _disturbed(found: Solution, law: TractionLaw, rng: np.random.Generator) -> np.ndarray:
    """A state next to another: of a wall alone its pressure, else the displacement of points that touch no wall."""
    if law.has_wall and not law.attracts:
        return found.state * rng.uniform(0.9, 1.1, found.state.shape)
    state = found.state.copy()
    rows, columns = found.gap.shape
    away = CHANGE * np.minimum(law.length, np.abs(found.gap)) * rng.uniform(-1, 1, found.gap.shape)
    state[:rows, :columns] += away
    return state


def _changes(grid: Grid, rng: np.random.Generator) -> Iterator[np.ndarray]:
    """Random fields of unit size, from rough to smooth."""
    y, x = (np.fft.fftfreq(count) for count in grid.shape)
    for width in CHANGES:
        taper = np.exp(-0.5 * (2 * np.pi * width) ** 2 * (y[:, None] ** 2 + x**2))
        change = np.fft.ifft2(taper * np.fft.fft2(rng.standard_normal(grid.shape))).real
        yield change / np.abs(change).max()


def _imbalance(solid: PeriodicSurface | FreeSurface, law: TractionLaw, heights: np.ndarray, found: Solution) -> float:
    """Largest stress that is out of balance, or that a wall would have to pull (Pa)."""
    interface = found.pressure + law.traction(found.gap)
    elastic = solid.imbalance(heights + found.gap, found)
    if not law.has_wall:
        return float(max(np.abs(interface).max(), np.abs(elastic).max()))
    free = found.gap > 0
    pulled = max(0.0, -float(interface[~free].min(initial=0.0)))
    return float(max(np.abs(interface[free]).max(initial=0.0), pulled, np.abs(elastic).max()))


if __name__ == "__main__":
    sys.exit(main())
