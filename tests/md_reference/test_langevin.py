"""Molecular dynamics of the explicit block, its noise, and rows shared among threads."""

import copy
import threading

import numpy as np
import pytest
from scipy import constants

from contact_study.numerics.time_series import statistics_of
from md_reference.block.multiscale import MultiscaleBlock, NonlinearSpringBlock
from md_reference.block.verlet import Action, move_plane
from md_reference.parallel_rows import share_rows
from md_reference.study.model import POINTS_FOR_THREADS
from md_reference.study.system import row_threads
from md_reference.thermal.langevin import MolecularDynamics, fastest_wave
from tests.md_reference.systems import (
    AREA,
    ELEMENT,
    LAME,
    SPACING,
    Quartic,
    case_of,
    interface_of,
    rough_heights,
    touching,
)

MASS = 197 * constants.atomic_mass
FASTEST = fastest_wave(ELEMENT, MASS)
ATOMS = (8, 8)
LAYER = ATOMS[0] * ATOMS[1] * AREA
AT_REST = np.zeros((3, *ATOMS))


def block_of(layers=(4, 2), atoms=ATOMS, kind=MultiscaleBlock, threads=1):
    return kind(atoms, SPACING, *LAME, layers, MASS, threads)


def system_of(time_step=0.1, interface=None, block=None, **options):
    interface = interface or interface_of(ATOMS, rough_heights())
    return MolecularDynamics(block or block_of(), interface, time_step / FASTEST, **options)


def run(system, motion, steps, pressure, generator=None):
    system.move(motion, pressure, generator or np.random.default_rng(0), steps)
    return motion


@pytest.fixture(scope="module")
def shaken():
    system = system_of(damping=0.05 * FASTEST, temperature=300.0)
    motion = system.start(touching(system.interaction))
    return run(system, motion, 1500, 1e9, np.random.default_rng(1))


def test_energy_error_falls_with_the_square_of_the_step(shaken):
    swings = []
    for halvings in range(3):
        system, motion, energies = system_of(0.2 / 2**halvings), copy.deepcopy(shaken), []
        for _ in range(8 * 2**halvings):
            run(system, motion, 5, 1e9)
            inner = system.kinetic_energy(motion) + system.elastic_energy(motion) + system.interaction_energy
            energies.append(inner + 1e9 * LAYER * motion.top)
        swings.append(np.ptp(energies) / (constants.k * 300 * system.block.freedoms))
    # Over the same time; the next order is the fourth.
    assert swings[0] / swings[1] == pytest.approx(4, rel=0.1)
    assert swings[1] / swings[2] == pytest.approx(4, rel=0.03)
    assert swings[2] < 1e-3


@pytest.mark.parametrize("rate", [0.0, 0.3 * FASTEST])
def test_friction_acts_in_the_middle_of_the_way(rate):
    system = system_of(interface=Quartic(), damping=rate)
    motion = run(system, system.start(AT_REST, -10.0), 1, 0.0)
    kept = np.exp(-rate * system.time_step)
    way, block = -10.0 * system.time_step * (1 + kept) / 2, system.block
    assert motion.top == pytest.approx(way, rel=1e-12)
    np.testing.assert_allclose(block.bottom_of(motion.displacement)[2], way, rtol=1e-12)
    np.testing.assert_allclose(block.bottom_of(motion.velocity)[2], -10.0 * kept, rtol=1e-9)
    energy = 0.5 * (block.mass.sum() / 3) * (10.0 * kept) ** 2
    assert system.temperature(motion) == pytest.approx(2 * energy / (constants.k * block.freedoms), rel=1e-9)
    whole = energy + 0.5 * block.top_mass * (10.0 * kept) ** 2
    assert system.temperature_of_whole(motion) == pytest.approx(2 * whole / constants.k, rel=1e-9)


def test_driven_block_goes_with_its_plane():
    system = system_of(interface=Quartic(), damping=0.2 * FASTEST, driven=True)
    motion = run(system, system.start(AT_REST, 20.0), 300, 1e9)
    assert motion.top == pytest.approx(20.0 * motion.time, rel=1e-12)
    np.testing.assert_allclose(system.block.bottom_of(motion.displacement)[2], motion.top, rtol=1e-9)
    assert system.temperature(motion) < 1e-9
    motion.top_velocity = -20.0
    run(system, motion, 6000, 1e9)
    np.testing.assert_allclose(system.block.bottom_of(motion.velocity)[2], -20.0, rtol=1e-6)


@pytest.mark.validation
def test_kinetic_temperature_is_the_thermostats_at_any_step():
    system = system_of(1.0, Quartic(), damping=0.1 * FASTEST, temperature=300.0)
    generator = np.random.default_rng(3)
    motion, found = run(system, system.start(AT_REST), 300, 0.0, generator), []
    for _ in range(3000):
        run(system, motion, 3, 0.0, generator)
        at_the_end = np.sum(system.block.mass * motion.velocity**2) / (constants.k * system.block.freedoms)
        found.append([system.temperature(motion), at_the_end])
    means = statistics_of(np.array(found))
    assert means.standard_error[0] < 1.0
    assert abs(means.mean[0] - 300) < 3 * means.standard_error[0]
    assert means.mean[1] < 0.95 * 300


