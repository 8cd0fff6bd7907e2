"""Convergence of the edge flow on the paper's target spectrum: areas, mean gaps, pressures and sweeps, as Markdown.

python scripts/edge_flow_convergence.py data/yang2008.toml
python scripts/edge_flow_convergence.py data/yang2008.toml --finest 960     # a few minutes
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from contact_study.problem.study import read_study
from contact_study.problem.surface import realise
from theory import edge_flow

PRESSURE = 1e9
COARSEST = 120


def parser() -> argparse.ArgumentParser:
    made = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("study", type=Path, help="study file with a spectrum")
    made.add_argument("--finest", type=int, default=480, help="largest number of nodes; a third of it are scales")
    return made


def rows(study: Path, finest: int) -> Iterator[str]:
    """The table's lines."""
    head = ("case", "nodes × scales", "A", "ū (nm)", "local / mean pressure", "mean gaps", "sweeps", "lost")
    yield f"| {' | '.join(head)} |"
    yield "|---" * len(head) + "|"
    seen = set()
    for case in read_study(study).cases:
        surface = realise(case)
        law = case.law
        if law.work_of_adhesion in seen:
            continue  # another seed of the same law: the target spectrum is one
        seen.add(law.work_of_adhesion)
        nodes = COARSEST
        while nodes <= finest:
            flow = edge_flow(surface.spectrum, case.solid, law, gaps=nodes, scales=nodes // 3)
            state = flow.at_pressure(PRESSURE)
            cells = (
                f"Δγ = {law.work_of_adhesion:.3g} J/m²",
                f"{nodes} × {nodes // 3}",
                f"{state.fraction_below(case.contact_distance):.4f}",
                f"{(state.mean_gap - law.equilibrium_distance) / 1e-9:.4f}",
                f"{state.mean_traction / state.pressure:.3f}",
                f"{len(flow.equilibria)}",
                f"{flow.sweeps}",
                f"{flow.unconverged_states}",
            )
            yield f"| {' | '.join(cells)} |"
            nodes *= 2


def main(arguments: Sequence[str] | None = None) -> int:
    given = parser().parse_args(arguments)
    for row in rows(given.study, given.finest):
        print(row, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
