"""The continuum model as a campaign runs it, and its command ``bem-adhesion``."""

import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.fft import next_fast_len

from bem_adhesion.contact import rough_contact
from bem_adhesion.multilevel import POINTS_PER_PROCESS_ZONE, process_zone
from bem_adhesion.overdamped import Moved, OverdampedContact
from bem_adhesion.paths import Account, account_of, follow, separation_of
from bem_adhesion.solution import Solution
from bem_adhesion.time_path import path_in_time
from contact_study.campaign import overdamped_path
from contact_study.campaign.memory import grid_fits
from contact_study.campaign.model import Model
from contact_study.observables.base import Ensemble, InterfaceState, Plasticity, Relaxation, SolverReport, Value
from contact_study.observables.constants import InterfaceConstants, heights_on
from contact_study.problem.case import Case
from contact_study.problem.elasticity import Viscoelastic
from contact_study.problem.errors import InputError
from contact_study.problem.plausibility import points
from contact_study.problem.study import Study
from contact_study.problem.surface import Surface
from contact_study.problem.surface_scales import SurfaceScales
from contact_study.problem.tabor import JKR_LIKE, longest_range, tabor_parameter

MODEL = Model(
    command="bem-adhesion",
    kind="continuum",
    module="bem_adhesion.run",
    description="boundary elements: elastic half-space on a rigid rough surface, hard wall or adhesive",
    references="C. Yang, B. N. J. Persson, J. Israelachvili, K. Rosenberg, EPL 84, 46004 (2008)",
    ignores=("atomistic", "sampling", "dynamics", "theory"),
)

# Grid spacing, in units of the longer of process zone and law's length, beyond which a study is refused: steps stop
# converging from some 1e3 on where roughness and cell grow together, rubber with an atomic law works at 5e3.
_COARSEST = 1e5


def main(arguments: Sequence[str] | None = None) -> int:
    """The command ``bem-adhesion``; returns the exit status."""
    from contact_study.campaign import command  # workers solve, and need none of what reads and writes datasets

    return command.main(MODEL, arguments)


def check(case: Case) -> None:
    """Make sure that the way along the path is one that the solver knows; every case else is served.

    Raises
    ------
    InputError
        If motion against friction is asked for under another control than pressure, or with what it has no part in.
    """
    if case.solver.path == "overdamped":
        overdamped_path.check(case, "solver.path")
        if case.elasticity.boundary == "free":
            raise InputError('elasticity.boundary = "free": solver.path = "overdamped" is for periodic boundaries')
        if case.loading.adaptive:
            raise InputError(
                'loading.adaptive = true: solver.path = "overdamped" follows the load steadily; leave one out'
            )


def review(study: Study, scales: Sequence[SurfaceScales]) -> list[str]:
    """Say where the grid cannot resolve law or layer, each in one line for the whole study; errors as for the law."""
    return _unresolved_law(study, scales) + _unresolved_layer(study, scales)


def _unresolved_layer(study: Study, scales: Sequence[SurfaceScales]) -> list[str]:
    """Below the grid spacing a layer's points hardly know of their neighbours: its edges, a depth wide, are lost."""
    thin = [(case, scale) for case, scale in zip(study.cases, scales, strict=True) if case.solid.depth < scale.pixel]
    if not thin:
        return []
    case, scale = max(thin, key=lambda item: item[1].pixel / item[0].solid.depth)
    return [
        f"the layer of {case.solid.depth:.3g} m is thinner than the grid spacing {scale.pixel:.3g} m"
        f"{points([case for case, _ in thin], len(study.cases))}: what happens at contact edges within a thickness is "
        "not resolved; use a finer surface.shape or a larger elasticity.thickness"
    ]


