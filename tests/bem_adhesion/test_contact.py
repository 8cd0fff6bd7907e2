"""The face that both continuum solvers share."""

import re
import warnings
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import bem_adhesion
import contact_study
from bem_adhesion import (
    Exponential,
    HalfSpace,
    HardWall,
    Layer,
    Layered,
    LennardJones104,
    Repulsive,
    Viscoelastic,
    ViscoelasticContact,
    rough_contact,
)
from contact_study.inputs.units import quantity
from tests.bem_adhesion.paper_system import study_table
from tests.bem_adhesion.rough_surfaces import CONTACT_MODULUS, SIZE, self_affine
from tests.bem_adhesion.test_contract import KINDS, every_kind

LAW = LennardJones104(work_of_adhesion=0.2, length=3.28e-10)
HEIGHT = 3e-11 * np.random.default_rng(0).standard_normal((16, 16))


def test_sides_options_and_solids_reach_the_solvers():
    height, _ = self_affine(32, cutoff_mode=5)
    contact = rough_contact(height[:16], (0.5 * SIZE, SIZE), CONTACT_MODULUS, LAW, max_iterations=1)
    found = contact.step(contact.separated(), 1e9)
    assert found.outcome is bem_adhesion.Outcome.ITERATION_LIMIT
    assert found.iterations == 1
    pressures = []
    for thickness in (1e-9, 1e-6):
        on_layer = rough_contact(height, SIZE, Layer(CONTACT_MODULUS, 0.3, thickness), HardWall(), "gap")
        pressures.append(on_layer.step(on_layer.separated(), 1e-9).pressure.mean())
    assert pressures[0] > 2 * pressures[1]  # a thin layer is stiffer


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"height": "a map"}, "height must be an array"),
        ({"height": np.zeros(8)}, r"height has shape \(8,\)"),
        ({"height": np.full((8, 8), np.nan)}, "height is not finite everywhere: 64 points are not"),
        ({"height": np.diag([np.inf] + 7 * [0.0])}, "height is not finite everywhere: 1 point is not"),
        ({"size": "10 nm"}, "size = '10 nm'.*in m"),
        ({"size": (1e-9, -1e-9)}, "size = -1e-09"),
        ({"size": (1e-9,)}, "one period or two"),
        ({"elasticity": -1.0}, "contact_modulus"),
        ({"elasticity": "1 GPa"}, "contact_modulus"),
        ({"control": "force"}, "control = 'force'"),
        ({"tolerance": 0.0}, "tolerance"),
        ({"max_iterations": "many"}, "max_iterations"),
        ({"law": "lennard_jones_10_4"}, "law = 'lennard_jones_10_4'"),
        ({"hardness": 1e9}, "hardness: known of a hard wall without adhesion, not of LennardJones104; leave"),
        ({"law": HardWall(), "hardness": -1.0}, "hardness = -1"),
        ({"boundary": "open"}, "boundary = 'open'"),
        ({"boundary": "free", "control": "gap"}, "'pressure' or 'approach'"),
        ({"boundary": "free", "elasticity": Layer(1e9, 0.3, 1e-9)}, "those of a half-space"),
        ({"elasticity": Viscoelastic(1e9, (1e9,), (1.0,))}, "ViscoelasticContact"),
        *(
            ({"control": "approach", "elasticity": solid, "law": law}, "'approach': .* moves this solid by no finite")
            for solid in (HalfSpace(1e9), Layer(1e9, 0.5, 1e-9), Layered(1e9, 0.3, 1e-9, 2e9, 0.3))
            for law in (LAW, HardWall())
        ),
    ],
)
def test_bad_arguments_are_named(arguments, message):
    valid = {"height": np.zeros((8, 8)), "size": 1e-8, "elasticity": 1e9, "law": LAW}
    with pytest.raises(ValueError, match=message):
        rough_contact(**(valid | arguments))


@pytest.mark.parametrize(("law", "words"), [(LAW, "gaps <= 0"), (Exponential(0.5, 1e-10), "gaps < 0")])
def test_a_start_inside_the_surface_is_refused(law, words):
    contact = rough_contact(HEIGHT, 7e-9, CONTACT_MODULUS, law)
    with pytest.raises(ValueError, match=words):
        contact.step(HEIGHT - 1e-10, 1e9)


@every_kind
@pytest.mark.filterwarnings("ignore:grid too coarse")
@pytest.mark.parametrize(
    ("state", "target", "message"),
    [
        (None, 1e9, r"state is None: give contact\.separated\(\), or the solution of an earlier step"),
        ("separated", 1e9, "state is a str"),
        (np.zeros((3, 3)), 1e9, r"state has shape \(3, 3\)"),
        ("apart", "1 GPa", "target = '1 GPa': the mean pressure must be a finite number, in Pa"),
        ("apart", None, "target = None: the mean pressure"),
        ("apart", [1e9, 2e9], r"target = \[1000000000.0, 2000000000.0\]: the mean pressure"),
        ("apart", np.inf, "target = inf: the mean pressure"),
    ],
)
def test_bad_states_and_targets_are_named(kind, state, target, message):
    contact = KINDS[kind]()
    with pytest.raises(ValueError, match=message):
        contact.step(contact.separated() if isinstance(state, str) and state == "apart" else state, target)


