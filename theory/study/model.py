"""The theories of a case as a campaign runs them; the branches of the gap flow have groups of their own."""

import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np

from contact_study.campaign.model import MODELS
from contact_study.inputs.errors import InputError
from contact_study.physics.surfaces.surface import Surface, SurfaceScales
from contact_study.results.schema import RESOLUTION_ERROR, quantity_of
from contact_study.results.state import Step, Value
from contact_study.study.case import Case
from contact_study.study.study import Study
from contact_study.study.sweep import points
from theory.criteria import local_tabor_number, range_of, stickiness
from theory.edge_flow.apparent_adhesion import Extrapolated
from theory.gap_flow.state import PressureCurve
from theory.persson.separation import NegativeSeparation, NotConverged, energy_defect, pull_off_pressure
from theory.study import paths
from theory.study.case_theories import CaseTheories, case_theories

MODEL = MODELS["theory"]
POINTS_FOR_THREADS = 0

# Largest σ_a over the stress of the roughness, and wavelength of the finest roughness over the length of the law.
_FLATTEST, _COARSEST = 300.0, 1e5

# Quantities with an error, and the words of a warning.
_JUDGED = {
    "relative_contact_area": "of the contact area",
    "mean_gap": "of the rms height in the mean gap",
    "mean_pressure": "of the full-contact stress in the mean pressure",
    "stress_balance": "of the pressure in the balance of stress",
}


class Unresolved(UserWarning):
    """States of a theory whose estimated error of resolution exceeds ``theory.accuracy``."""


def check(case: Case) -> None:
    """InputError if a case lacks roughness or a spectrum, or has what the theories do not treat."""
    case.require_gap()
    kind = case.surface.kind
    if case.elasticity.kind == "viscoelastic":
        raise InputError('elasticity.kind = "viscoelastic": the theories are static; use "half_space" or a simulation')
    if case.material.hardness is not None:
        raise InputError(f"material.hardness = {case.material.hardness:g} Pa: the theories are elastic; leave it out")
    if case.elasticity.boundary != "periodic":
        raise InputError(f'elasticity.boundary = "{case.elasticity.boundary}": the theories need "periodic"')
    if case.loading.control == "approach":
        raise InputError('loading.control = "approach": the theories follow "pressure" or "gap"')
    if case.form.kind != "none":
        raise InputError(
            f'form.kind = "{case.form.kind}": the theories are of nominally flat surfaces; leave [form] out'
        )
    if not case.geometry.rough:
        raise InputError(f'surface.kind = "{kind}": a theory of roughness needs a rough surface')
    if case.geometry.target_spectrum is None and "analytic" in case.spectra:
        beside = "" if case.geometry is case.surface else " beside [detail] or [counterface]"
        raise InputError(f'theory.spectrum = "analytic": surface.kind = "{kind}"{beside} has none; use "surface"')


def review(study: Study, scales: Sequence[SurfaceScales]) -> list[str]:
    """Warn of roughness that is too coarse for the law; InputError if adhesion is so strong that it is flat to it."""
    coarse, notes = [], _mean_adhesion(study)
    for case, scale in zip(study.cases, scales, strict=True):
        solid, law = case.solid, case.law
        finest = min(scale.shortest_wave, scale.size[0], scale.size[1])
        stress = scale.full_contact_stress(solid)
        # In a stiffly held solid the longest wave may be the stiffest.
        stiffness = float(np.max(solid.stiffness(2 * np.pi / np.array([finest, max(scale.size)]))))
        tension = np.sqrt(2 * case.theory.alpha * stiffness * law.work_of_adhesion)
        if case.theory.cap_detachment_stress:
            tension = min(tension, law.peak_tensile_stress)
        if tension > _FLATTEST * stress > 0:
            raise InputError(
                f"surface, interaction: the detachment stress of the finest roughness, {tension:.3g} Pa, is "
                f"{tension / stress:.3g} times the stress of full contact, {stress:.3g} Pa; the limit is "
                f"{_FLATTEST:g}. Such a surface is flat to this law: check size, heights and adhesion"
            )
        if law.attracts and finest > _COARSEST * law.length:
            coarse.append((case, finest, law.length))
    if not coarse:
        return notes
    case, finest, length = coarse[0]
    where = points([case for case, *_ in coarse], len(study.cases))
    return [
        *notes,
        f"surface: its finest roughness, of wavelength {finest:.3g} m, is {finest / length:.2g} times "
        f"interaction.length{where}: the theories leave out all roughness below it",
    ]


