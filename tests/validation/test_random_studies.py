"""Random studies of the continuum, of extreme solids too, none of whose states is wrong; the checks find faults."""

from dataclasses import replace

import numpy as np
import pytest

from bem_adhesion.contacts.rough_contact import PlasticContact
from bem_adhesion.contacts.viscoelastic import ViscoelasticContact
from bem_adhesion.study import paths as equilibrium_path
from contact_study.physics.laws import LAWS
from contact_study.physics.solids import Layer, Measured
from contact_study.study.study import make_study
from research.random_studies import checked, study_of
from research.state_checks import equilibrium
from research.state_checks.drawing import drawn
from research.state_checks.state import Point, Verdict

# Random grids are coarse on purpose: the checks hold for the equations of the grid.
pytestmark = [pytest.mark.validation, pytest.mark.filterwarnings("ignore:grid too coarse")]


@pytest.mark.parametrize("extreme", [False, True])
@pytest.mark.parametrize("first", range(0, 40, 10))
# What a random path asks for is not always wise: contact at the rim of free boundaries.
@pytest.mark.filterwarnings("ignore:elasticity.boundary")
def test_no_state_is_wrong(first, extreme):
    verdicts = [checked(number, extreme) for number in range(first, first + 10)]
    assert {verdict.law for verdict in verdicts} == set(LAWS)
    assert [fault for verdict in verdicts for fault in verdict.faults] == []
    # All of these converge; a flag here is a solver that has got worse.
    assert [flag for verdict in verdicts for flag in verdict.flagged] == []
    assert sum(verdict.states for verdict in verdicts) >= 40
    # A minimum that a change of a thousandth of a length leaves is rare.
    assert sum(verdict.narrow for verdict in verdicts) <= 1


@pytest.mark.parametrize("number", [0, 1, 6, 9])
def test_faults_are_found(number):
    """A state that is stretched, sheared off its load, lifted or of another energy is not taken for one."""
    drawing = drawn(number)
    case = make_study(drawing.table).cases[0]
    study = study_of(number, case, drawing, Verdict(number, case.interaction.law))
    contact, target = study.contact(), case.path[1][0]
    found = contact.step(contact.separated(), target)

    def faults(state, wanted=target):
        fresh = replace(study, verdict=Verdict(number, case.interaction.law), rng=np.random.default_rng(0))
        equilibrium.check_with_energies(fresh, Point.of(state), wanted, lambda start: contact.step(start, wanted))
        return " ".join(fresh.verdict.faults)

    assert faults(found) == ""
    assert "out of balance" in faults(replace(found, pressure=found.pressure * 1.001))
    lifted = np.maximum(found.gap + 1e-3 * np.abs(found.gap).max() * np.cos(np.arange(found.gap.shape[1])), 0)
    state = found.state.copy()
    if case.interaction.law != "hard_wall":
        state[: lifted.shape[0], : lifted.shape[1]] = study.surface.sampled + lifted
    assert "out of balance" in faults(replace(found, gap=lifted, state=state))
    assert f"{case.loading.control} is" in faults(found, 1.01 * target)
    assert "elastic energy" in faults(replace(found, elastic_energy=1.001 * found.elastic_energy))
    off = 1e-6 * case.law.work_of_adhesion or 1e-6
    assert "interaction energy" in faults(replace(found, interaction_energy=found.interaction_energy + off))


def _forgets_a_jump(follow):
    def cheaper(*given):
        found, passed = follow(*given)
        return found, [*passed[:-1], passed[-1]._replace(dissipated=0.9 * passed[-1].dissipated)]

    return cheaper


# Numbers of studies with a hardness, in time, in steps of their own, of an approach and of a table.
@pytest.mark.parametrize(
    ("number", "owner", "name", "broken", "words"),
    [
        (
            29,
            PlasticContact,
            "step",
            lambda of: lambda a, s, p: of(a, s * [[[1]], [[0]]], p),
            "yields where it may not",
        ),
        (26, ViscoelasticContact, "step", lambda of: lambda *a: of(*a[:3], 1.001 * a[3]), "hereditary integral"),
        (47, equilibrium_path, "adaptive_step", _forgets_a_jump, "its jumps lost"),
        (8, Layer, "mean_compliance", lambda of: property(lambda self: 1.0001 * of.fget(self)), "approach is"),
        (12, Measured, "stiffness", lambda of: lambda self, q: 1.0001 * of(self, q), "out of balance"),
    ],
)
def test_solvers_that_are_broken_are_caught(monkeypatch, number, owner, name, broken, words):
    assert checked(number).faults == []
    monkeypatch.setattr(owner, name, broken(getattr(owner, name)))
    assert words in " ".join(checked(number).faults)
