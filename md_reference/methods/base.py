"""What every method of the atoms is: a function from a case to the states along its loading path."""

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from contact_study.observables.base import InterfaceState
from contact_study.problem.case import Case
from contact_study.problem.surface import Surface

# Point number -> gap field (y, x) on any grid over the same rectangle (m), None where there is no such state.
Predictor = Callable[[int], np.ndarray | None]

# Case, surface, restart, start, predictor -> one state a point of the path, from number ``start`` on. ``restart`` is
# ``InterfaceState.restart`` of the point before; without it the path begins from separation.
Method = Callable[
    [Case, Surface, Mapping[str, np.ndarray] | None, int, Predictor | None],
    Iterator[InterfaceState],
]
