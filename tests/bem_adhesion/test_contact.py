"""The face that both continuum solvers share."""

import re
import warnings
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import contact_study
from bem_adhesion import (
    Exponential,
    HalfSpace,
    HardWall,
    Layer,
    LennardJones104,
    Repulsive,
    Viscoelastic,
    ViscoelasticContact,
    rough_contact,
)
from contact_study.inputs.units import quantity
from tests.bem_adhesion.paper_system import E_STAR, SIZE, self_affine, study_table

LAW = LennardJones104(work_of_adhesion=0.2, length=3.28e-10)
HEIGHT = 3e-11 * np.random.default_rng(0).standard_normal((16, 16))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"height": "a map"}, "height must be an array"),
        ({"height": np.zeros(8)}, r"height has shape \(8,\)"),
        ({"height": np.diag([np.inf] + 7 * [0.0])}, "height is not finite everywhere: 1 point is not"),
        ({"size": "10 nm"}, "size = '10 nm'.*in m"),
        ({"size": (1e-9, -1e-9)}, "size = -1e-09"),
        ({"size": (1e-9,)}, "one period or two"),
        ({"elasticity": -1.0}, "contact_modulus"),
        ({"control": "force"}, "control = 'force'"),
        ({"tolerance": 0.0}, "tolerance"),
        ({"max_iterations": "many"}, "max_iterations"),
        ({"law": "lennard_jones_10_4"}, "law = 'lennard_jones_10_4'"),
        ({"hardness": 1e9}, "hardness: known of a hard wall without adhesion, not of LennardJones104; leave"),
        ({"boundary": "open"}, "boundary = 'open'"),
        ({"boundary": "free", "control": "gap"}, "'pressure' or 'approach'"),
        ({"boundary": "free", "elasticity": Layer(1e9, 0.3, 1e-9)}, "those of a half-space"),
        ({"elasticity": Viscoelastic(1e9, (1e9,), (1.0,))}, "ViscoelasticContact"),
        ({"control": "approach", "elasticity": HalfSpace(1e9)}, "'approach': .* moves this solid by no finite"),
        ({"control": "approach", "elasticity": Layer(1e9, 0.5, 1e-9), "law": HardWall()}, "moves this solid by no"),
    ],
)
def test_bad_arguments_are_named(arguments, message):
    valid = {"height": np.zeros((8, 8)), "size": 1e-8, "elasticity": 1e9, "law": LAW}
    with pytest.raises(ValueError, match=message):
        rough_contact(**(valid | arguments))


@pytest.mark.parametrize(("law", "words"), [(LAW, "gaps <= 0"), (Exponential(0.5, 1e-10), "gaps < 0")])
def test_a_start_inside_the_surface_is_refused(law, words):
    contact = rough_contact(HEIGHT, 7e-9, E_STAR, law)
    with pytest.raises(ValueError, match=words):
        contact.step(HEIGHT - 1e-10, 1e9)


@pytest.mark.parametrize(
    ("law", "keys"),
    [
        (LAW, {"work_of_adhesion": 0.2, "length": 3.28e-10}),
        (Exponential(0.5, 1e-10), {"law": "exponential", "work_of_adhesion": 0.5, "length": 1e-10}),
        (HardWall(), {"law": "hard_wall"}),
    ],
)
def test_a_solution_has_the_numbers_of_a_dataset_and_compares_by_identity(law, keys):
    dataset = contact_study.run(
        {
            "surface": {"heights": HEIGHT, "size": 7e-9},
            "material": {"youngs_modulus": 0.91 * E_STAR, "poissons_ratio": 0.3},
            "interaction": keys,
            "loading": {"path": ["1 GPa"]},
        }
    )
    contact = rough_contact(HEIGHT, 7e-9, E_STAR, law, tolerance=1e-8)
    one, other = (contact.step(contact.separated(), 1e9) for _ in range(2))
    assert one.relative_contact_area == dataset.relative_contact_area.item() > 0
    assert one.mean_gap == pytest.approx(dataset.mean_gap.item(), rel=1e-6)
    assert len({one, one, other}) == 2
    first, second = repr(one).splitlines()
    assert f"relative contact area {one.relative_contact_area:.4g}, mean gap" in first
    assert "converged" in second


@pytest.mark.parametrize("options", [{}, {"boundary": "free"}])
def test_a_grid_that_does_not_resolve_its_law_is_told_of(options):
    height, _ = self_affine(64)
    strong = LennardJones104(5.52, 3.28e-10)

    def told(points, law):
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            rough_contact(np.zeros((points, points)) if points != 64 else height, SIZE, E_STAR, law, **options)
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
def test_a_study_and_a_viscoelastic_contact_say_it_once(kind):
    table = study_table(32, size=500e-10, loading={"path": [1e9]})
    table["interaction"]["length"] = 1e-10
    if kind == "viscoelastic":
        table["elasticity"] = {"kind": kind, "branch_youngs_moduli": [5e9], "relaxation_times": ["1 s"]}
        table["loading"] |= {"duration": "1 s", "time_steps": 2}
        with pytest.warns(UserWarning, match="grid too coarse"):
            contact = ViscoelasticContact(HEIGHT, 100e-9, Viscoelastic(1e9, (1e9,), (1.0,)), LAW)
        contact.step(contact.separated(), 1e6, 0.1)  # a warning here were an error
    with pytest.warns(UserWarning, match="grid too coarse") as said:
        contact_study.run(table, "continuum")
    assert len(said) == 1


@pytest.mark.filterwarnings("ignore:grid too coarse")
@pytest.mark.parametrize("law", [LAW, HardWall()])
def test_threads_that_share_a_contact_take_turns(law):
    contact = rough_contact(self_affine(64)[0], SIZE, E_STAR, law)
    start, loads = contact.separated(), np.linspace(0.5e9, 4e9, 8)
    alone = [contact.step(start, load) for load in loads]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda load: contact.step(start, load), loads))
    for one, other in zip(alone, together, strict=True):
        assert other.converged
        np.testing.assert_array_equal(one.gap, other.gap)
