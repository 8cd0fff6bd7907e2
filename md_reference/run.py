"""The atomistic model of a case: its measured constants and its states along the loading path; the command."""

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np

from contact_study.campaign.memory import require_memory
from contact_study.campaign.model import Model
from contact_study.observables.base import InterfaceState, SolverReport, Value
from contact_study.observables.constants import InterfaceConstants, heights_on
from contact_study.problem.case import Case
from contact_study.problem.errors import InputError
from contact_study.problem.plausibility import contact_stress, points, squeeze
from contact_study.problem.study import Study
from contact_study.problem.surface import Surface
from contact_study.problem.surface_scales import SurfaceScales
from md_reference.block import SurfaceStiffness, element_matrix, surface_stiffness
from md_reference.contact import AtomisticContact, interface_of
from md_reference.interface import INSIDE, LennardJonesInterface
from md_reference.measure import FlatInterface, effective_contact_modulus, measure_interface
from md_reference.solution import Solution

MODEL = Model(
    command="md-reference",
    kind="atomistic",
    module="md_reference.run",
    description="Atomistic reference: a harmonic block of atoms, condensed exactly to its bottom layer, in equilibrium "
    "at zero temperature on a rigid rough layer of Lennard-Jones sites",
    references="C. Yang, B. N. J. Persson, J. Israelachvili, K. Rosenberg, EPL 84, 46004 (2008)",
    takes_predictor=True,
    ignores=("theory",),
)

# Below 1024² atoms a second thread of FFTW gains nothing, and loses much when the other core is busy.
_POINTS_FOR_THREADS = 1024**2

# Displacements, forces, Hessians, stiffness and transforms of one atom: some sixty doubles.
_BYTES_PER_ATOM = 500

# The springs' Lamé modulus grows as 1/(1 − 2ν): five digits nearer to 0.5 than this, rounding makes moduli negative.
_MOST_INCOMPRESSIBLE = 0.49999

Predictor = Callable[[int], np.ndarray | None]


def main(arguments: Sequence[str] | None = None) -> int:
    """The command ``md-reference``; returns the exit status."""
    from contact_study.campaign import command  # workers solve, and need none of what reads and writes datasets

    return command.main(MODEL, arguments)


def check(case: Case) -> None:
    """Make sure that the atomistic model can serve a case.

    Raises
    ------
    InputError
        If the law is not that of Lennard-Jones atoms, the block is incompressible, or the lattice does not fit the
        cell or the layer.
    """
    if case.interaction.law != "lennard_jones_10_4":
        raise InputError(
            f'interaction.law = "{case.interaction.law}": the atomistic model has Lennard-Jones pairs; '
            'use "lennard_jones_10_4", the law that follows from them'
        )
    if case.material.poissons_ratio > _MOST_INCOMPRESSIBLE:
        raise InputError(
            f"material.poissons_ratio = {case.material.poissons_ratio:.12g}: springs cannot make a block "
            f"incompressible; use at most {_MOST_INCOMPRESSIBLE}"
        )
    _ = case.block_layers  # raises where no number of cells makes the layer
    rows, columns = case.lattice.atoms
    require_memory(
        rows * columns * _BYTES_PER_ATOM,
        f"material.lattice_constant = {case.material.lattice_constant:g} m: a layer of {rows} x {columns} atoms",
        "a larger one or a smaller cell",
    )


def review(study: Study, scales: Sequence[SurfaceScales]) -> list[str]:
    """Say what the lattice cannot carry, in one line for the whole study.

    Raises
    ------
    InputError
        If the pair potential is too weak to hold the atoms of the block out of the substrate.
    """
    filtered = []
    for case, scale in zip(study.cases, scales, strict=True):
        # Six deviations of the stress in full contact, to which the highest pressures of a rough contact come near.
        stress = 6 * scale.full_contact_stress(case.solid)
        closest = squeeze(case.law, max(stress, contact_stress(case, scale)))
        if closest < INSIDE:
            raise InputError(
                f"interaction: against stresses of up to {stress:.3g} Pa the pair potential lets atoms come to "
                f"{closest:.2g} of interaction.length, where they count as inside the substrate; check well_depth "
                "(work_of_adhesion) and well_depth_ratio"
            )
        spacing = max(length / sites for length, sites in zip(scale.size, case.lattice.substrate_sites, strict=True))
        if scale.shortest_wave < 2 * spacing:
            filtered.append((case, scale.shortest_wave, spacing))
    if not filtered:
        return []
    case, wave, spacing = filtered[0]
    where = points([case for case, *_ in filtered], len(study.cases))
    return [
        f"surface: its shortest wave, {wave:.3g} m, is below two distances of the substrate's sites, {spacing:.3g} m"
        f"{where}: what the sites cannot carry is left out"
    ]


