"""A trace of a solve: its pairs are the solution's, its last residual too, and it changes nothing."""

import numpy as np
import pytest

from bem_adhesion import HardWall, rough_contact
from tests.bem_adhesion.paper_system import E_STAR, law, surface

ROUGH = surface(64)


@pytest.mark.parametrize(
    ("interaction", "options"),
    [
        (law(4.0), {}),
        (HardWall(), {}),
        (HardWall(), {"hardness": 8e9}),
        (law(), {"boundary": "free"}),
    ],
    ids=["adhesive", "wall", "plastic", "free"],
)
@pytest.mark.filterwarnings("ignore:grid too coarse")
def test_a_trace_has_the_pairs_and_the_residual_of_the_solution(interaction, options):
    marks = []
    arguments = (ROUGH.sampled, ROUGH.size, E_STAR, interaction)
    traced = rough_contact(*arguments, trace=marks.append, **options)
    first = len(marks)
    found = traced.step(traced.separated(), 2e9)
    phases = {mark.phase for mark in marks}
    assert {"transform", "spectrum", "points", "iteration"} <= phases
    assert ("extension" in phases) == isinstance(interaction, HardWall)
    spent = marks[-1].pairs - (marks[first - 1].pairs if first else 0.0)
    assert spent == pytest.approx(found.fft_pairs, rel=1e-12)
    finest = max(mark.shape for mark in marks)
    residuals = [mark.residual for mark in marks if mark.phase == "iteration" and mark.shape == finest]
    assert residuals[-1] == found.residual
    assert sum(mark.phase == "transform" for mark in marks) == sum(mark.phase == "spectrum" for mark in marks) * 2
    plain = rough_contact(*arguments, **options)
    np.testing.assert_array_equal(plain.step(plain.separated(), 2e9).gap, found.gap)
