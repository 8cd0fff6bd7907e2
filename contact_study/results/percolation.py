"""Contact area and pressure of a path at which the gap stops percolating: no fluid passes any more."""

import itertools
from collections.abc import Mapping, Sequence
from typing import Any

from contact_study.results.state import Variable, noted

PERCOLATION: dict[str, Variable] = {
    "percolation_area": noted(
        "1",
        "relative contact area at which the gap first stops percolating",
        "middle of two points of the path, between which it lies; resolution error: half of their difference",
        (),
    ),
    "percolation_pressure": Variable("Pa", "mean pressure at which the gap first stops percolating", ()),
}


def percolation_threshold(steps: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """Find area and pressure at which the gap first stops percolating, from the quantities of a path's points."""
    known = [step for step in steps if step["converged"] and "gap_percolates" in step]
    for before, after in itertools.pairwise(known):
        if before["gap_percolates"] and not after["gap_percolates"]:
            found: dict[str, float] = {}
            for name, of in (("area", "relative_contact_area"), ("pressure", "mean_pressure")):
                found[f"percolation_{name}"] = 0.5 * float(before[of] + after[of])
                found[f"percolation_{name}_resolution_error"] = 0.5 * abs(float(after[of] - before[of]))
            return found
    return {}