def _unresolved_law(study: Study, scales: Sequence[SurfaceScales]) -> list[str]:
    """Where the grid cannot resolve the law.

    A grid coarser than a quarter of the process zone E*Δγ/σ_max² lets contact edges lock in to its points ("lattice
    trapping"): its hysteresis is then not the continuum's.

    Raises
    ------
    InputError
        If the grid is so coarse that law and surface have nothing to do with each other.
    """
    unresolved = []
    for case, scale in zip(study.cases, scales, strict=True):
        if case.law.attracts:
            zone = process_zone(case.solid.contact_modulus, case.law)
            if scale.pixel * POINTS_PER_PROCESS_ZONE > zone:
                unresolved.append((scale.pixel / zone, zone, case, scale))
            reach = max(zone, case.law.length)
            if scale.pixel > _COARSEST * reach:
                raise InputError(
                    f"surface.size, surface.shape: the grid spacing {scale.pixel:.3g} m is {scale.pixel / reach:.2g} "
                    f"times what the law acts over (its length {case.law.length:.3g} m, its process zone {zone:.3g} m)"
                    f"; beyond {_COARSEST:g} no grid point feels it: check size, shape and interaction.length"
                )
    if not unresolved:
        return []
    ratio, zone, case, scale = max(unresolved, key=lambda item: item[0])
    refined = _resolving(scale.size, zone)
    # The process zone grows with the square of the law's length where the work of adhesion stays.
    longer = case.law.length * math.sqrt(POINTS_PER_PROCESS_ZONE * ratio)
    known = ""
    if scale.rms_curvature > 0:
        tabor = tabor_parameter(1 / scale.rms_curvature, case.solid.contact_modulus, case.work_of_adhesion, longer)
        known = f" (Tabor parameter {tabor:.2g})"
    ways = [f"interaction.length = {longer:.2g} m with the same work of adhesion{known}"]
    if grid_fits((refined[0], refined[1])):
        ways.insert(0, f"surface.shape = {refined}")
    where = points([case for *_, case, _ in unresolved], len(study.cases))
    return [
        f"the grid spacing {scale.pixel:.3g} m is coarser than a quarter of the process zone {zone:.3g} m{where}: "
        f"contact edges may be trapped by the grid; {' or '.join(ways)} would resolve it"
        + _jkr_like(case, scale, longer)
    ]


def _jkr_like(case: Case, scale: SurfaceScales, resolved: float) -> str:
    """Where a range that the grid resolves is too long, or may be longer: the longest that leaves JKR's contacts."""
    modulus, work = case.solid.contact_modulus, case.law.work_of_adhesion
    try:
        longest = longest_range(scale.rms_curvature, scale.rms_height, modulus, work)
    except ValueError:  # flat, or not soft
        return ""
    if longest <= case.law.length:
        return ""
    needed = _resolving(scale.size, process_zone(modulus, replace(case.law, length=longest)))
    enough = "; the grid is fine enough for it" if longest >= resolved else f", on surface.shape = {needed}"
    return (
        f'. Up to interaction.length = {longest:.2g} m ("auto") contacts stay like those of the JKR theory (Tabor '
        f"parameter above {JKR_LIKE:g}){enough}"
    )


def _resolving(size: tuple[float, float], zone: float) -> list[int]:
    """Points along y and x that resolve a process zone (m)."""
    return [_fast(math.ceil(POINTS_PER_PROCESS_ZONE * length / zone)) for length in size]


def _fast(count: int) -> int:
    """The next even number of points of small prime factors."""
    return 2 * int(next_fast_len(math.ceil(count / 2), real=True))


def constants(case: Case, surface: Surface) -> dict[str, Value]:
    """What does not change along the path."""
    law, modulus = case.law, case.solid.contact_modulus
    known = InterfaceConstants(
        contact_modulus=modulus,
        work_of_adhesion=law.work_of_adhesion,
        equilibrium_distance=law.equilibrium_distance,
        peak_tensile_stress=law.peak_tensile_stress,
        contact_distance=case.contact_distance,
        rms_height=surface.rms_height,
        rms_slope=surface.rms_slope,
        pixel=max(surface.grid.spacing),
        peak_distance=law.peak_distance if law.attracts else None,
        process_zone=process_zone(modulus, law) if law.attracts else None,
    )
    fields = heights_on(surface.grid, surface.sampled) if case.output.fields else {}
    return {**known.values, **fields}


