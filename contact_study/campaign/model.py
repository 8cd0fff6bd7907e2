"""The three models as the campaign runs them: their declarations, and calls into their modules.

A model's package is imported by its first call, not by its declaration: ``--help`` needs no solver.
"""

import importlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from contact_study.inputs.errors import InputError

if TYPE_CHECKING:
    import numpy as np

    from contact_study.campaign.memory import Need
    from contact_study.numerics.distributions import Bins
    from contact_study.physics.surfaces.scales import SurfaceScales
    from contact_study.physics.surfaces.surface import Surface
    from contact_study.results.state import Ensemble, InterfaceState, Step, Value
    from contact_study.study.case import Case
    from contact_study.study.study import Study

Predictor = Callable[[int], "np.ndarray | None"]


@dataclass(frozen=True)
class Model:
    """A model.

    Parameters
    ----------
    command : str
        Name of its command.
    kind : str
        ``"continuum"``, ``"atomistic"`` or ``"theory"``: the dataset's ``model`` attribute.
    module : str
        Module with the functions ``check(case)``, which raises InputError if the model cannot run a case,
        ``review(study, scales)``, ``constants(case, surface)`` and ``solve_path(case, surface, restart, start,
        predictor)``. It may have ``needs(case)``, which yields each :class:`.memory.Need` beside the grid's, and
        ``POINTS_FOR_THREADS``, the points of a surface from which on one case gains from several threads.
    description : str
        One sentence for ``--help`` and the dataset's ``source``.
    references : str
        Literature of the method, for the dataset.
    takes_predictor : bool
        Whether a step may start from the gap field of another dataset.
    ignores : tuple of str
        Sections of the study file that the model does not read.
    keeps : tuple of str
        Keys of [output] that select optional content of a step.
    whole_path : bool
        Whether the numbers of a step depend on the whole path, not only on its points so far.
    own_steps : bool
        Whether it takes the steps of ``loading.adaptive`` between the points of a path.
    threads : int
        Number of cores that a case of any surface keeps busy.
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
    threads: int = 1

    @property
    def points_for_threads(self) -> int:
        """Points of a surface from which on one case gains from several threads."""
        from contact_study.numerics.fourier import POINTS_FOR_THREADS

        return getattr(importlib.import_module(self.module), "POINTS_FOR_THREADS", POINTS_FOR_THREADS)

    def check(self, case: "Case") -> None:
        """Raise InputError if the model cannot run the case."""
        importlib.import_module(self.module).check(case)

    def needs(self, case: "Case") -> "Need":
        """Return the largest memory that a case needs; raises InputError as :meth:`check`."""
        from contact_study.campaign.memory import grid_need

        own = getattr(importlib.import_module(self.module), "needs", None)
        return max([grid_need(case), *(own(case) if own else ())], key=lambda need: need.size)

    def review(self, study: "Study", scales: "Sequence[SurfaceScales]") -> list[str]:
        """Warn of a study as a whole; raises InputError if the model's grids cannot hold the scales of a case."""
        return importlib.import_module(self.module).review(study, scales)

    def constants(self, case: "Case", surface: "Surface") -> "Mapping[str, Value]":
        """Return the quantities that do not change along the path."""
        return importlib.import_module(self.module).constants(case, surface)

    def solve_path(
        self,
        case: "Case",
        surface: "Surface",
        restart: "Mapping[str, np.ndarray] | None",
        start: int,
        predictor: Predictor | None,
    ) -> "Iterator[InterfaceState | Ensemble | Step]":
        """Yield the points of the path from number ``start`` on.

        ``restart`` is the state after the point before, or a state of the ensemble ``start`` to continue from.
        """
        extra: dict[str, Any] = {"predictor": predictor} if self.takes_predictor else {}
        return importlib.import_module(self.module).solve_path(case, surface, restart=restart, start=start, **extra)


_YANG = "C. Yang, B. N. J. Persson, J. Israelachvili, K. Rosenberg, EPL 84, 46004 (2008)"

MODELS: dict[str, Model] = {
    "continuum": Model(
        command="bem-adhesion",
        kind="continuum",
        module="bem_adhesion.study.model",
        description="boundary elements: elastic half-space on a rigid rough surface, hard wall or adhesive",
        references=_YANG,
        ignores=("atomistic", "sampling", "dynamics", "theory"),
        own_steps=True,
    ),
    "atomistic": Model(
        command="md-reference",
        kind="atomistic",
        module="md_reference.study.model",
        description="Atomistic reference: a harmonic block of atoms, condensed exactly to its bottom layer, in "
        "equilibrium at zero or another temperature on a rigid rough layer of Lennard-Jones sites",
        references=_YANG,
        takes_predictor=True,
        ignores=("theory",),
        keeps=("fields", "atoms"),
    ),
    "theory": Model(
        command="persson-theory",
        kind="theory",
        module="theory.study.model",
        description="Persson's theory of rough contact with adhesion, and beside it the gap-flow theory and the edge "
        "flow",
        references=f"{_YANG}; "
        "B. N. J. Persson, J. Chem. Phys. 115, 3840 (2001); akin to the gap flow: J. Joe, Traction Between Rough "
        "Surfaces, PhD thesis, University of Michigan (2021), https://hdl.handle.net/2027.42/169927",
        ignores=("atomistic", "overdamped", "sampling", "dynamics"),
        whole_path=True,  # the separation curve and the gap flow's grid extend as far as the path asks
        threads=2,  # the edge flow beside Persson's theory and the gap flow
    ),
}


def check_study(model: Model, study: "Study") -> "tuple[Bins, list[str]]":
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
    from contact_study.study.bins import bins_of
    from contact_study.study.checks import plausibility

    notes = [*study.notes, *plausibility.review(study)]
    for case in study.cases:
        if case.surface.absent and model.kind != "theory":
            raise InputError(
                f"missing key surface.kind: {model.command} needs a surface; the study has a spectrum only"
            )
        model.check(case)
    return bins_of(study), [*notes, *model.review(study, study.scales)]
