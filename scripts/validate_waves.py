"""Waves on a half-space: how fast area and mean gap converge with the grid, without and with adhesion, as Markdown.

A wave along one axis has closed forms: Westergaard's without adhesion, and for adhesion of no range that of K. L.
Johnson, Int. J. Solids Struct. 32, 423 (1995). Ours has the range ρ of an exponential attraction: it has to converge
with the process zone E*ρ²/w. Two crossed waves have no closed form between first touch and full contact: the finest
grid stands for it, and with adhesion the differences from one range to the next have to fall. From full contact they
open, by the linear solution, where the pressure in the deepest hollow has become the law's greatest tension.

    python -m scripts.validate_waves one     # along one axis
    python -m scripts.validate_waves one --figure docs/images/waves.png
    python -m scripts.validate_waves two     # crossed
"""

import argparse
import itertools
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import brentq

from bem_adhesion import Exponential, HardWall, TractionLaw, rough_contact
from bem_adhesion.solution import Solution
from contact_study.plots.style import COLOURS, DOUBLE, styled
from scripts.harness import Option, program, save, show, walk
from theory import references as reference

AMPLITUDE = 0.01  # of wavelength and modulus 1
# Johnson's α, with the pressure of full contact of either wave: below 0.6, where bodies snap together by themselves.
ADHESION = 0.15
# Over the pressure of full contact without adhesion. With adhesion loading first, then unloading, into tension; crossed
# waves have patches that merge with a jump, at 0.05, and snap into full contact earlier.
PRESSURES = (0.05, 0.2, 0.5, 0.8, 0.95)
PATH = (0.1, 0.3, 0.5, 0.1, 0.0, -0.02)
CROSSED_PATH = (0.1, 0.2, 0.1, 0.0)
POINTS = (32, 64, 128, 256)
POSITIONS = 6  # of the wave on the grid, over which errors of a counted area are averaged
POINTS_PER_ZONE = 8
ZONES = (1 / 16, 1 / 32, 1 / 64, 1 / 128)  # over the wavelength


def wave(points: int, shift: float = 0.0) -> np.ndarray:
    """Heights of the wave along the second axis, its crest ``shift`` points before the first."""
    return np.broadcast_to(AMPLITUDE * np.cos(2 * np.pi * (np.arange(points) + shift) / points), (4, points)).copy()


def crossed_waves(points: int, shift: float = 0.0) -> np.ndarray:
    """Heights of two crossed waves."""
    axis = np.cos(2 * np.pi * (np.arange(points) + shift) / points)
    return AMPLITUDE * np.outer(axis, axis)


def path(height: np.ndarray, law: TractionLaw, pressures: Sequence[float]) -> Iterator[Solution]:
    """The states of a path from separation."""
    points = height.shape[1]
    contact = rough_contact(height, (len(height) / points, 1.0), 1.0, law)
    for pressure, found in zip(pressures, walk(contact, pressures), strict=True):
        if not found.converged or found.detached:
            raise RuntimeError(f"{points} points, pressure {pressure:g}: {found.message}")
        yield found


def wave_errors(points: int) -> np.ndarray:
    """Errors of area and of mean gap over the amplitude, over pressures and positions: Westergaard's wave."""
    full = reference.wave_full_contact_pressure(AMPLITUDE, 1.0, 1.0)
    area = reference.wave_relative_area(np.array(PRESSURES))
    gap = [reference.wave_relative_mean_gap(a, p) for a, p in zip(area, PRESSURES, strict=True)]
    errors = []
    for shift in np.arange(POSITIONS) / POSITIONS:
        found = list(path(wave(points, shift), HardWall(), full * np.array(PRESSURES)))
        areas = [np.mean(each.pressure > 0) for each in found]
        errors += list(zip(areas - area, [each.gap.mean() / AMPLITUDE for each in found] - np.array(gap), strict=True))
    return np.array(errors)


def adhesive_law(full: float, zone: float) -> Exponential:
    """The attraction of Johnson's α = ADHESION whose process zone is that part of the wavelength."""
    work = 0.5 * ADHESION**2 * full**2
    return Exponential(work, float(np.sqrt(zone * work)))