def build_stiffness(case: Case) -> SurfaceStiffness:
    """The condensed block of a case, see :attr:`Case.block_layers`."""
    lattice, material = case.lattice, case.material
    element = element_matrix(case.atomistic.block, lattice.constant, material.youngs_modulus, material.poissons_ratio)
    return surface_stiffness(element, lattice.atoms, lattice.constant, case.block_layers)


def build_interface(case: Case, surface: Surface) -> LennardJonesInterface:
    """Lennard-Jones atoms of a case over the substrate's sites."""
    return interface_of(surface.heights, case.lattice, case.well_depth, case.law.length, case.atomistic.cutoff)


def build_contact(case: Case, surface: Surface) -> AtomisticContact:
    """Block and interface of a case, to be loaded."""
    stiffness, solver = build_stiffness(case), case.solver
    return AtomisticContact(
        stiffness,
        build_interface(case, surface),
        case.material.contact_modulus,
        case.loading.control,
        solver.tolerance,
        solver.max_iterations,
        max(solver.threads, 1) if stiffness.grid.points >= _POINTS_FOR_THREADS else 1,
    )


def constants(case: Case, surface: Surface) -> Mapping[str, Value]:
    """What the atoms of a case are, measured on them: moduli, adhesion; and the surface under their rest positions."""
    stiffness = build_stiffness(case)
    sites = case.lattice.substrate_sites
    flat = FlatInterface(
        (surface.size[0] / sites[0], surface.size[1] / sites[1]),
        stiffness.area_per_atom,
        case.well_depth,
        case.law.length,
        case.atomistic.cutoff,
    )
    properties = measure_interface(flat, case.law.length)
    heights = surface.heights(case.lattice.atoms)
    known = InterfaceConstants(
        contact_modulus=effective_contact_modulus(stiffness, heights),
        work_of_adhesion=properties.work_of_adhesion,
        equilibrium_distance=properties.equilibrium_distance,
        peak_tensile_stress=properties.peak_tensile_stress,
        contact_distance=case.contact_distance,
        rms_height=surface.rms_height,
        rms_slope=surface.rms_slope,
        pixel=stiffness.lattice_constant,
        peak_distance=properties.peak_distance,
    )
    return {
        **known.values,
        **heights_on(stiffness.grid, heights),
        "wavevector": stiffness.grid.wavenumber[0, 1:],
        "contact_modulus_at": stiffness.contact_modulus[0, 1:],
    }


def solve_path(
    case: Case,
    surface: Surface,
    restart: Mapping[str, np.ndarray] | None = None,
    start: int = 0,
    predictor: Predictor | None = None,
) -> Iterator[InterfaceState]:
    """Equilibria along the loading path, each from its predictor or else from the state before it.

    Parameters
    ----------
    case, surface : Case, Surface
        The question.
    restart : mapping, optional
        ``InterfaceState.restart`` of the point before ``start``; without it the path begins from separation.
    start : int, optional
        First point of the path to solve.
    predictor : callable, optional
        Point number -> gap field (y, x) of a continuum solution on any grid (m): the atoms start at their lateral
        rest positions, at the surface's height plus that gap. Where it has none (None) a warning names the point.

    Yields
    ------
    InterfaceState
        For each point from ``start`` on.
    """
    contact = build_contact(case, surface)
    state = contact.separated() if restart is None else restart["state"]
    for number in range(start, len(case.path)):
        value, branch = case.path[number]
        gap = None
        # Blocks that are apart are not brought together by tension.
        if predictor is not None and not (contact.is_separated(state) and contact.control == "pressure" and value <= 0):
            gap = predictor(number)
            if gap is None:
                unit = "Pa" if contact.control == "pressure" else "m"
                warnings.warn(
                    f"the predictor holds no state in contact for point {number + 1} of the path, {value:g} {unit} "
                    f"({branch}): the atoms start from where they were",
                    stacklevel=2,
                )
        found = contact.step(state if gap is None else contact.predicted(gap), value)
        state = found.state
        yield _state(case, found)


def _state(case: Case, solution: Solution) -> InterfaceState:
    mean_pressure = float(np.mean(solution.pressure))
    return InterfaceState(
        gap=solution.gap,
        pressure=solution.pressure,
        contact=case.law.in_contact(solution.gap, solution.pressure, case.contact_distance),
        equilibrium_distance=case.law.equilibrium_distance,
        # The solver leaves a block's uniform compression out; that of a layer of atoms is the solid's, see its element.
        mean_separation=solution.mean_separation - case.solid.compression(mean_pressure),
        elastic_energy=solution.elastic_energy + case.solid.compression_energy(mean_pressure),
        interaction_energy=solution.interaction_energy,
        report=SolverReport.of(solution, force_evaluations=solution.force_evaluations),
        restart={"state": solution.state},
    )


if __name__ == "__main__":
    raise SystemExit(main())
