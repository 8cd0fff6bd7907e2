"""A solution of the continuum as a state of the interface, as the campaign takes it."""

from bem_adhesion.solution import Solution
from bem_adhesion.study.adaptive import separation_of
from contact_study.results.state import InterfaceState, Plasticity, SolverReport
from contact_study.study.case import Case


def interface_state(
    case: Case, solution: Solution, spacing: tuple[float, float], stiffness: float | None = None
) -> InterfaceState:
    """The state of a case's interface.

    Parameters
    ----------
    case : Case
        The case.
    solution : Solution
        What its solver found.
    spacing : tuple of float
        Distance of points along y and x (m).
    stiffness : float or None, optional
        −dp/dū of the solution (Pa/m), where it was asked for.
    """
    gap, pressure, yielded = solution.gap, solution.pressure, solution.plastic_indentation
    separation = separation_of(solution, case.solid) - case.law.equilibrium_distance
    return InterfaceState(
        gap=gap,
        pressure=pressure,
        contact=case.law.in_contact(gap, pressure, case.contact_distance),
        equilibrium_distance=case.law.equilibrium_distance,
        mean_separation=separation,
        elastic_energy=solution.elastic_energy,
        interaction_energy=solution.interaction_energy,
        report=SolverReport.of(solution, complementarity_residual=solution.complementarity_residual),
        restart={"state": solution.state},
        spacing=spacing,
        contact_stiffness=stiffness,
        plasticity=None if yielded is None else Plasticity(yielded, case.material.hardness or 0.0),
        periodic=case.elasticity.boundary == "periodic",
    )