def johnson_parameter() -> float:
    """His α, of the law's work of adhesion, whatever its range."""
    full = reference.wave_full_contact_pressure(AMPLITUDE, 1.0, 1.0)
    return reference.wave_adhesion(AMPLITUDE, 1.0, 1.0, adhesive_law(full, ZONES[0]).work_of_adhesion)


def adhesive_wave_states(zone: float) -> np.ndarray:
    """Area and mean gap over the amplitude on the path."""
    full = reference.wave_full_contact_pressure(AMPLITUDE, 1.0, 1.0)
    heights = wave(round(POINTS_PER_ZONE / zone))
    states = path(heights, adhesive_law(full, zone), full * np.array(PATH))
    return np.array([(np.mean(found.gap == 0), found.gap.mean() / AMPLITUDE) for found in states])


def stable_branch() -> tuple[np.ndarray, np.ndarray]:
    """Areas of Johnson's wave between the least pressure and the greatest, where it is stable, and the pressures."""
    shares = np.linspace(0.01, 0.99, 1000)
    curve = reference.wave_relative_pressure(shares, johnson_parameter())
    top = int(np.argmax(curve))
    within = slice(int(np.argmin(curve[:top])), top + 1)
    return shares[within], curve[within]


def adhesive_wave_errors(zone: float) -> np.ndarray:
    """Errors of area and of mean gap over the amplitude on the path: Johnson's wave."""
    shares, _ = stable_branch()
    adhesion = johnson_parameter()
    expected = []
    for pressure in PATH:
        area = brentq(lambda a, p=pressure: reference.wave_relative_pressure(a, adhesion) - p, shares[0], shares[-1])
        expected.append((area, reference.wave_relative_mean_gap(area, pressure)))
    return adhesive_wave_states(zone) - np.array(expected)


def crossed_states(points: int) -> np.ndarray:
    """Area and mean gap over the amplitude of crossed waves, no adhesion, at each position and pressure."""
    full = reference.egg_box_full_contact_pressure(AMPLITUDE, 1.0, 1.0)
    shifted = (crossed_waves(points, shift) for shift in np.arange(POSITIONS) / POSITIONS)
    paths = [path(heights, HardWall(), full * np.array(PRESSURES)) for heights in shifted]
    return np.array([[(np.mean(each.pressure > 0), each.gap.mean() / AMPLITUDE) for each in found] for found in paths])


def crossed_errors(grids: Sequence[int], finest: int) -> np.ndarray:
    """Errors of area and mean gap on each grid, rms over positions and pressures, against the means on the finest."""
    limit = crossed_states(finest).mean(axis=0)
    return np.array([root_mean_square((crossed_states(points) - limit).reshape(-1, 2)) for points in grids])


def adhesive_crossed_states(zone: float) -> np.ndarray:
    """Area and mean gap over the amplitude of crossed waves with adhesion, on their path."""
    full = reference.egg_box_full_contact_pressure(AMPLITUDE, 1.0, 1.0)
    law = adhesive_law(full, zone)
    states = path(crossed_waves(round(POINTS_PER_ZONE / zone)), law, full * np.array(CROSSED_PATH))
    return np.array([(np.mean(each.gap == 0), each.gap.mean() / AMPLITUDE) for each in states])


def opening_pressures(points: int, zone: float) -> tuple[float, float, float]:
    """Over that of full contact: where crossed waves open, and the pressures between which the solver opens them."""
    full = reference.egg_box_full_contact_pressure(AMPLITUDE, 1.0, 1.0)
    law = adhesive_law(full, zone)
    expected = full - law.peak_tensile_stress
    height = crossed_waves(points)
    contact = rough_contact(height, 1.0, 1.0, law)
    state = contact.step(contact.separated(), 2 * full).state
    closed, opened = 2.0, -np.inf
    for pressure in expected + full * np.array([0.1, 1e-3, -1e-3]):
        found = contact.step(state, pressure)
        if found.detached or np.any(found.gap > 0):
            opened = pressure / full
            break
        state, closed = found.state, pressure / full
    return expected / full, closed, opened


def root_mean_square(errors: np.ndarray) -> np.ndarray:
    """Of each column."""
    return np.sqrt(np.mean(np.square(errors), axis=0))


