"""What every method of the atoms is: a function from a case to the states along its loading path."""

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from contact_study.physics.surfaces.realisation import Surface
from contact_study.results.state import Ensemble, InterfaceState
from contact_study.study.case import Case

# Of an interrupted run whose arrays a restart cannot be made of.
OTHER_VERSION = "what the interrupted run has kept is of another version of this program; drop it with --overwrite"

# Point number -> gap field (y, x) on any grid over the same rectangle (m), None where there is no such state.
Predictor = Callable[[int], np.ndarray | None]

# Case, surface, restart, start, predictor -> one state or ensemble a point of the path, from number ``start`` on.
# ``restart`` is ``InterfaceState.restart`` of the point before; without it the path begins from separation. That of a
# state of an ensemble that is not over goes on with the point ``start`` itself.
Method = Callable[
    [Case, Surface, Mapping[str, np.ndarray] | None, int, Predictor | None],
    Iterator[InterfaceState | Ensemble],
]
