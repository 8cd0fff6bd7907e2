"""Every law in the solver and in a study: states checked by what the solver does not use."""

import warnings

import numpy as np
import pytest

import contact_study
from bem_adhesion.kernels.law import LawKernels
from bem_adhesion.kernels.local_energy import kernels_of
from tests.bem_adhesion.paper_system import study_table
from tests.laws_of_all_kinds import EVERY_LAW, KEYS

pytestmark = pytest.mark.filterwarnings("ignore:grid too coarse")

SOFT = {name: law for name, law in EVERY_LAW.items() if name != "hard_wall"}
every_law = pytest.mark.parametrize("law", SOFT.values(), ids=SOFT)
LOADS = {"pressure": (0.2e9, 2e9, 20e9, 1e9), "gap": (6e-10, 2e-10, 0.3e-10, 4e-10)}


@every_law
def test_passes_are_the_law(law):
    passes = kernels_of(law)
    gap = law.equilibrium_distance + law.length * np.linspace(-0.3 if not law.has_wall else 0, 3, 40).reshape(1, -1)
    traction, stiffness = np.empty_like(gap), np.empty_like(gap)
    total = passes.evaluate(gap, traction, stiffness)
    assert total == pytest.approx(law.potential(gap).sum(), rel=1e-12)
    np.testing.assert_allclose(traction, law.traction(gap), rtol=1e-11, atol=1e-13 * np.abs(traction).max())
    np.testing.assert_allclose(stiffness, law.stiffness(gap), rtol=1e-7, atol=1e-9 * np.abs(stiffness).max())
    if not law.has_wall:
        # A repelled point moves in its traction: a step that relieves it lands where the law carries that.
        repelled = gap[law.traction(gap) < 0].reshape(1, -1)
        step = 1e-3 * (law.equilibrium_distance - repelled)
        out = np.empty_like(repelled)
        LawKernels(law).advance(repelled, step, 0.4, out)
        wanted = law.traction(repelled) + law.stiffness(repelled) * step
        np.testing.assert_allclose(law.traction(out), wanted, rtol=1e-9, atol=1e-9 * np.abs(wanted).max())


def test_points_enter_a_repulsion_without_a_peak_on_its_tangent():
    """With no force there the descent would leave them at the onset, where nothing stiff tells it of them."""
    law = EVERY_LAW["repulsive"]
    gap, out = np.full((1, 1), 1.05 * law.length), np.empty((1, 1))
    LawKernels(law).advance(gap, np.full((1, 1), -0.1 * law.length), 0.4, out)
    assert law.traction(out).item() == pytest.approx(-0.05 * law.length * law.equilibrium_stiffness, rel=1e-9)


@pytest.mark.parametrize("control", LOADS)
@pytest.mark.parametrize("name", KEYS)
def test_a_whole_study(name, control):
    """From the keys to the dataset, there and back, both controls; tension where the law has some."""
    table = study_table(32, size=500e-10, loading={"path": list(LOADS[control]), "control": control, "unload": True})
    table["interaction"] = {"law": name, **KEYS[name]}
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*process zone.*")
        dataset = contact_study.run(table, "continuum")
    law = EVERY_LAW[name]
    assert bool(np.all(dataset.converged == 1))
    assert dataset.work_of_adhesion.item() == pytest.approx(law.work_of_adhesion, rel=1e-12)
    assert dataset.equilibrium_distance.item() == pytest.approx(law.equilibrium_distance, abs=0, rel=1e-12)
    assert dataset.peak_tensile_stress.item() == pytest.approx(law.peak_tensile_stress, rel=1e-12)
    area = dataset.relative_contact_area.values
    order = np.argsort(dataset.mean_gap.values[:3])
    assert np.all(np.diff(area[:3][order]) < 0), "closer surfaces touch more"
    assert 0 < area.min() < area.max() <= 1
