"""Derivatives of the answers of one simulation by the uncertain keys of a study.

An adjoint solve gives them by heights, modulus, work of adhesion and range; each key changes these, by differences.
"""

import copy
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from bem_adhesion.contacts.rough_contact import Contact
from bem_adhesion.gradients.gradient import Gradient, gradient
from bem_adhesion.study.interface import contact_of
from contact_study.inputs.errors import InputError
from contact_study.results.uncertainty import BY_KEY
from contact_study.study.case import Case, realise
from contact_study.study.schema.dotted_keys import split
from contact_study.study.study import Study, make_study
from contact_study.study.uncertainty import DRAW, SECTION, uncertainty_of

_STEP = 1e-3  # of a key, over its median: of second order, and far above the rounding of surfaces
_TIGHT = 1e-10  # residual of the states, over E*
_SAME = 1e-6  # change of a shape that is none
_NUMBERS = {"relative_contact_area": "contact_area", "mean_gap": "mean_gap"}
_UNITS = {"relative_contact_area": "1", "mean_gap": "m"}
_GAPS = np.geomspace(0.8, 4.0, 9)  # over the length of a law: where its shape is compared


def sensitivity(study: Study) -> xr.Dataset:
    """Simulate the central case of a study with ``[uncertainty]``, and differentiate its answers by the uncertain keys.

    Parameters
    ----------
    study : Study
        With distributions of continuous keys, and no other sweep.

    Returns
    -------
    xarray.Dataset
        ``relative_contact_area`` and ``mean_gap`` (m) of draw 0 on (draw, step), and ``..._by_key`` on (parameter,
        step): derivatives by the keys in SI. :func:`contact_study.uncertainty` takes it in place of anchors.

    Raises
    ------
    InputError
        If a key is a choice or changes the shape of law or stiffness; if the solid is plastic or viscoelastic, or moves
        against friction; if a state does not converge.

    Examples
    --------
    >>> from contact_study import read_study
    >>> from bem_adhesion.study.sensitivity import sensitivity
    >>> anchors = sensitivity(read_study("study.toml"))  # doctest: +SKIP
    """
    declared = uncertainty_of(study.table)
    if declared is None:
        raise InputError("uncertainty: the study has no section [uncertainty]")
    if others := {*study.table.get("sweep", {})} - {DRAW}:
        raise InputError(f"{min(others)} is swept: a gradient is that of one case; leave the sweep out")
    (median,) = declared.values([0])
    for key, one in declared.distributions.items():
        if one.kind == "values":
            raise InputError(f"uncertainty.{key}: a choice has no derivative; use simulations as anchors")
    central = _case(study, median)
    _check(central)
    inputs = {key: _by_inputs(study, median, key, central) for key in declared.keys}
    values: dict[str, list[float]] = {name: [] for name in _NUMBERS}
    by_key: dict[str, list[list[float]]] = {name: [] for name in _NUMBERS}
    for contact, solution in _states(central):
        area = np.mean(central.law.in_contact(solution.gap, solution.pressure, central.contact_distance))
        for name, of in _NUMBERS.items():
            by = gradient(contact, solution, of)
            value = float(area) if of == "contact_area" else by.value
            # The area is smoothed for its derivative: that of its logarithm is taken.
            factor = value / by.value if by.value else 1.0
            values[name].append(value)
            by_key[name].append([factor * _along(by, change) for change in inputs.values()])
    load = {"pressure": "applied_pressure", "gap": "applied_gap"}.get(central.loading.control, "applied_approach")
    variables = {name: (("draw", "step"), [rows], {"units": _UNITS[name]}) for name, rows in values.items()}
    slopes = {f"{name}{BY_KEY}": (("parameter", "step"), np.array(rows).T) for name, rows in by_key.items()}
    coordinates = {"draw": [0], "parameter": [*inputs], load: ("step", [value for value, _ in central.path])}
    return xr.Dataset(variables | slopes, coordinates, {"model": "continuum", "study_toml": study.toml})


def _case(study: Study, values: dict[str, Any]) -> Case:
    """The case of a study at values of its uncertain keys."""
    table = {name: copy.deepcopy(content) for name, content in study.table.items() if name not in (SECTION, "sweep")}
    for dotted, value in values.items():
        section, name = split(dotted, SECTION)
        table.setdefault(section, {})[name] = value
    return make_study(table, study.directory).cases[0]


def _check(case: Case) -> None:
    if case.material.hardness is not None or case.elasticity.kind == "viscoelastic":
        raise InputError("material, elasticity: a plastic or viscoelastic contact has no gradient; use simulations")
    if case.solver.path == "overdamped" and case.law.attracts:
        raise InputError('solver.path = "overdamped": states in motion have no gradient; use simulations')
    if case.law.attracts and not np.isclose(case.contact_distance, case.law.contact_distance, rtol=1e-9):
        raise InputError("interaction.contact_distance: the gradient has the law's own distance; leave it out")


def _states(case: Case) -> Iterator[tuple[Contact, Any]]:
    tight = replace(case.solver, tolerance=min(_TIGHT, case.solver.tolerance or _TIGHT))
    contact = contact_of(replace(case, solver=tight), realise(case))
    state = contact.separated()
    for number, (value, _) in enumerate(case.path):
        solution = contact.step(state, value)
        state = solution.state
        if not solution.converged:
            raise InputError(f"the central case does not converge at {case.point_in_words(number)}")
        yield contact, solution


def _by_inputs(study: Study, median: dict[str, Any], key: str, central: Case) -> tuple[np.ndarray, float, float, float]:
    """Derivatives of heights, E*, work of adhesion and ln(length) by a key (SI)."""
    step = _STEP * (abs(median[key]) or 1.0)
    below, above = (_case(study, {**median, key: median[key] + way * step}) for way in (-1, 1))
    if not np.allclose(_shape(below), _shape(above), rtol=_SAME):
        raise InputError(f"uncertainty.{key}: changes the shape of the law or of K(q); use simulations as anchors")
    same = above.geometry == below.geometry
    heights = np.zeros(()) if same else realise(above).sampled - realise(below).sampled
    one, other = below.law, above.law
    works = other.work_of_adhesion - one.work_of_adhesion if central.law.attracts else 0.0
    lengths = np.log(other.length / one.length) if central.law.attracts else 0.0
    moduli = above.solid.contact_modulus - below.solid.contact_modulus
    return heights / (2 * step), moduli / (2 * step), works / (2 * step), float(lengths) / (2 * step)


def _shape(case: Case) -> np.ndarray:
    """Numbers without a dimension of law and solid, which a gradient takes as given; and the loads."""
    waves = np.geomspace(*case.scales.grid_waves, 5)
    loads = np.array([value for value, _ in case.path])
    found = [case.solid.stiffness(waves) / (case.solid.contact_modulus * waves), loads]
    if case.law.attracts:
        found.append(case.law.traction(_GAPS * case.law.length) * case.law.length / case.law.work_of_adhesion)
    return np.concatenate(found)


def _along(by: Gradient, change: tuple[np.ndarray, float, float, float]) -> float:
    heights, modulus, work, length = change
    of_work = 0.0 if by.work_of_adhesion is None else float(by.work_of_adhesion.sum()) * work
    return float(np.sum(by.heights * heights)) + by.contact_modulus * modulus + of_work + by.length_scale * length
