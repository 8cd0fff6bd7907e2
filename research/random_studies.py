"""Random studies of the continuum, each state checked by other means than the solver's.

Law, solid, boundaries, roughness, grid, control and path are drawn at random, and whether a study is one of a hardness,
of a viscoelastic solid, of steps of its own or of a tabulated stiffness. Of every state that calls itself converged

- the balance is formed anew in float64, by NumPy's transforms or, with free boundaries, by direct convolution, from
  K(q) or the displacement of a cell, and from the law's own functions: none of the solver's passes, kernels or sums;
- the energies it reports are their definitions';
- no small random change, rough or smooth, that a wall allows may lower the energy: it is a minimum;
- a second start, from the state after such a change, must come back to it; next to a fold (counted as "narrow") from a
  hundredth of the change;
- and what else makes a state of its kind, see the modules of ``research/state_checks``.

A state that is none of that is wrong; one that is flagged is counted, and no fault.

    python -m research.random_studies --studies 100
"""

import argparse
import sys
from collections.abc import Iterator
from itertools import count, islice

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.physics.solids import Viscoelastic
from contact_study.study.case import Case, realise
from contact_study.study.study import make_study
from research.state_checks import equilibrium, own_steps, relaxing, yielding
from research.state_checks.drawing import SUBJECTS, Drawn, drawn
from research.state_checks.state import Study, Surfaces, Tally, Verdict
from scripts.harness import Option, program, show


def run(given: argparse.Namespace) -> int:
    laws: dict[str, Tally] = {}
    subjects: dict[str, Tally] = {}
    total = Tally()
    for number in islice(_numbers(given.first, given.subject), given.studies):
        verdict = checked(number, given.extreme)
        for fault in verdict.faults:
            print(f"study {number}: {fault}", file=sys.stderr, flush=True)
        laws.setdefault(verdict.law, Tally()).add(verdict)
        for subject in verdict.subjects:
            subjects.setdefault(subject, Tally()).add(verdict)
        total.add(verdict)
    names = (
        "studies of",
        "studies",
        "states",
        "detached",
        "flagged",
        "narrow",
        "wrong",
        "worst balance",
        "worst return",
    )
    every = [*sorted(laws.items()), ("all", total), *sorted(subjects.items())]
    show(names, ((name, *tally.cells()) for name, tally in every))
    return 1 if total.wrong else 0


def _numbers(first: int, subject: str | None) -> Iterator[int]:
    """Of the studies from the first on, or of those of a subject."""
    return (number for number in count(first) if subject is None or subject in drawn(number).subjects)


def checked(number: int, extreme: bool = False) -> Verdict:
    """Solve and check one study."""
    drawing = drawn(number, extreme)
    verdict = Verdict(number, drawing.table["interaction"]["law"], drawing.subjects)
    try:
        case = make_study(drawing.table).cases[0]
    except InputError as error:
        # Constants that fit no solid or path: an answer, in one line.
        verdict.flagged.append(str(error))
        return verdict
    study = study_of(number, case, drawing, verdict)
    if isinstance(case.solid, Viscoelastic):
        relaxing.follow(study)
    elif case.material.hardness is not None:
        yielding.follow(study)
    elif case.loading.adaptive:
        own_steps.follow(study)
    else:
        equilibrium.follow(study)
    return verdict


def study_of(number: int, case: Case, drawing: Drawn, verdict: Verdict) -> Study:
    """A case as the checks take it; a tabulated stiffness is checked against the solid that was tabulated."""
    surface = realise(case)
    solid = case.solid if drawing.closed_form is None else make_study(drawing.closed_form).cases[0].solid
    free = case.elasticity.boundary == "free"
    surfaces = Surfaces(case.law, solid, surface.sampled, surface.grid, case.loading.control, free)
    return Study(case, surface, surfaces, np.random.default_rng([21, number]), verdict)


main = program(
    run,
    Option("--studies", 500, "how many"),
    Option("--first", 0, "number of the first: each study follows from its number"),
    Option("--subject", str, "leave out those that are not about it", choices=SUBJECTS),
    Option(
        "--extreme",
        False,
        "thinner layers, bases of more different moduli, transversely isotropic half-spaces with free boundaries",
    ),
)

if __name__ == "__main__":
    sys.exit(main())
