"""Random studies of the continuum, of extreme solids too, none of whose states is wrong; the check finds faults."""

from dataclasses import replace

import numpy as np
import pytest

from bem_adhesion import rough_contact
from contact_study.problem.laws import LAWS
from contact_study.problem.study import make_study
from contact_study.problem.surface import realise
from scripts import random_studies


@pytest.mark.validation
@pytest.mark.parametrize("extreme", [False, True])
@pytest.mark.parametrize("first", range(0, 40, 10))
def test_no_state_is_wrong(first, extreme):
    verdicts = [random_studies.checked(number, extreme) for number in range(first, first + 10)]
    assert {verdict.law for verdict in verdicts} == set(LAWS)
    assert [fault for verdict in verdicts for fault in verdict.faults] == []
    # All of these converge; a flag here is a solver that has got worse.
    assert [flag for verdict in verdicts for flag in verdict.flagged] == []
    assert sum(verdict.states for verdict in verdicts) >= 40


def test_extreme_studies_differ_in_the_solid_alone():
    for number in range(40):
        plain, extreme = random_studies.study_of(number), random_studies.study_of(number, extreme=True)
        kind, boundary = (extreme["elasticity"][name] for name in ("kind", "boundary"))
        same = {"surface", "material", "interaction"} | ({"loading"} if kind != "transversely_isotropic" else set())
        assert all(plain[name] == extreme[name] for name in same)
        assert (plain["elasticity"] == extreme["elasticity"]) == (kind == "half_space")
        assert kind != "transversely_isotropic" or boundary == "free"


@pytest.mark.parametrize("number", [0, 1, 6, 9])
def test_faults_are_found(number):
    """A state that is stretched, sheared off its load or lifted is not taken for one."""
    case = make_study(random_studies.study_of(number)).cases[0]
    surface = realise(case)
    contact = rough_contact(
        surface.sampled,
        surface.grid.size,
        case.solid,
        case.law,
        case.loading.control,
        boundary=case.elasticity.boundary,
    )
    target = case.path[1][0]
    found = contact.step(contact.separated(), target)

    def faults(state, wanted=target):
        verdict = random_studies.Verdict(number, case.interaction.law)
        rng = np.random.default_rng(0)
        random_studies._check(case, contact, surface.sampled, surface.grid, wanted, state, rng, verdict)
        return " ".join(verdict.faults)

    assert faults(found) == ""
    assert "out of balance" in faults(replace(found, pressure=found.pressure * 1.001))
    lifted = found.gap + 1e-3 * np.abs(found.gap).max() * np.cos(np.arange(found.gap.shape[1]))
    lifted = np.maximum(lifted, 0)
    state = found.state.copy()
    if case.interaction.law != "hard_wall":
        state[: lifted.shape[0], : lifted.shape[1]] = surface.sampled + lifted
    assert "out of balance" in faults(replace(found, gap=lifted, state=state))
    assert f"{case.loading.control} is" in faults(found, 1.01 * target)
