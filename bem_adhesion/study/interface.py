"""Solutions of the continuum as the campaign's state of the interface."""

from typing import Any

import numpy as np

from bem_adhesion.contacts.rough_contact import Contact, contact_between
from bem_adhesion.operators import Progress
from bem_adhesion.solution import Solution
from contact_study.numerics import life
from contact_study.numerics.grid import Grid
from contact_study.physics.solids import Elasticity, HalfSpace
from contact_study.physics.surfaces.surface import Surface
from contact_study.results.state import InterfaceState, SolverReport
from contact_study.study.case import Case

_TRACED = 128**2  # points of a grid from which on iterations are reported; on smaller ones that costs some per cent


def contact_of(case: Case, surface: Surface) -> Contact:
    """Return the contact of a case, of which every step is an equilibrium."""
    options = solver_options(case, surface.grid)
    if compliance := case.machine_compliance:
        options["machine_compliance"] = compliance
    kind = case.solid, case.law, case.elasticity.boundary, case.material.hardness
    return contact_between(surface.sampled, surface.grid, *kind, **options)


def solver_options(case: Case, grid: Grid) -> dict[str, Any]:
    """Return the options of a contact on a grid that a case gives its solver, with its local work of adhesion."""
    given = case.solver
    limits = {"tolerance": given.tolerance, "max_iterations": given.max_iterations, "threads": max(1, given.threads)}
    about = {"control": case.loading.control, "trace": _beat if grid.points >= _TRACED else None}
    return {**about, **limits, "work_of_adhesion": adhesion_of(case, grid)}


def _beat(progress: Progress) -> None:
    """Pass on the beginning of an iteration."""
    if progress.phase == "iteration":
        life.beat(progress.residual)


def separation_of(solution: Solution, solid: Elasticity) -> float:
    """Return the distance of the mean planes, without that of the heights (m)."""
    if solution.plane is not None and not solution.detached:
        return solution.plane
    # Mean gap and separation differ by the uniform compression of a layer and by the indentation.
    separation = float(np.mean(solution.gap)) - solid.compression(float(np.mean(solution.pressure)))
    yielded = solution.plastic_indentation
    return separation if yielded is None else separation - float(np.mean(yielded))


def adhesion_of(case: Case, grid: Grid) -> np.ndarray | None:
    """Return the local work of adhesion of a case (J/m²); None if it is uniform."""
    factors = case.adhesion_factors(grid)
    return None if factors is None else factors * case.law.work_of_adhesion


def approach_of(found: InterfaceState, compliance: float) -> float:
    """Return the approach of the far end of a spring of a compliance per area (m/Pa): displacement and extension."""
    assert found.highest_point is not None  # of the continuum
    return found.highest_point - found.mean_separation + compliance * float(found.pressure.mean())


def interface_state(case: Case, solution: Solution, surface: Surface, stiffness: float | None = None) -> InterfaceState:
    """Return the state of a case's interface, on the heights of its surface; ``stiffness`` −dp/dū if known (Pa/m)."""
    gap, pressure, yielded = solution.gap, solution.pressure, solution.plastic_indentation
    separation = separation_of(solution, case.solid) - case.law.equilibrium_distance
    further = {} if stiffness is None else {"contact_stiffness": stiffness}
    if stiffness is not None and isinstance(case.solid, HalfSpace):
        further["contact_conductance"] = stiffness / case.solid.contact_modulus if stiffness >= 0 else np.nan
    if yielded is not None:
        further["plastic_work"] = solution.plastic_work
    touching = case.law.in_contact(gap, pressure, case.contact_distance)
    if (work_of_adhesion := adhesion_of(case, surface.grid)) is not None:
        further["work_of_adhesion_in_contact"] = float(work_of_adhesion[touching].mean()) if touching.any() else np.nan
    numbers = case.law.equilibrium_distance, separation, solution.elastic_energy, solution.interaction_energy
    # Separations count from zero height where the boundaries are free, else from the mean on the grid.
    mean_plane = 0.0 if solution.plane is not None else float(surface.sampled.mean())
    return InterfaceState(
        *(gap, pressure, touching, *numbers),
        report=SolverReport.of(solution, complementarity_residual=solution.complementarity_residual),
        restart={"state": solution.state},
        spacing=surface.grid.spacing,
        plastic_indentation=yielded,
        further=further,
        periodic=case.elasticity.boundary == "periodic",
        highest_point=float(surface.sampled.max()) - mean_plane,
        wall_bounded=case.law.wall_bounded(case.contact_distance),
    )
