"""Errors of resolution: every state against that on half the nodes, cells and scales.

That is the error of a scheme of first order and three times that of one of second order; the theories are in between.
"""

import warnings
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from contact_study.results.schema import RESOLUTION_ERROR, quantity_of
from theory.persson.separation import NegativeSeparation, NotConverged
from theory.study.case_theories import CaseTheories

# Quantities with an error, and the words of a warning.
_JUDGED = {
    "relative_contact_area": "of the contact area",
    "mean_gap": "of the rms height in the mean gap",
    "mean_pressure": "of the full-contact stress in the mean pressure",
    "stress_balance": "of the pressure in the balance of stress",
}


class Unresolved(UserWarning):
    """States of a theory whose estimated error of resolution exceeds ``theory.accuracy``."""


def quietly(values: Iterator[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """Values of coarse theories without their warnings, which the fine ones repeat where they matter."""
    while True:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NotConverged)
            warnings.simplefilter("ignore", NegativeSeparation)
            found = next(values, None)
        if found is None:
            return
        yield found


def errors(
    fine: Mapping[str, Any], coarser: Mapping[str, Any], theories: CaseTheories, accuracy: float
) -> tuple[dict[str, Any], dict[str, tuple[float, str]]]:
    """Estimated errors of a point's states, and whether they are within the accuracy.

    Found are for each state ``…_resolution_error`` of its quantities, in their units, and the flag ``resolved``, which
    in Persson's theory needs a ``stress_balance`` of one, too. The worst error of each state that is not resolved comes
    with its words. Areas are compared with themselves, gaps with the rms height, pressures with the stress of full
    contact; the prescribed quantity has no error. One that exists at one of the two resolutions only has the error NaN.
    """
    scales = {
        "mean_gap": float(np.sqrt(theories.spectrum.mean_square_height)),
        "mean_pressure": theories.persson.stress_scale,
    }
    prescribed = f"mean_{theories.case.loading.control}"
    found: dict[str, Any] = {}
    worst: dict[str, tuple[float, str]] = {}
    for name in fine:
        labels, quantity = quantity_of(name)
        if quantity not in _JUDGED or quantity == prescribed:
            continue
        one, other = float(fine[name]), float(coarser[name])
        state = "/".join(labels)
        if quantity == "stress_balance":
            if not state.startswith("persson"):
                continue
            error, scale, other = abs(one - 1.0), 1.0, one
        else:
            error, scale = 0.0 if one == other else abs(one - other), scales.get(quantity, one)  # both may be infinite
            found[name + RESOLUTION_ERROR] = error if np.isfinite(error) else np.nan
        if np.isnan(one) and np.isnan(other):  # defined at neither resolution
            error = 0.0
        share = error / scale if scale else np.inf if error else 0.0
        found.setdefault(f"{state}/resolved", True)
        if not share <= accuracy:
            found[f"{state}/resolved"] = False
            worst[state] = max(worst.get(state, (0.0, "")), (np.inf if np.isnan(share) else share, _JUDGED[quantity]))
    return found, worst


def warn(missed: Mapping[str, list[tuple[float, str]]], points: int, accuracy: float) -> None:
    """One warning for each theory that misses the accuracy somewhere on the path."""
    for state, cases in missed.items():
        share, words = max(cases)
        size = f"{share:.2g} {words}" if np.isfinite(share) else "a state that half the resolution does not find"
        warnings.warn(
            f"{state.replace('_', ' ')}: at {len(cases)} of {points} points the estimated error of the resolution is "
            f"above theory.accuracy = {accuracy:g}, at most {size}",
            Unresolved,
            stacklevel=2,
        )
