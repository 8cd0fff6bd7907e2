"""Fit by simulated loops: simulate a few, fit, and simulate those missing around the best fit and its intervals."""

from collections.abc import Mapping, Sequence

import numpy as np

from contact_study.inference.curves import MeasuredCurve
from contact_study.inference.fit import Fit, fit, profile
from contact_study.inference.parameters import MODULUS, PHYSICAL, RADIUS, RANGE, WORK, Prior
from contact_study.inference.simulated import SimulatedLoops
from contact_study.inference.spheres import MODELS
from contact_study.inference.starts import starts
from contact_study.inputs.errors import InputError

_ROUNDS = 8  # of fits and further loops
_FACTORS = (0.85, 1.0, 1.2)  # of the starts
_SHALLOWEST = 1e-12  # depth of loops (m)
_BESIDE = 1.0  # of the error of the force: interpolation between loops below it is not mentioned


def fit_by_loops(
    loops: SimulatedLoops, curves: Sequence[MeasuredCurve], known: Mapping[str, Prior]
) -> tuple[Fit, list[str]]:
    """Fit work of adhesion and modulus by simulated loops.

    Parameters
    ----------
    loops : SimulatedLoops
        Of the probe; loops are added.
    curves : sequence of MeasuredCurve
        Forces over displacements.
    known : mapping of str to Prior
        Fixed values and priors.

    Returns
    -------
    Fit, list of str
        With profiles; and notes.

    Raises
    ------
    InputError
        If radius or range are given beside the study's, or a curve has contact radii.
    """
    for name in (RADIUS, RANGE):
        if name in known:
            raise InputError(f"{name}: is the study's; leave it out for the model simulation")
    if any(2 in curve.rows for curve in curves):
        raise InputError("contact_radius: simulated loops give force and displacement; leave the column out with -")
    own = {**known, RADIUS: Prior(loops.radius), RANGE: Prior(loops.range)}
    problem, first = starts(MODELS["maugis"], curves, own)
    smooth = fit(problem, first)
    constants = smooth.problem.constants(smooth.best)
    loops.prepare(_depth(smooth))
    loops.cover(_ratio(constants), _ratio(constants))
    for _ in range(_ROUNDS):
        guess = {name: constants[name] for name in (WORK, MODULUS, RADIUS)}
        problem, first = starts(loops, curves, own, guess=guess, factors=_FACTORS)
        found = fit(problem, first)
        constants = problem.constants(found.best)
        anew = loops.prepare(_depth(found))
        if loops.cover(_ratio(constants), _ratio(constants)) or anew:
            continue
        inside = _profiled(found)
        if not loops.cover(min(inside), max(inside)):
            return found, _notes(loops, found)
    raise InputError("study: fits by its loops do not settle; give a prior of the modulus or the work of adhesion")


def _profiled(found: Fit) -> list[float]:
    """Follow all profiles of a fit; ln(w/E*) along them, as far as the intervals reach."""
    inside = []
    for name in reversed(PHYSICAL):
        if name in found.problem.labels:
            along = found.profiles[name] = profile(found, name)
            inside += [_ratio(found.problem.constants(u)) for u in along.others[along.rise <= found.threshold]]
    return inside


def _ratio(constants: Mapping[str, float]) -> float:
    return float(np.log(constants[WORK] / constants[MODULUS]))


def _depth(found: Fit) -> float:
    """Largest displacement of the probe beyond first touch (m), by the zeros of a fit."""
    depths = []
    for number, curve in enumerate(found.problem.curves):
        at, rest = found.problem.offsets(found.best, number)
        probe = curve.points[0] - at - curve.compliance * (curve.force - rest)
        depths.append(float(np.sort(probe)[-3]))  # not the noise of one point
    return max(*depths, _SHALLOWEST)


def _notes(loops: SimulatedLoops, found: Fit) -> list[str]:
    constants = found.problem.constants(found.best)
    notes = [f"simulation: {loops.count} loops over w/E*", *(f"simulation: {note}" for note in loops.notes)]
    share = loops.interpolation_error(_ratio(constants)) * constants[MODULUS]
    share /= min(
        float(errors[curve.rows.index(1)])
        for errors, curve in zip(found.problem.errors, found.problem.curves, strict=True)
    )
    if share > _BESIDE:
        notes.append(f"simulation: interpolation between loops errs by up to {share:.2g} errors of the force")
    return notes
