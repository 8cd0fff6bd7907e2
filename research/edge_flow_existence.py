"""Where the edge flow of this project has states: over the strength of adhesion and the decades of roughness.

A self-affine surface without a roll-off, heights of 0.1 µm rms and waves from 100 µm down, on a half-space of 100 GPa
under a 10-4 law of range 3 nm. The share is the work of adhesion over the elastic energy of full contact.

python -m research.edge_flow_existence --table data/edge_flow_existence.csv     # ten minutes
python -m research.edge_flow_existence --from data/edge_flow_existence.csv
"""

import argparse
import sys
from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from contact_study.physics.solids import HalfSpace
from scripts.harness import Option, head, row, tabulated
from theory import LennardJones104, SelfAffineSpectrum, edge_flow

MODULUS, RMS_HEIGHT, LONGEST, RANGE = 1e11, 1e-7, 1e-4, 3e-9
HURST = (0.2, 0.5, 0.8, 1.0)
BANDS = (1e4, 1e2)
SHARES = (0.25, 0.5, 1.0)
PRESSURES = (0.1, 1.0)  # GPa


def states(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """A spectrum, a strength and a pressure a row: whether there is a state, converged, and its area."""
    low = 2 * np.pi / LONGEST
    for band, exponent, share in product(given.bands, given.hurst, SHARES):
        spectrum = SelfAffineSpectrum(exponent, RMS_HEIGHT, low, low, band * low)
        law = LennardJones104(share * float(spectrum.full_contact_energy(HalfSpace(MODULUS).stiffness)), RANGE)
        flow = edge_flow(spectrum, MODULUS, law, 1.1e9 * max(PRESSURES))
        softening = law.strongest_softening / (0.5 * MODULUS * spectrum.cutoff)
        for pressure in PRESSURES:
            try:
                state = flow.at_pressure(1e9 * pressure)
                area, converged = state.fraction_below(1.12 * RANGE), int(state.converged)
            except ValueError:
                area, converged = np.nan, 0
            labels = {"H": exponent, "band": band, "share": share, "softening": softening}
            yield labels | {"pressure_GPa": pressure, "area": area, "converged": converged}


def rows(table: pd.DataFrame) -> Iterator[str]:
    """The table's lines: areas at both pressures by strength, in brackets where the state is not converged."""
    yield head("H", "q1/q0", *(f"Δγ/U_full = {share:g}" for share in sorted(table["share"].unique())))
    for (exponent, band), part in table.groupby(["H", "band"]):
        cells = [
            "/".join(map(_cell, some.sort_values("pressure_GPa").itertuples())) for _, some in part.groupby("share")
        ]
        yield row(f"{exponent:g}", f"{band:.0f}", *cells)


def _cell(state: Any) -> str:
    if np.isnan(state.area):
        return "none"
    return f"{state.area:.3f}" if state.converged else f"({state.area:.3f})"


main = tabulated(
    states, rows, Option("--hurst", list(HURST), "Hurst exponents"), Option("--bands", list(BANDS), "q1/q0")
)

if __name__ == "__main__":
    sys.exit(main())
