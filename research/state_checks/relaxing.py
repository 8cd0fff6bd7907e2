"""A path of a viscoelastic half-space in steps of time, each held to the hereditary integral over all before it."""

from dataclasses import replace

import numpy as np

from bem_adhesion import Solution, Viscoelastic, ViscoelasticContact
from bem_adhesion.study.model import solve_path
from contact_study.results.state import InterfaceState
from research.state_checks import equilibrium
from research.state_checks.history import History
from research.state_checks.state import ALLOWED, Point, Study


def follow(study: Study) -> None:
    """Solve a case's path step of time by step of time and check its states, then the path as a study has it."""
    case, surfaces, verdict, solid = study.case, study.surfaces, study.verdict, study.case.solid
    assert isinstance(solid, Viscoelastic)
    contact = ViscoelasticContact(surfaces.heights, surfaces.grid.size, solid, case.law, control=case.loading.control)
    history = History(solid, surfaces.grid)
    state, lost = contact.separated(), 0.0
    # Nothing deforms before surfaces are within reach: a path of gaps begins there.
    load = 0.0 if surfaces.control == "pressure" else contact.first_gap - case.law.equilibrium_distance
    for written, (target, _), duration in zip(
        solve_path(case, study.surface), case.path, case.loading.times(), strict=True
    ):
        steps = case.loading.time_steps
        step = duration / steps
        for count in range(1, steps + 1):
            # In this very order: where surfaces jump the last digit of a load may decide between two states.
            position = target if count == steps else load + count / steps * (target - load)
            found, dissipated = contact.step(state, position, step)
            verdict.states += 1
            if not found.converged:
                verdict.flagged.append(found.message)
                return
            where = f"viscoelastic, {surfaces.control} {position:.4g}"
            _check_step(study, contact, history, state, found, position, step, where)
            # Displacements are known to their rounding beside the heights.
            for name, reported, expected in (
                ("stored", found.elastic_energy, history.stored),
                ("dissipated", dissipated, history.dissipated),
            ):
                study.differs(where, name, reported, expected, 1e-8 * max(expected, history.stored))
            state, lost = found.state, lost + dissipated
        load = target
        _check_written(study, written, found, history.times[-1], lost, f"viscoelastic, point {target:.4g}")


def _check_step(
    study: Study,
    contact: ViscoelasticContact,
    history: History,
    before: np.ndarray,
    found: Solution,
    target: float,
    duration: float,
    where: str,
) -> None:
    """Balance with the history, which goes on with the step, and all that an equilibrium has to be."""
    surfaces, (solid, shift) = study.surfaces, history.shift(duration)
    if found.detached:
        study.verdict.detached += 1
        history.go(found.state[1], duration)
        rest = float(np.abs(history.pressure).max())
        if rest > ALLOWED * solid.contact_modulus:
            study.fault(where, f"apart, but under {rest:.1e} Pa")
        return
    history.go(surfaces.heights + found.gap, duration)
    # The step is one of an elastic contact with other heights; the integral's own sum says so, too.
    shifted = replace(surfaces, solid=solid, heights=surfaces.heights + shift)
    point = replace(Point.of(found), state=found.state[0])
    rest = float(np.abs(history.pressure + found.pressure.mean() - found.pressure).max())
    if rest > shifted.margin(point):
        study.fault(where, f"{rest:.1e} Pa from the hereditary integral")

    def again(start: np.ndarray) -> Solution:
        return contact.step(np.stack([start, *before[1:]]), target, duration)[0]

    equilibrium.check(study, point, target, again, shifted)


def _check_written(
    study: Study, written: InterfaceState, found: Solution, time: float, lost: float, where: str
) -> None:
    """A study's path has the states of its steps, the load even between its points.

    Loads that are rounded in another way end both ways within the solver's tolerance of each other.
    """
    point, moved = Point.of(found), float(np.ptp(study.surfaces.heights))
    margin = study.surfaces.margin(point)
    if np.abs(written.pressure - found.pressure).max() > margin:
        study.fault(where, "another state than that of its steps of time")
    for name, reported, expected, allowed in (
        ("time", written.further["time"], time, 1e-9 * time),
        ("stored", written.elastic_energy, found.elastic_energy, margin * moved),
        ("dissipated", written.further["viscous_dissipation"], lost, margin * moved),
    ):
        study.differs(where, name, reported, expected, allowed + 1e-9 * expected)
