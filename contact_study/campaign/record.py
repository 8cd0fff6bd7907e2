"""What a model yields for each point of a loading path."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from contact_study.fields.observables import Bins

Value = float | int | bool | str | np.ndarray


@dataclass(frozen=True)
class Step:
    """One finished point of a loading path.

    Attributes
    ----------
    values : mapping
        Quantities under the names of the schema; of several theories each under its own, ``"gap_flow/mean_gap"``, and
        under that of a metastable branch, ``"gap_flow/loading/mean_gap"``.
    fields : mapping
        Fields over the lateral plane (y, x), only where the study asks for them.
    restart : mapping
        All that the next step needs, nothing else.
    bins : Bins or None
        Those of its distributions; the campaign's to set.
    """

    values: Mapping[str, Value]
    fields: Mapping[str, np.ndarray] = field(default_factory=dict)
    restart: Mapping[str, np.ndarray] = field(default_factory=dict)
    bins: Bins | None = None
