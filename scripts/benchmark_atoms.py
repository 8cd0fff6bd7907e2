"""Work of the atoms' minimiser along a loading path from separation, over layers of atoms, as a Markdown table.

For each layer and adhesion: evaluations of the interface (of some atoms counted by their share) and transform pairs
(of three components, in float64; one in float32 counts one half) of every load step, which do not depend on the
machine's speed. The study's cell is scaled to the number of atoms, heights with it, so that slopes and contact stay.
``--times`` adds microseconds of processor time an atom for an evaluation and for a pair, with what goes with it, and
the bytes an atom at the peak: give layers in rising order.

    python -m scripts.benchmark_atoms data/yang2008.toml --atoms 200 400 --pressures "0.1 GPa" "1 GPa" --times
"""

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from contact_study.inputs.units import quantity
from contact_study.study.case import Case, realise
from contact_study.study.study import read_study
from md_reference.study.system import build_contact
from scripts.harness import STUDY, Option, head, peak_memory, program, row


@dataclass(frozen=True)
class PathCost:
    """Evaluations and pairs of each step, whether all converged; seconds in the interface and in all."""

    evaluations: list[int]
    pairs: list[float]
    converged: bool
    interface_seconds: float
    seconds: float


def cost_of_path(case: Case, pressures: Sequence[float]) -> PathCost:
    """Load one case from separation through the pressures (Pa)."""
    contact = build_contact(case, realise(case))
    evaluate, in_interface = contact.interface.evaluate_some, 0.0

    def timed(*arguments: np.ndarray) -> bool:
        nonlocal in_interface
        began = time.process_time()
        outside = evaluate(*arguments)
        in_interface += time.process_time() - began
        return outside

    contact.interface.evaluate_some = timed  # type: ignore[method-assign]
    state, steps, began = contact.separated(), [], time.process_time()
    for pressure in pressures:
        steps.append(contact.step(state, pressure))
        state = steps[-1].state
    return PathCost(
        [step.force_evaluations for step in steps],
        [step.fft_pairs for step in steps],
        all(step.converged for step in steps),
        in_interface,
        time.process_time() - began,
    )


def case_of(study: Path, atoms: int, ratio: float) -> Case:
    """The study's first case on a square layer of so many atoms a side, at one adhesion."""
    (whole, *_) = read_study(study).cases
    scale = atoms / whole.lattice.atoms[0]
    overrides = {
        "surface.size": [scale * length for length in whole.lattice.size],
        "surface.shape": [atoms, atoms],
        "surface.rms_height": scale * whole.surface.rms_height,
        "interaction.well_depth_ratio": ratio,
    }
    return read_study(study, overrides).cases[0]


def run(given: argparse.Namespace) -> None:
    pressures = [quantity(text, "Pa", "--pressures") for text in given.pressures]
    heads = ("atoms", "ε/ε₀", "evaluations", "pairs")
    print(head(*heads, *(("µs an atom: evaluation", "pair", "bytes an atom") if given.times else ())))
    if given.times:
        cost_of_path(case_of(given.study, 48, 1.0), pressures)  # compiles
    before = peak_memory()
    for atoms in given.atoms:
        for ratio in given.ratios:
            cost = cost_of_path(case_of(given.study, atoms, ratio), pressures)
            print(line(atoms, ratio, cost, (peak_memory() - before) / atoms**2 if given.times else None), flush=True)


def line(atoms: int, ratio: float, cost: PathCost, memory: float | None) -> str:
    """One row of the table; ``memory`` is the peak so far in bytes an atom, None leaves the machine's columns out."""
    cells = [f"{atoms}²", f"{ratio:g}", " ".join(f"{count}" for count in cost.evaluations)]
    cells.append(" ".join(f"{pairs:.0f}" for pairs in cost.pairs) + ("" if cost.converged else " (not converged)"))
    if memory is not None:
        rest = cost.seconds - cost.interface_seconds
        cells.append(f"{1e6 * cost.interface_seconds / sum(cost.evaluations) / atoms**2:.2f}")
        cells += [f"{1e6 * rest / sum(cost.pairs) / atoms**2:.2f}", f"{memory:.0f}"]
    return row(*cells)


main = program(
    run,
    STUDY,
    Option("--atoms", [200, 400], "atoms along each side"),
    Option("--ratios", [1.0, 4.0, 8.0], "multiples of the well depth"),
    Option("--pressures", ["0.1 GPa", "1 GPa", "10 GPa"], "the loading path"),
    Option("--times", False, "add columns that depend on the machine"),
)

if __name__ == "__main__":
    sys.exit(main())