def _mean_adhesion(study: Study) -> list[str]:
    """Warn of cases whose work of adhesion varies."""
    varied = [case for case in study.cases if case.adhesion_map.kind != "none"]
    if not varied:
        return []
    kind = f'adhesion_map.kind = "{varied[0].adhesion_map.kind}"{points(varied, len(study.cases))}'
    return [f"{kind}: the theories take the mean work of adhesion, not its variation along the surface"]


def constants(case: Case, surface: Surface) -> dict[str, Value]:
    """Constants of the case: pull-off pressures, criteria of stickiness, scales of the surface."""
    every, law = case_theories(case, surface), case.law
    theories = every[0]
    theory, spectrum = theories.persson, theories.spectrum
    q = paths.stored_wavevectors(theory)
    with theories.naming_the_spectrum():
        defect = energy_defect(theory, *theories.effort)
    values: dict[str, Value] = {
        "contact_modulus": theory.solid.contact_modulus,
        "work_of_adhesion": law.work_of_adhesion,
        "equilibrium_distance": law.equilibrium_distance,
        "peak_tensile_stress": law.peak_tensile_stress,
        "contact_distance": case.contact_distance,
        "rms_height": float(np.sqrt(spectrum.mean_square_height)),
        "rms_slope": spectrum.rms_slope,
        "energy_defect": defect,
        "wavevector": q,
    }
    if case.theory.magnifications:
        values["magnification"] = paths.magnifications(theory, case.theory.magnifications)
    if law.attracts:
        values |= stickiness(spectrum, case.solid, law).quantities()
        values["apparent_adhesion_ratio"] = theories.apparent_adhesion
        values["local_tabor_number"] = local_tabor_number(q, spectrum, case.solid, law.work_of_adhesion, range_of(law))
    for theories in every:
        tolerance, most = theories.effort
        with theories.naming_the_spectrum():
            pulled = {"persson": pull_off_pressure(theories.persson, tolerance=tolerance, max_iterations=most)}
        named: list[tuple[str, PressureCurve]] = [(flow.name, flow) for flow in theories.gap_flows]
        named += [(name, flow) for flow in theories.edge_flows for name in flow.names]
        pulled |= {name: flow.pull_off_pressure for name, flow in named}
        values |= {theories.named(f"{name}/pull_off_pressure"): pressure for name, pressure in pulled.items()}
        values |= {theories.named(f"{name}/work_of_separation"): flow.work_of_separation for name, flow in named}
        errors_by_name = {name: theories.area_error(flow.branch) for flow in theories.edge_flows for name in flow.names}
        values |= {theories.named(f"{name}/area_error_in_atlas"): error for name, error in errors_by_name.items()}
    return values


def solve_path(
    case: Case, surface: Surface, restart: Mapping[str, np.ndarray] | None = None, start: int = 0
) -> Iterator[Step]:
    """Yield a step for each path point from number ``start`` on, with ``restart`` that of the point before."""
    every, accuracy = case_theories(case, surface), case.theory.accuracy
    found = _along(every, restart or {}, start)
    if accuracy is None:
        yield from (Step(values, restart=state) for values, state in found)
        return
    halved = tuple(replace(theories, coarsening=2) for theories in every)
    coarser = _quietly(values for values, _ in _along(halved, {}, 0))
    missed: dict[str, list[tuple[float, str]]] = {}
    both = zip(found, islice(coarser, start, None), strict=True)
    for number, ((values, state), others) in enumerate(both, start):
        added, worst = errors(values, others, every[0], accuracy)
        for name, error in worst.items():
            missed.setdefault(name, []).append(error)
        if number == len(case.path) - 1:  # the consumer stops at the last step
            _warn(missed, len(case.path) - start, accuracy)
        yield Step(values | added, restart=state)