def solve_path(
    case: Case, surface: Surface, restart: Mapping[str, np.ndarray] | None = None, start: int = 0
) -> Iterator[InterfaceState | Ensemble]:
    """Yield the state at each path point from number ``start`` on.

    Parameters
    ----------
    case : Case
        The case.
    surface : Surface
        Its surface.
    restart : mapping, optional
        ``InterfaceState.restart`` of point ``start`` − 1; None to start from separation.
    start : int, optional
        Number of the first point to solve.
    """
    if case.solver.path == "overdamped" and case.law.attracts:  # without attraction no state depends on the path
        pace = overdamped_path.pace_of(case, surface.size)
        moving = _MovingContinuum(case, surface, pace.allowed)
        yield from overdamped_path.solve_path(case, moving, pace, restart, start)
        return
    if isinstance(case.solid, Viscoelastic):
        for solution, now in path_in_time(case, surface, case.solid, restart, start):
            found = _state(case, solution, surface.grid.spacing, None)
            kept = {**found.restart, "moment": now.array}
            yield replace(found, relaxation=Relaxation(now.time, now.dissipated), restart=kept)
        return
    solver = case.solver
    contact = rough_contact(
        surface.sampled,
        surface.grid.size,
        case.solid,
        case.law,
        case.loading.control,
        solver.tolerance,
        solver.max_iterations,
        max(1, solver.threads),
        case.elasticity.boundary,
        case.material.hardness,
    )
    state = contact.separated() if restart is None else restart["state"]
    account = (
        _first_account(case, state) if restart is None or "account" not in restart else Account.of(restart["account"])
    )
    for value, _ in case.path[start:]:
        if account is None:
            solution = contact.step(state, value)
            if case.loading.adaptive and case.law.attracts:
                account = account_of(solution, value, case.solid)
        else:
            least = case.loading.resolution * max(map(abs, case.loading.path))
            solution, account = follow(contact, state, account, value, least, case.solid)
        state = solution.state
        stiffness = contact.stiffness(solution) if case.output.stiffness and solution.converged else None
        found = _state(case, solution, surface.grid.spacing, stiffness)
        if account is not None:
            found = replace(
                found,
                dissipated_energy=account.dissipated,
                detachment_pressure=account.detachment_pressure,
                restart={**found.restart, "account": account.array},
            )
        if case.elasticity.boundary == "free" and _at_rim(found.contact):
            warnings.warn(
                'elasticity.boundary = "free": contact reaches the rim of the surface; what would touch beyond it is '
                "missing: a larger surface.size has it",
                stacklevel=2,
            )
        yield found


class _MovingContinuum(OverdampedContact):
    """The contact of a case in overdamped motion, as the campaign takes it."""

    def __init__(self, case: Case, surface: Surface, allowed: float):
        given = case.solver
        super().__init__(
            surface.sampled,
            surface.grid,
            case.solid,
            case.law,
            tolerance=given.tolerance,
            max_iterations=given.max_iterations,
            threads=max(1, given.threads),
            allowed=allowed,
        )
        self._case = case
        self._spacing = surface.grid.spacing

    def described(self, found: Moved) -> InterfaceState:
        """A state of the contact as one of the interface."""
        stiffness = None
        if self._case.output.stiffness:
            at_rest = found.residual <= self.tolerance
            stiffness = self.stiffness(found.solution) if at_rest else np.nan
        return _state(self._case, found.solution, self._spacing, stiffness)


def _first_account(case: Case, separated: np.ndarray) -> Account | None:
    """Where a path with steps of its own begins: without load, out of reach; under other control at its first point."""
    if not (case.loading.adaptive and case.law.attracts and case.loading.control == "pressure"):
        return None
    return Account(0.0, 0.0, float(separated.mean()), 0.0, False)


def _at_rim(contact: np.ndarray) -> bool:
    """Whether a point of the first or last row or column is in contact."""
    return bool(contact[[0, -1]].any() or contact[:, [0, -1]].any())


def _state(case: Case, solution: Solution, spacing: tuple[float, float], stiffness: float | None) -> InterfaceState:
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
    )


if __name__ == "__main__":
    raise SystemExit(main())
