"""The DMT-like limit against the edge flow at equal mean gap, as Markdown: how far an undeformed contact carries.

For every point of a study's sweep, with its target spectrum. The pressure of the bare contact is the one that it
carries itself; adhesion takes from it. The edge flow knows the whole law.

python -m research.dmt_limit data/yang2008.toml
"""

import argparse
import sys
from collections.abc import Iterator

from contact_study.study.case import Case
from contact_study.study.study import read_study
from scripts.harness import STUDY, head, minus, program, row
from theory import dmt_limit, edge_flow, gap_distribution, stickiness

BARE_PRESSURES = (0.2, 0.5, 1.0, 2.0, 5.0)  # GPa


def rows(case: Case) -> Iterator[str]:
    """The lines of one point of the sweep."""
    spectrum = case.surface.target_spectrum
    if spectrum is None:
        raise SystemExit(f'surface.kind = "{case.surface.kind}" has no target spectrum')
    tabor = stickiness(spectrum, case.solid, case.law).tabor_number
    zero = case.law.equilibrium_distance
    flow = edge_flow(spectrum, case.solid, case.law, 1.1e9 * max(BARE_PRESSURES))
    for pressure in BARE_PRESSURES:
        bare = gap_distribution(spectrum, case.solid, 1e9 * pressure)
        limit = dmt_limit(bare, case.law)
        whole = flow.pressure_at(bare.mean_gap + zero)
        cells = (f"{case.work_of_adhesion:.3g}", f"{tabor:.2f}", f"{pressure:g}", f"{1e9 * bare.mean_gap:.3f}")
        yield minus(row(*cells, f"{limit / 1e9:.3f}", f"{whole / 1e9:.3f}"))


def run(given: argparse.Namespace) -> None:
    print(
        head(
            "Δγ (J/m²)", "Tabor parameter", "p of the bare contact (GPa)", "ū (nm)", "p, DMT-like limit", "p, edge flow"
        )
    )
    for case in read_study(given.study).cases:
        print("\n".join(rows(case)))


main = program(run, STUDY)

if __name__ == "__main__":
    sys.exit(main())
