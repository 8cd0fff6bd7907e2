import copy

import numpy as np
import pytest
from scipy import constants

from contact_study.fields.time_series import statistics_of
from md_reference.block import lame_constants
from md_reference.multiscale_block import MultiscaleBlock
from md_reference.newtonian import NewtonianBlock, fastest_wave
from tests.md_reference.systems import (
    ELEMENT,
    LATTICE_CONSTANT,
    POISSONS_RATIO,
    YOUNGS_MODULUS,
    interface_of,
    rough_coefficients,
    touching,
)
from tests.md_reference.test_thermal_sampler import NoInterface

MASS = 197 * constants.atomic_mass
LAME = lame_constants(YOUNGS_MODULUS, POISSONS_RATIO)
FASTEST = fastest_wave(ELEMENT, MASS)
ATOMS = (8, 8)


def block_of(layers=(4, 2), atoms=ATOMS):
    return MultiscaleBlock(atoms, LATTICE_CONSTANT, *LAME, layers, MASS)


def system_of(time_step=0.1, interface=None, **options):
    interface = interface_of(ATOMS, rough_coefficients()) if interface is None else interface
    return NewtonianBlock(block_of(), interface, time_step / FASTEST, **options)


def energy_of(system, motion, pressure):
    block = system.block
    load = pressure * ATOMS[0] * ATOMS[1] * LATTICE_CONSTANT**2
    return (
        system.kinetic_energy(motion) + system.elastic_energy(motion) + system.interaction_energy + load * motion.top
    ) / (constants.k * 300 * block.freedoms)


def run(system, motion, steps, pressure, generator=None):
    system.prepare(motion, pressure)
    for _ in range(steps):
        system.step(motion, pressure, generator or np.random.default_rng(0))
    return motion


@pytest.fixture(scope="module")
def shaken():
    """A block in thermal motion on the substrate."""
    system = system_of(friction=0.05 * FASTEST, temperature=300.0)
    motion = system.start(touching(system.interaction))
    return run(system, motion, 1500, 1e9, np.random.default_rng(1))


def test_energy_error_falls_with_the_square_of_the_step(shaken):
    swings = []
    for halvings in range(3):
        system = system_of(0.2 / 2**halvings)
        motion = copy.deepcopy(shaken)
        system.prepare(motion, 1e9)
        energies = [energy_of(system, motion, 1e9)]
        for _ in range(8 * 2**halvings):
            run(system, motion, 5, 1e9)
            energies.append(energy_of(system, motion, 1e9))
        swings.append(np.ptp(energies))
    # Over the same time; the next order is the fourth.
    assert swings[0] / swings[1] == pytest.approx(4, rel=0.1)
    assert swings[1] / swings[2] == pytest.approx(4, rel=0.03)
    assert swings[2] < 1e-3


def test_momentum_changes_by_the_forces_from_outside_alone(shaken):
    system, motion, pressure = system_of(), copy.deepcopy(shaken), 2e9
    load = pressure * ATOMS[0] * ATOMS[1] * LATTICE_CONSTANT**2
    system.prepare(motion, pressure)
    before, impulse = system.momentum(motion), 0.0
    force = float(np.sum(system.interface_force[2]))
    for _ in range(50):
        system.step(motion, pressure, np.random.default_rng(0))
        after = float(np.sum(system.interface_force[2]))
        impulse += system.time_step * (0.5 * (force + after) - load)
        force = after
    moved = np.sum(np.abs(system.block.mass * motion.velocity))
    assert abs(impulse) > 1e-3 * moved
    assert system.momentum(motion) - before == pytest.approx(impulse, abs=1e-12 * moved)


def test_friction_acts_in_the_middle_of_the_way():
    """Half a step at the old velocity, half at what friction leaves of it; no force acts on a block that flies."""
    rate = 0.3 * FASTEST
    system = system_of(interface=NoInterface(), friction=rate)
    motion = run(system, system.start(np.zeros((3, *ATOMS)), -10.0), 1, 0.0)
    kept = np.exp(-rate * system.time_step)
    way = -10.0 * system.time_step * (1 + kept) / 2
    assert motion.top == pytest.approx(way, rel=1e-12)
    np.testing.assert_allclose(system.block.bottom_of(motion.displacement)[2], way, rtol=1e-12)
    np.testing.assert_allclose(system.block.bottom_of(motion.velocity)[2], -10.0 * kept, rtol=1e-9)


