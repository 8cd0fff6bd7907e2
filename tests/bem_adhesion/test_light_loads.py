"""Loads far below tolerance × E*: they are carried, whatever the law, solid, boundary and way, and in few steps."""

import warnings

import numpy as np
import pytest

import contact_study
from bem_adhesion import (
    Exponential,
    HardWall,
    Layer,
    LennardJones104,
    Repulsive,
    Viscoelastic,
    ViscoelasticContact,
    rough_contact,
)
from tests.bem_adhesion.paper_system import study_table
from tests.bem_adhesion.rough_surfaces import random_heights, stepped
from tests.laws_of_all_kinds import EVERY_LAW

pytestmark = pytest.mark.filterwarnings("ignore:grid too coarse")

E_STAR, SIZE = 230e9, 1e-6
# Of the pressure: what may be missing of a light one with the default tolerance, by its share of LIGHT. Of 1 Pa,
# 4e-12 E*, rounding leaves up to 3e-5.
SHARE = 3e-5


def heights(rms, points=48, seed=3):
    return rms * random_heights((points, points), 2.3, seed)[0]


def carried(found, load):
    assert found.converged, found.message
    return found.pressure.mean() == pytest.approx(load, rel=SHARE)


@pytest.mark.parametrize("load", [1.0, 2e3])
@pytest.mark.parametrize("law", EVERY_LAW.values(), ids=EVERY_LAW)
def test_every_law_carries_a_light_load(law, load):
    contact = rough_contact(heights(5e-9), SIZE, E_STAR, law, max_iterations=100)
    found = contact.step(contact.separated(), load)
    assert carried(found, load)
    assert found.pressure.max() > load


@pytest.mark.parametrize(("law", "rms"), [(Exponential(5e-3, 1e-9), 5e-9), (LennardJones104(1e-3, 3.4e-10), 3e-8)])
def test_surfaces_come_together_under_next_to_no_load(law, rms):
    """Weak attraction far away has a mean that hardly anything holds: each of 2000 steps went a ten-thousandth."""
    contact = rough_contact(heights(rms), SIZE, E_STAR, law, max_iterations=100)
    for load in (1.0, 100.0):
        assert carried(contact.step(contact.separated(), load), load)


def test_a_light_load_follows_a_heavy_one():
    contact = rough_contact(heights(5e-9), SIZE, E_STAR, LennardJones104(0.05, 3.28e-10), max_iterations=100)
    loads = (1e8, 1e3, -10.0, 1.0)
    assert all(map(carried, stepped(contact, loads), loads))


@pytest.mark.parametrize("load", [0.1, 1.0])
def test_stresses_below_the_tolerance_are_in_balance(load):
    """Under so light a load the largest stress itself may be less than 1e-8 E*."""
    height, grid = random_heights((48, 48), 2.3, 3)
    contact = rough_contact(5e-9 * height, SIZE, E_STAR, Repulsive(0.0, 1e-9, 1e-3))
    found = contact.step(contact.separated(), load)
    assert found.pressure.max() < 1e-7 * E_STAR
    elastic = np.fft.irfft2(0.5 * E_STAR * grid.wavenumber / SIZE * np.fft.rfft2(found.displacement), grid.shape)
    np.testing.assert_allclose(elastic + load, found.pressure, atol=2e-4 * found.pressure.max())


@pytest.mark.parametrize("law", [HardWall(), Exponential(0.05, 1e-9), Repulsive(0.0, 1e-9, 0.05)])
@pytest.mark.parametrize(
    ("solid", "options"), [(E_STAR, {"boundary": "free"}), (Layer(E_STAR, 0.3, 1e-7), {}), (E_STAR, {"threads": 2})]
)
def test_every_solid_and_boundary_carries_a_light_load(law, solid, options):
    contact = rough_contact(heights(5e-9), SIZE, solid, law, **options)
    for load in (1.0, 1e3):
        assert carried(contact.step(contact.separated(), load), load)


def test_a_surface_that_yields_carries_a_light_load():
    contact = rough_contact(heights(5e-9), SIZE, E_STAR, HardWall(), hardness=1e9)
    pressed = contact.step(contact.separated(), 1e8)
    assert carried(contact.step(pressed.state, 1.0), 1.0)


def test_a_viscoelastic_solid_carries_a_light_load():
    solid = Viscoelastic(E_STAR, (E_STAR,), (1.0,))
    contact = ViscoelasticContact(heights(5e-9), SIZE, solid, Exponential(0.05, 1e-9))
    state = contact.separated()
    for load in (1.0, 1e3):
        found, _ = contact.step(state, load, 0.1)
        state = found.state
        assert carried(found, load)


@pytest.mark.parametrize("load", [1.0])
def test_slow_motion_ends_under_a_light_load(load):
    table = study_table(32, size=80e-10, surface={"rms_height": 3e-10, "cutoff_mode": 6})
    table["loading"], table["solver"] = {"path": [load]}, {"path": "overdamped"}
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*process zone.*")
        found = contact_study.run(table, "continuum").isel(step=0)
    assert found.converged == 1
    assert found.mean_pressure.item() == pytest.approx(load, rel=SHARE)


@pytest.mark.parametrize("law", [Exponential(0.05, 1e-9), LennardJones104(0.05, 1e-9)])
def test_a_load_that_rounding_hides_is_none(law):
    """As where a path of evenly spaced pressures passes zero."""
    contact = rough_contact(heights(5e-9), SIZE, E_STAR, law, max_iterations=100)
    state = contact.step(contact.separated(), 1e6).state
    unloaded = contact.step(state, 0.0)
    for load in (1e-7, -1e-12):
        found = contact.step(state, load)
        assert found.converged
        np.testing.assert_allclose(found.gap, unloaded.gap, atol=1e-6 * law.length)