def test_a_solution_has_the_numbers_of_a_dataset_and_compares_by_identity():
    study = {
        "surface": {"heights": HEIGHT, "size": 7e-9},
        "material": {"youngs_modulus": 0.91 * CONTACT_MODULUS, "poissons_ratio": 0.3},
        "loading": {"path": ["1 GPa"]},
    }
    for law, keys in (
        (LAW, {"work_of_adhesion": 0.2, "length": 3.28e-10}),
        (Exponential(0.5, 1e-10), {"law": "exponential", "work_of_adhesion": 0.5, "length": 1e-10}),
        (HardWall(), {"law": "hard_wall"}),
    ):
        contact = rough_contact(HEIGHT, 7e-9, CONTACT_MODULUS, law, tolerance=1e-8)
        one, other = (contact.step(contact.separated(), 1e9) for _ in range(2))
        dataset = contact_study.run(study | {"interaction": keys})
        assert one.relative_contact_area == dataset.relative_contact_area.item() > 0
        assert one.mean_gap == pytest.approx(dataset.mean_gap.item(), rel=1e-6)
        assert one == one
        assert one != other
        assert len({one, other}) == 2
        lines = repr(one).splitlines()
        assert len(lines) == 2
        assert max(map(len, lines)) < 120
        assert f"relative contact area {one.relative_contact_area:.4g}, mean gap" in lines[0]
        assert "converged" in lines[1]


@pytest.mark.parametrize("options", [{}, {"boundary": "free"}])
def test_a_grid_that_does_not_resolve_its_law_is_told_of(options):
    """As a study's review does; what is proposed is taken without a word."""
    height, _ = self_affine(64)
    strong = LennardJones104(5.52, 3.28e-10)

    def told(points, law):
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            rough_contact(np.zeros((points, points)) if points != 64 else height, SIZE, CONTACT_MODULUS, law, **options)
        return [str(each.message) for each in said]

    (line,) = told(64, strong)
    assert line.startswith("grid too coarse: its spacing is 1.625 nm, the process zone")
    assert "slow loading" in line
    points = int(re.search(r"; (\d+) x \1 points resolve it", line)[1])
    length = quantity(re.search(r"a length of (\S+ \S+) and", line)[1], "m", "")
    assert told(points, strong) == told(64, LennardJones104(5.52, length)) == []
    assert told(points - 64, strong) != [] != told(64, LennardJones104(5.52, 0.95 * length))
    assert told(64, HardWall()) == told(64, Repulsive(0.0, 3.28e-10, 5.52)) == []


@pytest.mark.parametrize("kind", ["half_space", "viscoelastic"])
def test_a_study_says_it_once(kind):
    """Its review does, for all cases; the contacts do not."""
    table = study_table(32, size=500e-10, loading={"path": [1e9]})
    table["interaction"]["length"] = 1e-10
    if kind == "viscoelastic":
        table["elasticity"] = {"kind": kind, "branch_youngs_moduli": [5e9], "relaxation_times": ["1 s"]}
        table["loading"] |= {"duration": "1 s", "time_steps": 2}
    with pytest.warns(UserWarning, match="grid too coarse") as said:
        contact_study.run(table, "continuum")
    assert len(said) == 1


def test_a_viscoelastic_contact_says_it_once():
    solid = Viscoelastic(1e9, (1e9,), (1.0,))
    with pytest.warns(UserWarning, match="grid too coarse"):
        contact = ViscoelasticContact(HEIGHT, 100e-9, solid, LAW)
    contact.step(contact.separated(), 1e6, 0.1)  # a warning here were an error


@pytest.mark.parametrize("law", [LAW, HardWall()])
@pytest.mark.parametrize("boundary", ["periodic", "free"])
def test_what_is_done_to_arrays_given_or_returned_changes_no_state(law, boundary):
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "grid too coarse")
        height = HEIGHT.copy()
        contact = rough_contact(height, SIZE, CONTACT_MODULUS, law, boundary=boundary)
        first = contact.step(contact.separated(), 1e9)
        expected = contact.step(first, 2e9).gap
        height *= 1.5
        for field in (first.displacement, first.pressure, first.gap):
            if field.flags.writeable:
                np.multiply(field, 1e9, out=field)
        with pytest.raises(ValueError, match="read-only"):
            first.state[...] = 0
        np.testing.assert_array_equal(contact.step(first, 2e9).gap, expected)


@pytest.mark.parametrize("law", [LAW, HardWall()])
def test_threads_that_share_a_contact_take_turns(law):
    height, _ = self_affine(96)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "grid too coarse")
        contact = rough_contact(height, SIZE, CONTACT_MODULUS, law)
    start, loads = contact.separated(), np.linspace(0.5e9, 4e9, 8)
    alone = [contact.step(start, load) for load in loads]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda load: contact.step(start, load), loads))
    for one, other in zip(alone, together, strict=True):
        assert other.converged
        np.testing.assert_array_equal(one.gap, other.gap)