def kicked_by_noise(key, shape=(3, 4, 66, 102)):
    u, moved, velocity, force = (np.zeros(shape) for _ in range(4))
    action = Action(1.0, noise=1.0, key=key)
    for k in range(shape[1]):
        move_plane(u, moved, velocity, force, k, 1, 1.0, action, 7, k, 0, shape[2] - 2)
    assert not velocity[:, :, [0, -1]].any()
    assert not velocity[:, :, :, [0, -1]].any()
    return velocity[:, :, 1:-1, 1:-1].reshape(3, -1)


def test_noise_has_the_moments_of_normal_numbers_and_no_memory():
    noise, other = kicked_by_noise(1), kicked_by_noise(2)
    count = noise[0].size
    for power, moment, variance in ((1, 0, 1), (2, 1, 2), (3, 0, 9), (4, 3, 18), (5, 0, 81)):
        # Five standard errors of a mean of three-point numbers.
        assert np.all(np.abs(np.mean(noise**power, axis=1) - moment) < 5 * np.sqrt(variance / count))
    pairs = [(noise[0], noise[1]), (noise[1], noise[2]), (noise[0], noise[2]), (noise[0], other[0])]
    pairs += [(noise[c][:-shift], noise[c][shift:]) for c in range(3) for shift in (1, 100, 6400)]
    for one, two in pairs:
        assert abs(np.mean(one * two)) < 5 / np.sqrt(one.size)
        assert abs(np.mean((one**2 - 1) * (two**2 - 1))) < 5 * 2 / np.sqrt(one.size)


def test_levels_have_noise_of_their_own():
    quiet = {"damping": 1e-3 * FASTEST, "temperature": 300.0}
    system = system_of(1e-3, Quartic(), block_of((6, 6), (32, 32)), **quiet)
    motion = run(system, system.start(np.zeros((3, 32, 32))), 1, 0.0)
    fine, coarse = (np.sign(nodes.reshape(3, -1)) for nodes in system.block.levels_of(motion.velocity))
    product = fine[:, : coarse.shape[1]] * coarse
    inner = product != 0  # forces leave none at 0
    assert inner.sum() > 1000
    # Five standard errors of a mean of signs.
    assert abs(np.mean(product[inner])) < 5 / np.sqrt(inner.sum())


@pytest.mark.parametrize(("factor", "least", "most"), [(1.9, 0, 100), (2.2, 1e6, np.inf)])
def test_steps_beyond_the_fastest_wave_are_unstable(factor, least, most):
    system = system_of(factor, Quartic())
    motion, mass = system.start(AT_REST), system.block.mass
    motion.velocity[:] = np.where(mass > 0, np.random.default_rng(0).standard_normal(mass.size), 0)
    before = system.kinetic_energy(motion)
    assert least < system.kinetic_energy(run(system, motion, 150, 0.0)) / before < most


@pytest.mark.parametrize(("rows", "size", "threads"), [(10, 3, 1), (10, 3, 3), (3, 8, 4), (64, 1, 2)])
def test_every_row_is_done_once(rows, size, threads):
    done = np.zeros(rows, int)

    def kernel(first, end):
        done[first:end] += 1

    share_rows(kernel, rows, size, threads)
    assert np.all(done == 1)


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
        share_rows(kernel, 4, 1, 2)


@pytest.mark.parametrize("kind", [MultiscaleBlock, NonlinearSpringBlock])
def test_any_number_of_threads_gives_the_same_bits(kind, monkeypatch):
    atoms, found = (36, 24), []
    for threads in (1, 2, 3):
        interface = interface_of(atoms, rough_heights(), threads=threads)
        monkeypatch.setattr("md_reference.block.multiscale._TASK_NODES", 8192 if threads == 1 else 1)
        block = block_of((4, 4), atoms, kind, threads)
        system = system_of(0.4, interface, block, damping=FASTEST / 40, temperature=300.0)
        motion = run(system, system.start(touching(interface)), 20, 1e9)
        surface = np.ascontiguousarray(block.bottom_of(motion.displacement))
        force, hessian = np.empty(surface.shape), np.empty((6, *atoms))
        energy = interface.evaluate(surface, force, hessian)
        found.append((motion.displacement, motion.velocity, force, hessian, np.array([energy, motion.top])))
    assert np.any(found[0][2])
    for other in found[1:]:
        for one, same in zip(found[0], other, strict=True):
            np.testing.assert_array_equal(one, same)


@pytest.mark.parametrize(("atoms", "expected"), [(150, 1), (200, 3)])
def test_layers_that_gain_take_the_threads_given(atoms, expected):
    assert [row_threads(case_of((atoms, atoms), solver={"threads": given})) for given in (0, 3)] == [1, expected]
    assert (atoms**2 >= POINTS_FOR_THREADS) == (expected > 1)  # what a campaign gives idle cores by
