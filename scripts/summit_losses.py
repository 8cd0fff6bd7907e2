"""What one asperity loses in a loop of approach and retraction, by Maugis' number and law, as Markdown.

The asperity is a paraboloid on a half-space with free boundaries, under prescribed approach. On 128² points, or in
twice the steps, losses differ by 2 % at most; those of Dugdale's law at λ = 2.5 by 6 %.

python -m scripts.summit_losses --table data/summit_losses.csv     # a few minutes
python -m scripts.summit_losses --from data/summit_losses.csv
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.special import erfcx

from bem_adhesion import Contact, rough_contact
from contact_study.physics.laws import LAWS
from contact_study.physics.spheres.numbers import maugis_parameter
from scripts.atlas_tables import MARKERS
from scripts.harness import Option, head, row, tabulated, walk

NUMBERS = (0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.4, 1.6, 1.8, 2.1, 2.5)  # Maugis' λ
TABLE = Path("data/summit_losses.csv")
SIDE, ALPHA = 0.7, 0.12  # of the surface, and α = (Δγ R²/E*)^(1/3), for a radius and a modulus of 1
WORK = ALPHA**3
REACH = 6.0, 2.8, 0.6  # begin of the way in law lengths and in α²/R, the larger one; its end in α²/R
CURVATURES = np.linspace(0.005, 6.0, 1200)  # √(κ₁κ₂) of summits over rms(∇²h)/2
# Density of the summits there, for an isotropic Gaussian surface: k³ exp(k²) erfc(√1.5 k), from maxima of its Hessian.
SHARES = CURVATURES**3 * np.exp(-0.5 * CURVATURES**2) * erfcx(np.sqrt(1.5) * CURVATURES)
SHARES /= SHARES.sum()


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    for law in MARKERS:
        for number in given.numbers:
            yield {"law": law, "number": number, "loss": loss(law, number, given.points, given.steps)}


def loss(law: str, number: float, points: int, steps: int) -> float:
    """Return the loss over Δγ α² of an asperity with a Maugis number, in steps that are short around both jumps."""
    unit = LAWS[law](work_of_adhesion=WORK, length=1.0)
    length = float(maugis_parameter(1.0, 1.0, WORK, unit.peak_tensile_stress)) / number
    given = LAWS[law](work_of_adhesion=WORK, length=length)
    axis = SIDE * ((np.arange(points) + 0.5) / points - 0.5)
    contact = rough_contact(-0.5 * np.add.outer(axis**2, axis**2), SIDE, 1.0, given, "approach", boundary="free")
    begin = -given.equilibrium_distance - max(REACH[0] * length, REACH[1] * ALPHA**2)
    way = np.linspace(begin, REACH[2] * ALPHA**2, steps)
    jumps = (int(np.clip(np.argmax(np.abs(np.diff(force))), 1, steps - 3)) for force in _forces(contact, way))
    short = [np.linspace(way[place - 1], way[place + 2], steps) for place in jumps]
    way = np.unique(np.concatenate([way, *short]))
    inward, outward = _forces(contact, way)
    return float(np.trapezoid(inward - outward, way)) / (WORK * ALPHA**2)


def _forces(contact: Contact, way: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Forces on the way in and, at the same approaches, out."""
    force = SIDE**2 * np.array([float(solution.pressure.mean()) for solution in walk(contact, [*way, *way[::-1]])])
    return force[: way.size], force[: way.size - 1 : -1]


def ratio_of_summits(
    table: pd.DataFrame, law: str, number: float, moments: tuple[float, float], reduced: float
) -> float:
    """Return Γ of all summits of a Gaussian surface, each of which loses what it loses alone.

    Parameters
    ----------
    table : pandas.DataFrame
        Rows of this script.
    law : str
        As in a study.
    number : float
        Maugis' number of the mean asperity, of radius R = 2/rms(∇²h).
    moments : tuple of float
        Rms slope and rms(∇²h)/2 (1/m).
    reduced : float
        Δγ/E* (m).

    Returns
    -------
    float
        1 + n <α² d(λ)>, with P. R. Nayak's density n of summits, J. Lubr. Technol. 93, 398 (1971): m₄/(6√3 π m₂) by
        the moments of a profile.
    """
    slope, curvature = moments
    density = 3 / 8 * (2 * curvature) ** 2 / (slope**2 / 2) / (6 * np.sqrt(3) * np.pi)
    of_law = table[table["law"] == law].sort_values("number")
    lost = np.interp(number / np.cbrt(CURVATURES), of_law["number"], of_law["loss"].clip(lower=0))
    return 1 + density * float(SHARES @ (lost * np.cbrt(reduced / (curvature * CURVATURES) ** 2) ** 2))


def lines(table: pd.DataFrame) -> Iterator[str]:
    yield head("λ", *(MARKERS[law][0] for law in MARKERS))
    for number, some in table.groupby("number"):
        by_law = some.set_index("law")["loss"]
        yield row(f"{number:g}", *(f"{max(by_law[law], 0):.2f}" if law in by_law else "" for law in MARKERS))


main = tabulated(
    rows,
    lines,
    Option("--numbers", list(NUMBERS), "Maugis' numbers"),
    Option("--points", 192, "of the grid along a side"),
    Option("--steps", 60, "of one way, and again around each jump"),
)

if __name__ == "__main__":
    sys.exit(main())