def test_free_block_flies_on():
    system = system_of(interface=NoInterface())
    motion = run(system, system.start(np.zeros((3, *ATOMS)), -10.0), 100, 0.0)
    assert motion.top / motion.time == pytest.approx(-10.0, rel=1e-12)
    np.testing.assert_allclose(system.block.bottom_of(motion.displacement)[2], motion.top, rtol=1e-9)
    energy = 0.5 * (system.block.mass.sum() / 3) * 10.0**2
    assert system.temperature(motion) == pytest.approx(2 * energy / (constants.k * system.block.freedoms), rel=1e-9)


def test_driven_block_goes_with_its_plane():
    """Nothing drags at it, however strong the friction, and its drift is no heat."""
    system = system_of(interface=NoInterface(), friction=0.2 * FASTEST, driven=True)
    motion = run(system, system.start(np.zeros((3, *ATOMS)), 20.0), 300, 1e9)
    assert motion.top == pytest.approx(20.0 * motion.time, rel=1e-12)
    np.testing.assert_allclose(system.block.bottom_of(motion.displacement)[2], motion.top, rtol=1e-9)
    assert system.temperature(motion) < 1e-9
    # Turned round, it follows within the time of the friction and of its waves.
    motion.top_velocity = -20.0
    run(system, motion, 6000, 1e9)
    np.testing.assert_allclose(system.block.bottom_of(motion.velocity)[2], -20.0, rtol=1e-6)


def test_thermostat_gives_every_freedom_its_share():
    """Velocities of nodes of all masses, and the elastic energy."""
    temperature = 300.0
    system = system_of(0.15, NoInterface(), friction=0.1 * FASTEST, temperature=temperature)
    generator = np.random.default_rng(2)
    motion = run(system, system.start(np.zeros((3, *ATOMS))), 1000, 0.0, generator)
    moving = system.block.mass > 0
    kinetic, elastic = [], []
    for _ in range(600):
        run(system, motion, 10, 0.0, generator)
        share = (system.block.mass * motion.velocity**2)[moving] / (constants.k * temperature)
        first = np.flatnonzero(moving) < np.prod(system.block.levels[0].shape)
        kinetic.append([share[first].mean(), share[~first].mean()])
        elastic.append(2 * system.elastic_energy(motion) / (constants.k * temperature * system.block.freedoms))
    fine, coarse = (statistics_of(np.array(kinetic)[:, level]) for level in (0, 1))
    potential = statistics_of(np.array(elastic))
    for found in (fine, coarse, potential):
        assert found.standard_error < 0.02
        # Velocities of the scheme err by (ω dt)²/4 at most, half a per cent here.
        assert abs(found.mean - 1) < 4 * found.standard_error + 0.006


def test_friction_brings_the_block_to_rest_in_balance():
    system = system_of(0.3, friction=0.05 * FASTEST)
    motion = run(system, system.start(touching(system.interaction)), 6000, 1e9)
    stress = np.mean(system.interface_force[2]) / LATTICE_CONSTANT**2
    assert stress == pytest.approx(1e9, rel=1e-6)
    assert system.unbalanced() < 1e-6 * LATTICE_CONSTANT**2 * YOUNGS_MODULUS
    assert system.temperature(motion) < 1e-6


def test_steps_beyond_the_fastest_wave_are_unstable():
    """2/ω is the bound: a uniform slab of it stays bounded below and grows above."""
    growth = []
    for factor in (1.9, 2.2):
        block = MultiscaleBlock(ATOMS, LATTICE_CONSTANT, *LAME, (8,), MASS)
        system = NewtonianBlock(block, NoInterface(), factor / FASTEST)
        motion = system.start(np.zeros((3, *ATOMS)))
        motion.velocity[:] = np.where(block.mass > 0, np.random.default_rng(0).standard_normal(block.size), 0)
        before = system.kinetic_energy(motion)
        run(system, motion, 150, 0.0)
        growth.append(system.kinetic_energy(motion) / before)
    assert growth[0] < 100 < 1e6 < growth[1]
