import threading

import numpy as np
import pytest

from contact_study.campaign.worker.case_run import Job, run_case
from md_reference.block.condensed import isotropic_element, lame_constants
from md_reference.block.multiscale import BlockOptions, MultiscaleBlock, NonlinearSpringBlock
from md_reference.interface.pairs import LennardJonesInterface
from md_reference.parallel_rows import ParallelRows
from md_reference.study.model import MODEL
from md_reference.study.system import row_threads
from md_reference.thermal.langevin import MolecularDynamics, fastest_wave
from tests.md_reference.systems import (
    LATTICE_CONSTANT,
    POISSONS_RATIO,
    YOUNGS_MODULUS,
    case_of,
    interface_of,
    rough_coefficients,
)
from tests.recording import bins_of_case

MASS = 3.27e-25
ATOMS = (36, 24)


@pytest.mark.parametrize(("rows", "size", "threads"), [(10, 3, 1), (10, 3, 3), (3, 8, 4), (64, 1, 2)])
def test_every_row_is_done_once(rows, size, threads):
    done = np.zeros(rows, int)

    def kernel(first, end):
        done[first:end] += 1

    ParallelRows(threads).run(kernel, rows, size)
    assert np.all(done == 1)


def test_two_threads_work_at_once():
    both = threading.Barrier(2, timeout=30)
    ParallelRows(2).run(lambda first, end: both.wait(), 4, 1)


@pytest.mark.parametrize("place", ["caller", "helper"])
def test_what_a_thread_raises_comes_out(place):
    both, met = threading.Barrier(2, timeout=30), set()

    def kernel(first, end):
        thread = threading.current_thread()
        if thread not in met:
            met.add(thread)
            both.wait()
        if (thread is threading.main_thread()) == (place == "caller"):
            raise ValueError(place)

    with pytest.raises(ValueError, match=place):
        ParallelRows(2).run(kernel, 4, 1)


def with_threads(interface, threads):
    return LennardJonesInterface(
        interface.substrate,
        interface.shape,
        interface.spacing,
        interface.well_depth,
        interface.length,
        interface.cutoff,
        threads,
    )


@pytest.mark.parametrize("kind", [MultiscaleBlock, NonlinearSpringBlock])
def test_any_number_of_threads_gives_the_same_bits(kind):
    """Atoms in motion with a thermostat, over a rough substrate: forces, curvature, energy, and where all nodes end.

    One thread does all rows of a level in one block, the others eight at a time.
    """
    rough = interface_of(ATOMS, rough_coefficients())
    lame = lame_constants(YOUNGS_MODULUS, POISSONS_RATIO)
    step = 0.4 / fastest_wave(isotropic_element(LATTICE_CONSTANT, YOUNGS_MODULUS, POISSONS_RATIO), MASS)
    found = []
    for threads in (1, 2, 3):
        options = BlockOptions(task_nodes=8192 if threads == 1 else 1)
        interface = with_threads(rough, threads)
        block = kind(ATOMS, LATTICE_CONSTANT, *lame, (4, 4), MASS, threads, options)
        system = MolecularDynamics(block, interface, step, damping=0.01 / step, temperature=300.0)
        surface = np.zeros((3, *ATOMS))
        surface[2] = interface.rest_heights().max() + interface.length
        motion, generator = system.start(surface), np.random.default_rng(0)
        system.move(motion, 1e9, generator, 20)
        surface = np.ascontiguousarray(block.bottom_of(motion.displacement))
        force, hessian = np.empty(surface.shape), np.empty((6, *ATOMS))
        energy = interface.evaluate(surface, force, hessian)
        found.append((motion.displacement, motion.velocity, force, hessian, np.array([energy, motion.top])))
    assert np.any(found[0][2])
    for other in found[1:]:
        for one, same in zip(found[0], other, strict=True):
            np.testing.assert_array_equal(one, same)


@pytest.mark.parametrize(("atoms", "given", "expected"), [(150, 4, 1), (200, 4, 4), (200, 0, 1)])
def test_small_layers_have_one_thread(atoms, given, expected):
    case = case_of((atoms, atoms), solver={"threads": given})
    assert row_threads(case) == expected


@pytest.mark.parametrize(("atoms", "expected"), [(150, 1), (200, 3)])
def test_a_campaign_gives_idle_cores_to_layers_that_gain(atoms, expected, monkeypatch, tmp_path):
    given = []
    case = case_of((atoms, atoms))
    monkeypatch.setattr("md_reference.study.model.constants", lambda case, surface: {})
    monkeypatch.setattr(
        "md_reference.study.model.solve_path", lambda case, *_, **__: iter(given.append(case.solver.threads) or ())
    )
    run_case(Job(MODEL, case, bins_of_case(case), tmp_path / "case", None, ""), 3, lambda *_: None)
    assert given == [expected]
