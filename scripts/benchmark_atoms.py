"""Work of the atoms' minimiser along a loading path from separation, over layers of atoms, as a Markdown table.

For each layer and adhesion: evaluations of the interface (of some atoms counted by their share) and transform pairs
(of three components, in float64; one in float32 counts one half) of every load step, which do not depend on the
machine's speed. The study's cell is scaled to the number of atoms, heights with it, so that slopes and contact stay.
``--times`` adds microseconds of processor time an atom for an evaluation and for a pair, with what goes with it, and
the bytes an atom at the peak: give layers in rising order.

    python -m scripts.benchmark_atoms data/yang2008.toml --atoms 200 400 --pressures "0.1 GPa" "1 GPa" --times
"""

import argparse
import resource
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from contact_study.study.case import Case, realise
from contact_study.study.study import read_study
from contact_study.units import quantity
from md_reference.study.system import build_contact


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


def _peak() -> float:
    """Largest memory of this process so far (bytes)."""
    return 1024.0 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


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


def parser() -> argparse.ArgumentParser:
    made = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("study", type=Path, nargs="?", default=Path("data/yang2008.toml"), help="study file")
    made.add_argument("--atoms", type=int, nargs="+", default=[200, 400], help="atoms along each side")
    made.add_argument("--ratios", type=float, nargs="+", default=[1, 4, 8], help="multiples of the well depth")
    made.add_argument("--pressures", nargs="+", default=["0.1 GPa", "1 GPa", "10 GPa"], help="the loading path")
    made.add_argument("--times", action="store_true", help="add columns that depend on the machine")
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    given = parser().parse_args(arguments)
    pressures = [quantity(text, "Pa", "--pressures") for text in given.pressures]
    head = "| atoms | ε/ε₀ | evaluations | pairs |"
    print(head + (" µs an atom: evaluation | pair | bytes an atom |" if given.times else ""))
    print("|---" * (7 if given.times else 4) + "|")
    if given.times:
        cost_of_path(case_of(given.study, 48, 1.0), pressures)  # compiles
    before = _peak()
    for atoms in given.atoms:
        for ratio in given.ratios:
            cost = cost_of_path(case_of(given.study, atoms, ratio), pressures)
            print(line(atoms, ratio, cost, (_peak() - before) / atoms**2 if given.times else None), flush=True)
    return 0


def line(atoms: int, ratio: float, cost: PathCost, memory: float | None) -> str:
    """One row of the table; ``memory`` is the peak so far in bytes an atom, None leaves the machine's columns out."""
    cells = [f"{atoms}²", f"{ratio:g}", " ".join(f"{count}" for count in cost.evaluations)]
    cells.append(" ".join(f"{pairs:.0f}" for pairs in cost.pairs) + ("" if cost.converged else " (not converged)"))
    if memory is not None:
        rest = cost.seconds - cost.interface_seconds
        cells.append(f"{1e6 * cost.interface_seconds / sum(cost.evaluations) / atoms**2:.2f}")
        cells += [f"{1e6 * rest / sum(cost.pairs) / atoms**2:.2f}", f"{memory:.0f}"]
    return f"| {' | '.join(cells)} |"


if __name__ == "__main__":
    sys.exit(main())
