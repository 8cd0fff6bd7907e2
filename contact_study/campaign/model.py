"""What the campaign must know of a model: its name and where its two functions are."""

import importlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact_study.campaign.memory import Need, grid_of
from contact_study.errors import InputError
from contact_study.numerics.distributions import Bins
from contact_study.numerics.fourier import POINTS_FOR_THREADS
from contact_study.physics.surfaces.scales import SurfaceScales
from contact_study.physics.surfaces.surface import Surface
from contact_study.results.state import Ensemble, InterfaceState, Value
from contact_study.results.step import Step
from contact_study.study.bins import bins_of
from contact_study.study.case import Case
from contact_study.study.checks import plausibility
from contact_study.study.study import Study

# Where each model declares itself as MODEL, by what it is; imported when asked for, for models know of no other.
MODULES = {
    "continuum": "bem_adhesion.study.model",
    "atomistic": "md_reference.study.model",
    "theory": "theory.study.model",
}

Predictor = Callable[[int], np.ndarray | None]


def model_of(kind: str) -> "Model":
    """The model of a kind, a key of :data:`MODULES`."""
    return importlib.import_module(MODULES[kind]).MODEL


@dataclass(frozen=True)
class Model:
    """One of the three models.

    Parameters
    ----------
    command : str
        Name of its command.
    kind : str
        ``"continuum"``, ``"atomistic"`` or ``"theory"``: the dataset's ``model`` attribute.
    module : str
        Module that has ``check(case)``, which raises InputError where the model cannot serve a case, ``review(study,
        scales)``, ``constants(case, surface)`` and ``solve_path(case, surface, restart, start, predictor)``; where
        cases take more memory than their grids ``needs(case)``, too, which yields each :class:`.memory.Need`.
    description : str
        One sentence for ``--help`` and the dataset's ``source``.
    references : str
        Literature of the method, for the dataset.
    takes_predictor : bool
        Whether each step may start from the gap field of another dataset.
    ignores : tuple of str
        Sections of the study file that the model does not read.
    keeps : tuple of str
        Keys of [output] that say what a step keeps beyond its numbers.
    whole_path : bool
        Whether the numbers of a step follow from the whole path, not only from its points so far.
    own_steps : bool
        Whether it takes the steps of ``loading.adaptive`` between the points of a path.
    points_for_threads : int
        Of a surface, from which on one case gains from more threads than one.
    threads : int
        That a case of any surface keeps busy: where a study has few cases, each process has as many cores.
    """

    command: str
    kind: str
    module: str
    description: str
    references: str
    takes_predictor: bool = False
    ignores: tuple[str, ...] = ()
    keeps: tuple[str, ...] = ("fields",)
    whole_path: bool = False
    own_steps: bool = False
    points_for_threads: int = POINTS_FOR_THREADS
    threads: int = 1

    def check(self, case: Case) -> None:
        """Raise InputError if the model cannot serve the case."""
        importlib.import_module(self.module).check(case)

    def needs(self, case: Case) -> Need:
        """The memory that a case takes at least; errors as :meth:`check`."""
        own = getattr(importlib.import_module(self.module), "needs", None)
        return max([grid_of(case), *(own(case) if own else ())], key=lambda need: need.size)

    def review(self, study: Study, scales: Sequence[SurfaceScales]) -> list[str]:
        """Warnings, once for the whole study; InputError where the model's grids cannot hold the scales of a case."""
        return importlib.import_module(self.module).review(study, scales)

    def constants(self, case: Case, surface: Surface) -> Mapping[str, Value]:
        """What does not change along the path."""
        return importlib.import_module(self.module).constants(case, surface)

    def solve_path(
        self,
        case: Case,
        surface: Surface,
        restart: Mapping[str, np.ndarray] | None,
        start: int,
        predictor: Predictor | None,
    ) -> Iterator[InterfaceState | Ensemble | Step]:
        """Points of the path from number ``start`` on.

        ``restart`` is that of the point before, or of a state of the ensemble ``start`` to go on with.
        """
        extra: dict[str, Any] = {"predictor": predictor} if self.takes_predictor else {}
        return importlib.import_module(self.module).solve_path(case, surface, restart=restart, start=start, **extra)


def check_study(model: Model, study: Study) -> tuple[Bins, list[str]]:
    """Check a study before any work.

    Returns
    -------
    bins : Bins
        Bins of its distributions.
    notes : list of str
        Warnings about the study as a whole.

    Raises
    ------
    InputError
        If the model cannot run a case, or numbers of the study contradict each other.
    """
    notes = [*study.notes, *plausibility.review(study)]
    for case in study.cases:
        if case.surface.absent and model.kind != "theory":
            raise InputError(
                f"missing key surface.kind: {model.command} needs a surface; the study has a spectrum only"
            )
        model.check(case)
    return bins_of(study), [*notes, *model.review(study, study.scales)]
