"""A path of a hard wall with a hardness: bounds, what yields and where, unloading, what stays."""

from dataclasses import replace

import numpy as np

from bem_adhesion import Solution
from contact_study.physics.solids import HalfSpace
from research.state_checks import equilibrium
from research.state_checks.equilibrium import CHANGE, changes
from research.state_checks.state import Point, Study

# Share of the hardness by which a pressure that is at it may be off in float64.
ROUNDED = 1e-14


def follow(study: Study) -> None:
    """Solve a case's path and check its states."""
    case, surfaces, verdict, hardness = study.case, study.surfaces, study.verdict, study.case.material.hardness
    assert hardness is not None
    contact = study.contact()
    state, before = contact.separated(), np.zeros(surfaces.grid.shape)
    earlier: dict[float, Solution] = {}
    for target, _ in case.path:
        found = contact.step(state, target)
        verdict.states += 1
        if not found.converged:
            verdict.flagged.append(found.message)
            return
        where = f"hardness, {surfaces.control} {target:.4g}"
        yielded = found.plastic_indentation
        assert yielded is not None
        if found.pressure.max() > hardness * (1 + ROUNDED) or found.pressure.min() < 0:
            study.fault(where, f"pressures from {found.pressure.min():g} to {found.pressure.max():g} Pa")
        if np.any(yielded < before) or np.any((yielded > before) & (found.pressure < hardness * (1 - ROUNDED))):
            study.fault(where, "yields where it may not, or back")
        if np.any(found.gap[found.pressure > 0]):
            study.fault(where, "a gap under pressure")
        # With what has yielded taken off, it is an elastic contact like any other; which start it has been found from
        # decides nothing, what had yielded before it everything.
        worn = replace(surfaces, heights=surfaces.heights - yielded)
        point = replace(Point.of(found), state=found.state[0])

        def again(start: np.ndarray, kept: np.ndarray = state[1], target: float = target) -> Solution:
            return contact.step(np.stack([start, kept]), target)

        # An approach counts from where the surface was highest before it yielded.
        lost = surfaces.heights.max() - worn.heights.max() if surfaces.control == "approach" else 0.0
        equilibrium.check_with_energies(study, point, target - lost, again, worn)
        _check_work(study, found, before, hardness, where)
        _check_unloading(study, found, target, earlier, where)
        earlier[target] = found
        state, before = found.state, yielded


def _check_work(study: Study, found: Solution, before: np.ndarray, hardness: float, where: str) -> None:
    """No other way to yield, of no less than had yielded before, takes less energy under the mean pressure found.

    Work at the hardness and that of the load are part of it; under a prescribed gap, too, for that is one of surfaces
    as they are after yielding and bounds no way to yield.
    """
    surfaces = study.surfaces
    if surfaces.free:  # only bounds of the energy beside a state are known there
        return
    yielded, length = found.plastic_indentation, float(surfaces.heights.std())
    assert yielded is not None

    def energy(gap: np.ndarray, indentation: np.ndarray) -> float:
        heights = surfaces.heights - indentation
        elastic = surfaces.elastic.energy(surfaces.law, heights, Point.of(found), gap, "pressure")
        # The mean of the surfaces moves with what yields.
        return elastic + (hardness - float(found.pressure.mean())) * float(indentation.mean())

    lowest = energy(found.gap, yielded)
    for less, other in zip(changes(surfaces.grid, study.rng), changes(surfaces.grid, study.rng), strict=True):
        indentation = np.maximum(yielded + CHANGE * length * less, before)
        gap = np.maximum(found.gap + CHANGE * length * other, 0)
        if energy(gap, indentation) < lowest - 1e-10 * abs(lowest):
            study.fault(where, "another way to yield takes less energy")


def _check_unloading(study: Study, found: Solution, target: float, earlier: dict[float, Solution], where: str) -> None:
    """Below a load that it has carried nothing yields, and at that load it is as it was; of half-spaces.

    Of a layer that resists flow a pressure may rise somewhere as the load falls.
    """
    case = study.case
    if not isinstance(case.solid, HalfSpace) or not earlier:
        return
    sign = -1 if case.loading.control == "gap" else 1
    carried = max(sign * at for at in earlier)
    if sign * target > carried:
        return
    most = earlier[sign * carried]
    assert found.plastic_indentation is not None
    assert most.plastic_indentation is not None
    length = float(found.plastic_indentation.max())
    if np.abs(found.plastic_indentation - most.plastic_indentation).max() > 1e-9 * length:
        study.fault(where, "unloading yields")
    if target in earlier and sign * target == carried:
        away = float(np.abs(found.pressure - most.pressure).max())
        if away > 1e-6 * case.solid.contact_modulus:
            study.fault(where, f"loaded again pressures differ by {away:.1e} Pa")