def order(sizes: Sequence[float], errors: Sequence[float]) -> float:
    """Exponent of the errors' fall with the size, least squares."""
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


def print_table(head: str, sizes: Sequence[float], words: Sequence[str], errors: np.ndarray) -> None:
    """A size a line, the order below."""
    rows = [(word, f"{area:.1e}", f"{gap:.1e}") for word, (area, gap) in zip(words, errors, strict=True)]
    show((head, "area", "mean gap / amplitude"), [*rows, ("order", *(f"{order(sizes, e):.1f}" for e in errors.T))])
    print()


@styled
def wave_figure(errors: np.ndarray, adhesive_errors: np.ndarray) -> Figure:
    """Areas over pressures beside the closed forms, and how the errors of both waves fall."""
    figure = Figure(figsize=(DOUBLE, 2.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    full = reference.wave_full_contact_pressure(AMPLITUDE, 1.0, 1.0)
    pressures = np.linspace(0, 1, 200)
    left.plot(pressures, reference.wave_relative_area(pressures), "0.5", label="Westergaard")
    found = [np.mean(each.pressure > 0) for each in path(wave(POINTS[-1]), HardWall(), full * np.array(PRESSURES))]
    left.plot(PRESSURES, found, "o", color=COLOURS[0], ms=4, label=f"solver, {POINTS[-1]} points")
    areas, curve = stable_branch()
    left.plot(curve, areas, "k--", label=f"Johnson, α = {ADHESION:g}")
    found = adhesive_wave_states(ZONES[-1])[:, 0]
    left.plot(PATH, found, "s", color=COLOURS[1], ms=4, label=f"solver, zone 1/{round(1 / ZONES[-1])}")
    left.set(
        xlabel="mean pressure over that of full contact", ylabel="contact area", xlim=(-0.08, 1.02), ylim=(0, 1.02)
    )
    left.legend()
    for column, name in enumerate(("area", "mean gap / amplitude")):
        colour = COLOURS[column]
        right.loglog([1 / points for points in POINTS], errors[:, column], "o-", color=colour, ms=4, label=name)
        right.loglog(ZONES, adhesive_errors[:, column], "s--", color=colour, ms=4, label=f"{name}, adhesion")
    right.set(xlabel="spacing, or process zone, over the wavelength", ylabel="rms error", ylim=(3e-7, None))
    ticks = sorted({*ZONES, *(1 / points for points in POINTS)})
    right.set_xticks(ticks, [f"1/{round(1 / tick)}" for tick in ticks])
    right.minorticks_off()
    right.legend(loc="lower right")
    return figure


def run(given: argparse.Namespace) -> int:
    spacings = [1 / points for points in POINTS]
    zones = [f"1/{round(1 / zone)}" for zone in ZONES]
    if given.what == "one":
        errors = np.array([root_mean_square(wave_errors(points)) for points in POINTS])
        print_table("points, no adhesion", spacings, [str(points) for points in POINTS], errors)
        adhesive = np.array([root_mean_square(adhesive_wave_errors(zone)) for zone in ZONES])
        print_table("process zone / wavelength", ZONES, zones, adhesive)
        if given.figure is not None:
            save(wave_figure(errors, adhesive), given.figure)
        return 0
    errors = crossed_errors(POINTS, 2 * POINTS[-1])
    print_table("points, no adhesion", spacings, [f"{points}²" for points in POINTS], errors)
    states = [adhesive_crossed_states(zone) for zone in ZONES]
    errors = np.array([root_mean_square(fine - coarse) for coarse, fine in itertools.pairwise(states)])
    words = [f"{wide} to {narrow}" for wide, narrow in itertools.pairwise(zones)]
    print_table("process zone / wavelength", ZONES[:-1], words, errors)
    expected, closed, opened = opening_pressures(64, ZONES[0])
    print(
        f"Full contact opens at {expected:.3f} of its pressure without adhesion; found closed at {closed:.3f},", end=" "
    )
    print(f"open at {opened:.3f}.")


main = program(
    run,
    Option("what", str, "waves along one axis or crossed", choices=("one", "two")),
    Option("--figure", Path, "draw areas and errors, too (one)"),
)

if __name__ == "__main__":
    sys.exit(main())
