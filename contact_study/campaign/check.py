"""Everything that may refuse a study, and all that is to be said of it, before any work."""

from contact_study.campaign.model import Model
from contact_study.errors import InputError
from contact_study.numerics.distributions import Bins
from contact_study.study.bins import bins_of
from contact_study.study.checks.plausibility import review
from contact_study.study.study import Study


def checked(model: Model, study: Study) -> tuple[Bins, list[str]]:
    """The bins of the study's distributions, and what a user must know of it as a whole.

    Raises
    ------
    InputError
        If the model cannot serve it, or its numbers cannot belong together.
    """
    notes = [*study.notes, *review(study)]
    for case in study.cases:
        if case.surface.absent and model.kind != "theory":
            raise InputError(
                f"missing key surface.kind: {model.command} needs a surface; the study has a spectrum only"
            )
        model.check(case)
    return bins_of(study), [*notes, *model.review(study, study.scales)]
