"""Maugis' number λ₁ from which one asperity jumps under a prescribed mean gap, by law, as Markdown.

The asperity is the summit of crossed waves, its contact small against the wave. A contact without a jump has one
pressure at each gap: λ₁ is where pressures on the way in and out begin to differ.

python -m scripts.jump_onset
"""

import argparse
import sys
from collections.abc import Callable, Iterable, Iterator

import numpy as np

from bem_adhesion import Contact, rough_contact
from contact_study.physics.laws import Dugdale, Exponential, LennardJones104, TractionLaw
from contact_study.physics.laws.exponential import RAMP
from contact_study.physics.spheres.numbers import maugis_parameter
from scripts.harness import Option, program, show, walk

# A law by its length; the ends of Dugdale's tension, over its range, are a fifth and the default.
LAWS: dict[str, Callable[[float], TractionLaw]] = {
    "10-4 law": lambda length: LennardJones104(WORK, length),
    "exponential": lambda length: Exponential(WORK, length),
    "Dugdale, end over 0.2": lambda length: Dugdale(WORK, length, 0.2),
    f"Dugdale, end over {RAMP:g}": lambda length: Dugdale(WORK, length),
}
AMPLITUDE = 0.01  # of the waves, of wavelength and modulus 1
RADIUS = 1 / (4 * np.pi**2 * AMPLITUDE)  # of the summit
CONTACT = 0.12  # JKR's radius without load
WORK = 2 * CONTACT**3 / (9 * np.pi * RADIUS**2)
BETWEEN = 0.5, 1.4  # Maugis' numbers between which λ₁ is looked for
REACH = 3.0  # lengths of the law from touch, outward; a third of it inward
NOISE = 1e-3  # difference of pressures that is a jump, over the largest tension


def run(given: argparse.Namespace) -> None:
    """Bisect λ₁ of each law on grids of rising numbers of points."""
    rows = []
    for words, law in LAWS.items():
        found = [onset(law, points, given.steps) for points in given.points]
        rows.append((words, *(f"{number:.2f}" for number in found), f"{law(1.0).jump_onset:g}"))
    show(("law", *(f"λ₁ on {points}²" for points in given.points), "`jump_onset`"), rows)


def onset(law: Callable[[float], TractionLaw], points: int, steps: int) -> float:
    """Return λ₁ of a law."""
    low, high = BETWEEN
    while high - low > 0.01:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if jumps(with_number(law, middle), points, steps) else (middle, high)
    return 0.5 * (low + high)


def with_number(law: Callable[[float], TractionLaw], number: float) -> TractionLaw:
    """Return the law that gives the summit a Maugis number, which falls as the law's length rises."""
    return law(float(maugis_parameter(RADIUS, 1.0, WORK, law(1.0).peak_tensile_stress)) / number)


def jumps(law: TractionLaw, points: int, steps: int) -> bool:
    """Test whether pressures on the way in and out differ near the gap where they change most."""
    axis = np.cos(2 * np.pi * np.arange(points) / points)
    contact = rough_contact(AMPLITUDE * np.outer(axis, axis), 1.0, 1.0, law, control="gap")
    gaps = AMPLITUDE + law.equilibrium_distance + law.length * np.linspace(REACH, -REACH / 3, steps)
    inward = np.array(list(pressures(contact, gaps)))
    steepest = int(np.clip(np.argmax(np.abs(np.diff(inward))), 2, steps - 4))
    near = np.linspace(gaps[steepest - 2], gaps[steepest + 3], steps)
    both = np.array(list(pressures(contact, [*near, *near[::-1]])))
    return bool(np.abs(both[:steps] - both[steps:][::-1]).max() > NOISE * -inward.min())


def pressures(contact: Contact, gaps: Iterable[float]) -> Iterator[float]:
    """Yield mean pressures along a path of mean gaps from separation."""
    for solution in walk(contact, gaps):
        yield float(solution.pressure.mean())


main = program(
    run,
    Option("--points", [64, 96], "of the grids along a side"),
    Option("--steps", 100, "gaps of one way, over the whole range and again near its steepest place"),
)

if __name__ == "__main__":
    sys.exit(main())
