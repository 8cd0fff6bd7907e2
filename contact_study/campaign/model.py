"""The three models as the campaign runs them. A model's package is imported by its first use: ``--help`` needs none."""

import importlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from contact_study.campaign.memory import Need, of_leakage, on_grid
from contact_study.inputs.errors import InputError

if TYPE_CHECKING:
    from contact_study.study.case import Case
    from contact_study.study.study import Study


@dataclass(frozen=True)
class Model:
    """A model.

    Its module has ``check(case)``, which raises InputError if the model cannot run a case, and ``review(study,
    scales)``, which warns of a study as a whole. ``constants(case, surface)`` are the quantities that do not change
    along the path, ``solve_path(case, surface, restart, start, predictor)`` yields its points from number ``start`` on.
    The module may have ``needs(case)``, which yields each :class:`.memory.Need` beside the grid's, and
    ``POINTS_FOR_THREADS``, the points of a surface from which on one case gains from several threads.
    """

    command: str
    kind: str  # the dataset's attribute ``model``
    module: str
    description: str
    references: str
    takes_predictor: bool = False  # whether a step may start from the gap field of another dataset
    ignores: tuple[str, ...] = ()  # sections of the study file that it does not read
    keeps: tuple[str, ...] = ("fields", "leakage")  # keys of [output] that select optional content of a step
    whole_path: bool = False  # whether the numbers of a step depend on the whole path, not only on its points so far
    own_steps: bool = False  # whether it takes the steps of ``loading.adaptive`` between the points of a path
    threads: int = 1  # cores that a case of any surface keeps busy

    @property
    def code(self) -> Any:
        """Module of the model."""
        return importlib.import_module(self.module)

    def needs(self, case: "Case") -> Need:
        """Return the largest memory that a case needs; raises InputError if the model cannot run it."""
        shape, own = case.surface.shape or (0, 0), getattr(self.code, "needs", None)
        grid = Need(on_grid(shape), f"surface.shape = {list(shape)}", "fewer points")
        if self.kind != "theory" and case.output.leakage:
            culprit = f"output.leakage on surface.shape = {list(shape)}"
            grid = Need(of_leakage(shape), culprit, "fewer points, or leave output.leakage out")
        return max([grid, *(own(case) if own else ())], key=lambda need: need.size)


_YANG = "C. Yang, B. N. J. Persson, J. Israelachvili, K. Rosenberg, EPL 84, 46004 (2008)"

_ALL = (
    Model(
        command="bem-adhesion",
        kind="continuum",
        module="bem_adhesion.study.model",
        description="boundary elements: elastic half-space on a rigid rough surface, hard wall or adhesive",
        references=_YANG,
        ignores=("atomistic", "sampling", "dynamics", "theory"),
        own_steps=True,
    ),
    Model(
        command="md-reference",
        kind="atomistic",
        module="md_reference.study.model",
        description="Atomistic reference: a harmonic block of atoms, condensed exactly to its bottom layer, in "
        "equilibrium at zero or another temperature on a rigid rough layer of Lennard-Jones sites",
        references=_YANG,
        takes_predictor=True,
        ignores=("adhesion_map", "theory"),
        keeps=("fields", "leakage", "atoms"),
    ),
    Model(
        command="persson-theory",
        kind="theory",
        module="theory.study.model",
        description="Persson's theory of rough contact with adhesion, and beside it the gap-flow theory and the edge "
        "flow",
        references=f"{_YANG}; "
        "B. N. J. Persson, J. Chem. Phys. 115, 3840 (2001); akin to the gap flow: J. Joe, Traction Between Rough "
        "Surfaces, PhD thesis, University of Michigan (2021), https://hdl.handle.net/2027.42/169927",
        ignores=("adhesion_map", "atomistic", "overdamped", "sampling", "dynamics"),
        whole_path=True,  # the separation curve and the gap flow's grid extend as far as the path asks
        threads=2,  # the edge flow beside Persson's theory and the gap flow
    ),
)
WORDS = {"continuum": "continuum", "atoms": "atomistic", "theory": "theory"}  # kinds by what users write for them
MODELS: dict[str, Model] = {model.kind: model for model in _ALL}


def check_study(model: Model, study: "Study") -> list[str]:
    """Check a study before any work; returns warnings about it as a whole."""
    from contact_study.study.checks import review

    notes = [*study.notes, *review(study)]
    for case in study.cases:
        if case.surface.absent and model.kind != "theory":
            raise InputError(
                f"missing key surface.kind: {model.command} needs a surface; the study has a spectrum only"
            )
        model.code.check(case)
    _ = study.bins  # a height map may be none
    return [*notes, *model.code.review(study, study.scales)]