def _along(
    every: tuple[CaseTheories, ...], restart: Mapping[str, np.ndarray], start: int
) -> Iterator[tuple[dict[str, Any], dict[str, np.ndarray]]]:
    """Values of all theories and the restart state, at each path point from number ``start`` on."""
    solid = every[0].case.solid
    names = ["_".join(["detachment_stress", *filter(None, [theories.other])]) for theories in every]
    begun = zip(every, names, strict=True)
    states_along = [paths.persson_path(each, restart.get(name, "adhered"), start) for each, name in begun]
    flows = [paths.flow_paths(theories, start) for theories in every]
    for number, states in enumerate(zip(*states_along, strict=True), start):
        values: dict[str, Any] = {}
        kept: dict[str, np.ndarray] = {}
        for theories, found, stress_name, (own, stress) in zip(every, flows, names, states, strict=True):
            for name, value in own.items():
                if name not in paths.PERSSONS_OWN:
                    values[theories.named(f"persson/{name}")] = value
                elif not theories.other:
                    values[name] = value
            for path in found:
                values |= {theories.named(name): value for name, value in path(number).items()}
            if not isinstance(stress, str):
                kept[stress_name] = stress
        # The mean separation of every theory, and a layer's uniform compression in its energy.
        for group in [name.removesuffix("mean_gap") for name in values if quantity_of(name)[1] == "mean_gap"]:
            pressure, energy = (float(values[group + key]) for key in ("mean_pressure", "elastic_energy"))
            values[group + "mean_separation"] = float(values[group + "mean_gap"]) - solid.compression(pressure)
            values[group + "elastic_energy"] = energy + solid.compression_energy(pressure)
        yield values, kept


def _quietly(values: Iterator[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """Values of coarse theories without their warnings, which the fine ones repeat where they matter."""
    while True:
        with warnings.catch_warnings():
            for kind in (NotConverged, NegativeSeparation, Extrapolated):
                warnings.simplefilter("ignore", kind)
            found = next(values, None)
        if found is None:
            return
        yield found


def errors(
    fine: Mapping[str, Any], coarser: Mapping[str, Any], theories: CaseTheories, accuracy: float
) -> tuple[dict[str, Any], dict[str, tuple[float, str]]]:
    """Errors of a point's states, in units of the quantities, with flags; the worst of those not resolved, with words.

    A state of Persson's theory that is ``resolved`` has a ``stress_balance`` of one, too. Areas are compared with
    themselves, gaps with the rms height, pressures with the stress of full contact; what is prescribed has no error.
    One that exists at one of the two resolutions only has the error NaN.
    """
    scales = {
        "mean_gap": float(np.sqrt(theories.spectrum.mean_square_height)),
        "mean_pressure": theories.persson.stress_scale,
    }
    prescribed = f"mean_{theories.case.loading.control}"
    found: dict[str, Any] = {}
    worst: dict[str, tuple[float, str]] = {}
    for name in fine:
        labels, quantity = quantity_of(name)
        if quantity not in _JUDGED or quantity == prescribed:
            continue
        one, other = float(fine[name]), float(coarser[name])
        state = "/".join(labels)
        if quantity == "stress_balance":
            if not state.startswith("persson"):
                continue
            error, scale, other = abs(one - 1.0), 1.0, one
        else:
            error, scale = 0.0 if one == other else abs(one - other), scales.get(quantity, one)  # both may be infinite
            found[name + RESOLUTION_ERROR] = error if np.isfinite(error) else np.nan
        if np.isnan(one) and np.isnan(other):  # defined at neither resolution
            error = 0.0
        share = error / scale if scale else np.inf if error else 0.0
        found.setdefault(f"{state}/resolved", True)
        if not share <= accuracy:
            found[f"{state}/resolved"] = False
            worst[state] = max(worst.get(state, (0.0, "")), (np.inf if np.isnan(share) else share, _JUDGED[quantity]))
    return found, worst


def _warn(missed: Mapping[str, list[tuple[float, str]]], points: int, accuracy: float) -> None:
    """One warning for each theory that misses the accuracy somewhere on the path."""
    for state, cases in missed.items():
        share, words = max(cases)
        size = f"{share:.2g} {words}" if np.isfinite(share) else "a state that half the resolution does not find"
        where = f"{state.replace('_', ' ')}: at {len(cases)} of {points} points"
        above = f"the estimated error of the resolution is above theory.accuracy = {accuracy:g}, at most {size}"
        warnings.warn(f"{where} {above}", Unresolved, stacklevel=2)
