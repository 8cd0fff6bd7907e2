"""The atoms by the face that they share with the continuum."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from contact_study.study.case import realise
from md_reference import rough_contact
from md_reference.study.model import solve_path
from tests.md_reference.systems import LATTICE_CONSTANT, LENGTH, POISSONS_RATIO, WELL_DEPTH, YOUNGS_MODULUS, case_of

BLOCK = {
    "lattice_constant": LATTICE_CONSTANT,
    "youngs_modulus": YOUNGS_MODULUS,
    "poissons_ratio": POISSONS_RATIO,
    "well_depth": WELL_DEPTH,
    "length": LENGTH,
}


def wavy(points):
    height = 2e-10 * np.sin(2 * np.pi * np.arange(points) / points)[:, None] * np.ones(points)
    return rough_contact(height, points * LATTICE_CONSTANT, **BLOCK)


def flat(**arguments):
    return rough_contact(**{"height": np.zeros((8, 8)), "size": 12 * LATTICE_CONSTANT, **BLOCK, **arguments})


@pytest.mark.parametrize(("control", "path"), [("pressure", (1e9, -0.2e9)), ("gap", (3e-10, 2e-10))])
def test_a_height_array_gives_what_a_study_does(control, path):
    case = case_of((48, 40), ratio=2.0, path=path, control=control, atomistic={"cutoff": 3.0, "layers": 20})
    surface = realise(case)
    # The surface's waves fit on 30 points a side: the array is the surface.
    height, size = surface.heights((30, 30)), tuple(n * LATTICE_CONSTANT for n in (48, 40))
    given = BLOCK | {"well_depth": 2 * WELL_DEPTH}
    contact = rough_contact(height, size, **given, control=control, cutoff=3.0, layers=20)
    state = contact.separated()
    for target, own in zip(path, solve_path(case, surface), strict=True):
        found = contact.step(state, target)
        state = found.state
        assert found.converged
        # Heights interpolated from another grid differ by rounding; residuals of 1e-8 E* a² over the softest mode.
        np.testing.assert_allclose(found.gap, own.gap, rtol=0, atol=1e-6 * LENGTH)
        assert found.mean_separation == pytest.approx(own.mean_separation, abs=1e-6 * LENGTH)
        assert found.elastic_energy == pytest.approx(own.elastic_energy, rel=1e-5)
        assert found.interaction_energy == pytest.approx(own.interaction_energy, rel=1e-5)


def test_states_are_distinguished():
    contact = flat()
    assert contact.is_separated(contact.separated())
    torn = contact.step(contact.separated(), -1e6)
    assert torn.detached
    assert torn.message.startswith("detached")
    assert contact.is_separated(torn.state)
    pressed = contact.step(torn.state, 1e9)
    assert not contact.is_separated(pressed.state)
    assert pressed.pressure.mean() == pytest.approx(1e9, rel=1e-6)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"height": np.full((8, 8), np.inf)}, "height is not finite"),
        ({"height": [[1, 2], [3]]}, "height must be an array"),
        ({"size": "3 nm"}, "size"),
        ({"size": 12.3 * LATTICE_CONSTANT}, "lattice_constant"),
        ({"well_depth": -1.0}, "well_depth"),
        ({"length": "3.28 angstrom"}, "length"),
        ({"cutoff": 1.1}, r"cutoff = 1\.1: must be at least 2 lengths"),
        ({"poissons_ratio": 0.5}, "poissons_ratio"),
        ({"poissons_ratio": None}, "poissons_ratio"),
        ({"control": "force"}, "control"),
        ({"tolerance": -1e-8}, "tolerance"),
    ],
)
def test_bad_arguments_are_named(arguments, message):
    with pytest.raises(ValueError, match=message):
        flat(**arguments)


@pytest.mark.parametrize(
    ("state", "target", "message"),
    [
        (np.zeros((3, 12, 12)), np.nan, "target = nan"),
        (np.zeros((3, 4, 4)), 1e9, "state has shape"),
        (np.zeros((3, 12, 12)), "1 GPa", "target = '1 GPa'"),
        (None, 1e9, "state is None"),
    ],
)
def test_bad_states_and_targets_are_named(state, target, message):
    with pytest.raises(ValueError, match=message):
        flat().step(state, target)


def test_a_solution_starts_a_step_and_speaks_for_itself():
    contact = wavy(12)
    found = contact.step(contact.separated(), 1e9)
    further = contact.step(found, 9e9)
    np.testing.assert_array_equal(further.gap, contact.step(found.state, 9e9).gap)
    assert found.relative_contact_area == np.mean(found.gap < 2 ** (1 / 6) * LENGTH)
    assert 0 < found.relative_contact_area < further.relative_contact_area
    assert found.mean_gap == found.gap.mean() - LENGTH
    assert len({found, further}) == len(repr(found).splitlines()) == 2


def test_threads_that_share_a_block_take_turns_and_find_their_start_as_it_was():
    contact, loads = wavy(32), (0.5e9, 1e9, 2e9, 4e9)
    start = contact.separated()
    alone = [contact.step(start, load) for load in loads]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda load: contact.step(start, load), loads))
    for one, other in zip(alone, together, strict=True):
        assert other.converged
        np.testing.assert_array_equal(one.gap, other.gap)
    with pytest.raises(ValueError, match="read-only"):
        alone[0].displacement[...] = 0
