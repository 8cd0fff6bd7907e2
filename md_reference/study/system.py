"""Parts of a case: the condensed block, the interface, both as a contact under load, and the state for the campaign."""

import math
from collections.abc import Callable, Iterator, Mapping

import numpy as np

from contact_study.numerics.fourier import POINTS_FOR_THREADS
from contact_study.physics.surfaces.surface import Surface
from contact_study.results.schema import surface_atoms
from contact_study.results.state import Ensemble, InterfaceState, SolverReport
from contact_study.study.case import Case
from md_reference.block.condensed import SurfaceStiffness, isotropic_element, surface_stiffness
from md_reference.interface.pairs import LennardJonesInterface, interface_of
from md_reference.parallel_rows import ATOMS_FOR_THREADS
from md_reference.solution import Solution
from md_reference.statics.contact import AtomisticContact

# InterfaceState.restart of the point before, or of a state of an ensemble; without one the path begins apart.
Restart = Mapping[str, np.ndarray] | None
# Point number -> gap field (y, x) on any grid over the same rectangle (m), None if there is no such state.
Predictor = Callable[[int], np.ndarray | None] | None
# One state or ensemble per point of the path from a first one on. Motion has no use for a predictor.
States = Iterator[InterfaceState | Ensemble]


def build_stiffness(case: Case) -> SurfaceStiffness:
    """Return the condensed block of a case, see :attr:`Case.block_layers`."""
    lattice, material = case.lattice, case.material
    element = isotropic_element(lattice.constant, material.youngs_modulus, material.poissons_ratio)
    return surface_stiffness(element, lattice.atoms, lattice.constant, case.block_layers)


def row_threads(case: Case) -> int:
    """Return the threads that share the rows of atoms: those of the case, where they save time."""
    enough = math.prod(case.lattice.atoms) >= ATOMS_FOR_THREADS
    return max(case.solver.threads, 1) if enough else 1


def build_interface(case: Case, surface: Surface) -> LennardJonesInterface:
    """Return the Lennard-Jones atoms of a case over the substrate's sites."""
    length, cutoff = case.law.length, case.atomistic.cutoff
    return interface_of(surface.heights, case.lattice, case.well_depth, length, cutoff, row_threads(case))


def build_contact(case: Case, surface: Surface) -> AtomisticContact:
    """Return block and interface of a case, to be loaded."""
    stiffness, solver = build_stiffness(case), case.solver
    return AtomisticContact(
        stiffness,
        build_interface(case, surface),
        case.material.contact_modulus,
        case.loading.control,
        solver.tolerance,
        solver.max_iterations,
        max(solver.threads, 1) if stiffness.grid.points >= POINTS_FOR_THREADS else 1,
    )


def interface_state(case: Case, solution: Solution) -> InterfaceState:
    """Return a solution as the campaign's state, with the block's uniform compression added."""
    mean_pressure = float(np.mean(solution.pressure))
    stress = (*solution.shear_stress, solution.pressure)
    return InterfaceState(
        gap=solution.gap,
        pressure=solution.pressure,
        contact=case.law.in_contact(solution.gap, solution.pressure, case.contact_distance),
        equilibrium_distance=case.law.equilibrium_distance,
        # The solver omits the uniform compression.
        mean_separation=solution.mean_separation - case.solid.compression(mean_pressure),
        elastic_energy=solution.elastic_energy + case.solid.compression_energy(mean_pressure),
        interaction_energy=solution.interaction_energy,
        report=SolverReport.of(solution, force_evaluations=solution.force_evaluations),
        restart={"state": solution.state},
        spacing=(case.lattice.constant, case.lattice.constant),
        atoms={} if case.output.atoms == "none" else surface_atoms(solution.displacement, np.stack(stress)),
        wall_bounded=case.law.wall_bounded(case.contact_distance),
    )
