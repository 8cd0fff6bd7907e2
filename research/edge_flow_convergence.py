"""Convergence of the edge flow on the paper's target spectrum: areas, mean gaps, pressures and sweeps, as Markdown.

The order is that of three resolutions, each of twice the nodes and scales. The time is that of the curve p(ū) alone,
of one processor.

python -m research.edge_flow_convergence data/yang2008.toml                  # a minute or two
python -m research.edge_flow_convergence data/yang2008.toml --finest 480
"""

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from contact_study.study.case import realise
from contact_study.study.study import read_study
from scripts.harness import STUDY, Option, head, program, row
from theory import edge_flow

PRESSURE = 1e9
COARSEST = 120
COLUMNS = ("case", "nodes × scales", "A", "ū (nm)", "local / mean pressure", "mean gaps", "sweeps", "lost")
COLUMNS += ("order of A", "of ū", "curve (s)")


def rows(study: Path, finest: int) -> Iterator[str]:
    """The table's lines."""
    yield head(*COLUMNS)
    seen = set()
    for case in read_study(study).cases:
        surface = realise(case)
        law = case.law
        if law.work_of_adhesion in seen:
            continue  # another seed of the same law: the target spectrum is one
        seen.add(law.work_of_adhesion)
        nodes = COARSEST
        areas: list[float] = []
        gaps: list[float] = []
        edge_flow(surface.spectrum, case.solid, law, gaps=24, scales=8)  # compiles before the clock runs
        while nodes <= finest:
            began = time.process_time()
            flow = edge_flow(surface.spectrum, case.solid, law, gaps=nodes, scales=nodes // 3)
            seconds = time.process_time() - began
            state = flow.at_pressure(PRESSURE)
            areas.append(state.fraction_below(case.contact_distance))
            gaps.append(state.mean_gap - law.equilibrium_distance)
            cells = (
                f"Δγ = {law.work_of_adhesion:.3g} J/m²",
                f"{nodes} × {nodes // 3}",
                f"{areas[-1]:.4f}",
                f"{gaps[-1] / 1e-9:.4f}",
                f"{state.mean_traction / state.pressure:.3f}",
                f"{len(flow.equilibria)}",
                f"{flow.sweeps}",
                f"{flow.unconverged_states}",
                order(areas),
                order(gaps),
                f"{seconds:.1f}",
            )
            yield row(*cells)
            nodes *= 2


def order(values: Sequence[float]) -> str:
    """Order of convergence that the last three values show, each at twice the resolution of the one before."""
    if len(values) < 3:
        return "–"
    first, second = np.abs(np.diff(values[-3:]))
    return f"{np.log2(first / second):.1f}" if first > 0 and second > 0 else "–"


def run(given: argparse.Namespace) -> None:
    for line in rows(given.study, given.finest):
        print(line, flush=True)


main = program(
    run,
    STUDY,
    Option("--finest", 960, "largest number of nodes; a third of it are scales"),
)

if __name__ == "__main__":
    sys.exit(main())
