"""Loads far below tolerance × E*: they are carried, whatever the law, solid, boundary and way, and in few steps."""

from functools import partial

import numpy as np
import pytest

import contact_study
from bem_adhesion import Exponential, HardWall, Layer, LennardJones104, Repulsive, Viscoelastic, rough_contact
from tests.bem_adhesion.paper_system import random_heights, stepped, study_table
from tests.bem_adhesion.test_contract import OfOneSecond
from tests.laws_of_all_kinds import EVERY_LAW

pytestmark = pytest.mark.filterwarnings("ignore:grid too coarse", "ignore:.*process zone")

E_STAR, SIZE = 230e9, 1e-6
# Of the pressure: what may be missing of a light one with the default tolerance, by its share of LIGHT. Of 1 Pa,
# 4e-12 E*, rounding leaves up to 3e-5.
SHARE = 3e-5
ROUGH = 5e-9 * random_heights((48, 48), 2.3, 3)[0]
SHORT, BED = Exponential(0.05, 1e-9), Repulsive(0.0, 1e-9, 0.05)
LIGHT = (1.0, 2e3)


def few(law, solid=E_STAR, height=ROUGH, **options):
    return partial(rough_contact, height, SIZE, solid, law, max_iterations=100, **options)


PATHS = {
    **{name: (few(law), LIGHT) for name, law in EVERY_LAW.items()},
    # Weak attraction far away has a mean that hardly anything holds: each of 2000 steps went a ten-thousandth.
    "weak": (few(Exponential(5e-3, 1e-9)), (1.0, 100.0)),
    "far away": (few(LennardJones104(1e-3, 3.4e-10), height=6 * ROUGH), (1.0, 100.0)),
    "after a heavy one": (few(LennardJones104(0.05, 3.28e-10)), (1e8, 1e3, -10.0, 1.0)),
    "yielded": (few(HardWall(), hardness=1e9), (1e8, 1.0)),
    "in time": (partial(OfOneSecond, ROUGH, SIZE, Viscoelastic(E_STAR, (E_STAR,), (1.0,)), SHORT), LIGHT),
    **{f"free {law}": (few(law, boundary="free"), LIGHT) for law in (HardWall(), SHORT, BED)},
    **{f"layer {law}": (few(law, Layer(E_STAR, 0.3, 1e-7)), LIGHT) for law in (HardWall(), SHORT, BED)},
    "threads": (few(SHORT, threads=2), LIGHT),
}


@pytest.mark.parametrize(("make", "loads"), PATHS.values(), ids=PATHS)
def test_a_light_load_is_carried(make, loads):
    for load, found in zip(loads, stepped(make(), loads), strict=True):
        assert found.converged, found.message
        assert found.pressure.mean() == pytest.approx(load, rel=SHARE)
        assert found.pressure.max() > load


@pytest.mark.parametrize("load", [0.1, 1.0])
def test_stresses_below_the_tolerance_are_in_balance(load):
    _, grid = random_heights((48, 48), 2.3, 3)
    [found] = stepped(few(Repulsive(0.0, 1e-9, 1e-3))(), [load])
    assert found.pressure.max() < 1e-7 * E_STAR
    elastic = np.fft.irfft2(0.5 * E_STAR * grid.wavenumber / SIZE * np.fft.rfft2(found.displacement), grid.shape)
    np.testing.assert_allclose(elastic + load, found.pressure, atol=2e-4 * found.pressure.max())


def test_slow_motion_ends_under_a_light_load():
    table = study_table(32, size=80e-10, surface={"rms_height": 3e-10, "cutoff_mode": 6})
    table["loading"], table["solver"] = {"path": [1.0]}, {"path": "overdamped"}
    found = contact_study.run(table, "continuum").isel(step=0)
    assert found.converged == 1
    assert found.mean_pressure.item() == pytest.approx(1.0, rel=SHARE)


@pytest.mark.parametrize("law", [SHORT, LennardJones104(0.05, 1e-9)])
def test_a_load_that_rounding_hides_is_none(law):
    contact = few(law)()
    state = contact.step(contact.separated(), 1e6).state
    unloaded = contact.step(state, 0.0)
    for load in (1e-7, -1e-12):
        found = contact.step(state, load)
        assert found.converged
        np.testing.assert_allclose(found.gap, unloaded.gap, atol=1e-6 * law.length)
