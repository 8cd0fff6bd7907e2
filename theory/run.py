"""The theories of a case as a campaign runs them, and the command ``persson-theory``.

``persson`` is Persson's theory as the paper used it, ``gap_flow`` the equilibrium of the gap-flow theory, and
``gap_flow/loading`` and ``gap_flow/unloading`` are the two metastable branches that enclose what is reached;
``edge_flow`` is the edge flow.
"""

import warnings
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from scipy.optimize import brentq

from contact_study.campaign.model import Model
from contact_study.campaign.record import Step
from contact_study.campaign.schema import quantity_of
from contact_study.fields.spectrum import RoughnessSpectrum
from contact_study.observables.base import Value
from contact_study.observables.constants import InterfaceConstants
from contact_study.problem.case import Case
from contact_study.problem.elasticity import Elasticity
from contact_study.problem.errors import InputError
from contact_study.problem.plausibility import points
from contact_study.problem.study import Study
from contact_study.problem.surface import Surface
from contact_study.problem.surface_scales import SurfaceScales
from theory.gap_flow import BRANCHES, gap_flow
from theory.gap_paths import DETACHED, edge_flow_paths, flow_name, gap_flow_paths, nowhere, warn_of_unconverged
from theory.persson import TOLERANCE, PerssonContact, PerssonTheory, solve
from theory.separation import (
    NegativeSeparation,
    SeparationCurve,
    energy_defect,
    pull_off_pressure,
    separation_curve,
)

MODEL = Model(
    command="persson-theory",
    kind="theory",
    module="theory.run",
    ignores=("atomistic",),
    whole_path=True,  # the separation curve, and the gaps of the gap flow, reach as far as the path asks
    description="Persson's theory of rough contact with adhesion, and beside it the gap-flow theory and the edge flow",
    references="C. Yang, B. N. J. Persson, J. Israelachvili, K. Rosenberg, EPL 84, 46004 (2008); "
    "B. N. J. Persson, J. Chem. Phys. 115, 3840 (2001); akin to the gap flow: J. Joe, Traction Between Rough Surfaces, "
    "PhD thesis, University of Michigan (2021), https://hdl.handle.net/2027.42/169927",
)

_UNSOUND_GAP = "states at higher pressures that the mean gap rests on did not converge"

# Wavevectors at which the magnification-resolved quantities are stored.
_STORED_WAVEVECTORS = 129
_RESOLVED = ("relative_contact_area_at", "detachment_stress", "effective_work_of_adhesion")

# Quantities that no other theory has.
_PERSSONS_OWN = (*_RESOLVED, "contact_stress", "edge_stress")

# Below this pressure, in units of the full-contact stress, a mean gap is not sought.
_LOWEST_PRESSURE = 1e-9

# Shortest wave over the law's length from which on a spectrum is said to leave out most of what adhesion meets.
_COARSEST = 1e5

# Change of the detachment stress, in the same units, that rounding still lets the iteration reach.
_FINEST_TOLERANCE = 1e-11


def main(arguments: Sequence[str] | None = None) -> int:
    """The command ``persson-theory``; returns the exit status."""
    from contact_study.campaign import command  # workers solve, and need none of what reads and writes datasets

    return command.main(MODEL, arguments)


def check(case: Case) -> None:
    """Make sure that there is a spectrum to work with.

    Raises
    ------
    InputError
        If the surface is flat, or the analytic spectrum is asked of a surface that has none.
    """
    kind = case.surface.kind
    if not case.surface.rough:
        raise InputError(f'surface.kind = "{kind}": a theory of roughness needs a rough surface')
    if case.surface.target_spectrum is None and case.theory.spectrum == "analytic":
        raise InputError(f'theory.spectrum = "analytic": surface.kind = "{kind}" has none; use "surface"')


def review(study: Study, scales: Sequence[SurfaceScales]) -> list[str]:
    """Say where roughness and law have too little to do with each other, in one line for the whole study.

    Raises
    ------
    InputError
        If the detachment stress dwarfs the stress of the roughness so far that the theory's cells cannot hold both.
    """
    coarse = []
    for case, scale in zip(study.cases, scales, strict=True):
        solid, law = case.solid, case.law
        finest = min(scale.shortest_wave, scale.size[0], scale.size[1])
        stress = scale.full_contact_stress(solid)
        # Of a solid that is held stiffly the longest wave may be the stiffest.
        stiffness = float(np.max(solid.stiffness(2 * np.pi / np.array([finest, max(scale.size)]))))
        tension = np.sqrt(2 * case.theory.alpha * stiffness * law.work_of_adhesion)
        if case.theory.cap_detachment_stress:
            tension = min(tension, law.peak_tensile_stress)
        if tension > PerssonTheory.cells * stress > 0:
            raise InputError(
                f"surface, interaction: adhesion ({tension:.3g} Pa at the finest roughness) dwarfs the stress that the "
                f"roughness makes ({stress:.3g} Pa) by {tension / stress:.3g}; Persson's theory resolves a factor of "
                f"{PerssonTheory.cells}. Such a surface is flat to this law: check size, heights and adhesion"
            )
        if law.attracts and finest > _COARSEST * law.length:
            coarse.append((case, finest, law.length))
    if not coarse:
        return []
    case, finest, length = coarse[0]
    where = points([case for case, *_ in coarse], len(study.cases))
    return [
        f"surface: its finest roughness, of wavelength {finest:.3g} m, is {finest / length:.2g} times "
        f"interaction.length{where}: the theories know of none below it"
    ]


def roughness(case: Case, surface: Surface) -> RoughnessSpectrum:
    """The spectrum that the case asks for.

    Raises
    ------
    InputError
        If a height map is flat.
    """
    if case.theory.spectrum == "analytic" and surface.spectrum is not None:
        return surface.spectrum
    try:
        return surface.measured_spectrum()
    except ValueError as error:
        raise InputError(f"surface: {error}") from None


def persson_theory(case: Case, surface: Surface) -> PerssonTheory:
    """Persson's theory with the choices of the case."""
    chosen = case.theory
    return PerssonTheory(
        roughness(case, surface),
        case.solid,
        case.law.work_of_adhesion,
        chosen.energy_weight,
        chosen.beta,
        chosen.true_area,
        chosen.alpha,
        case.law.peak_tensile_stress if chosen.cap_detachment_stress else np.inf,
    )


def _effort(case: Case, theory: PerssonTheory) -> tuple[float, int]:
    """Tolerance, in units of the full-contact stress, and largest number of iterations of a state of Persson's theory.

    Its residual is the change of σ_a over E*, which ``solver.tolerance`` bounds as it does the residual stress of the
    simulations; but it is never looser than the theory's own choice, which counts on flat surfaces of little stress.
    """
    asked = case.solver.tolerance * theory.solid.contact_modulus / theory.stress_scale
    return float(np.clip(asked, _FINEST_TOLERANCE, TOLERANCE)), case.solver.max_iterations


def constants(case: Case, surface: Surface) -> dict[str, Value]:
    """What does not change along the path."""
    theory, law = persson_theory(case, surface), case.law
    spectrum = theory.spectrum
    tolerance, max_iterations = _effort(case, theory)
    known = InterfaceConstants(
        contact_modulus=theory.solid.contact_modulus,
        work_of_adhesion=law.work_of_adhesion,
        equilibrium_distance=law.equilibrium_distance,
        peak_tensile_stress=law.peak_tensile_stress,
        contact_distance=case.contact_distance,
        rms_height=float(np.sqrt(spectrum.mean_square_height)),
        rms_slope=spectrum.rms_slope,
    )
    values: dict[str, Value] = {
        **known.values,
        "energy_defect": energy_defect(theory, tolerance, max_iterations),
        "persson/pull_off_pressure": pull_off_pressure(theory, tolerance=tolerance, max_iterations=max_iterations),
        "wavevector": _stored_wavevectors(theory),
    }
    if not law.has_wall:
        for branch in BRANCHES:
            flow = gap_flow(spectrum, theory.solid, law, branch)
            warn_of_unconverged(flow)
            values[flow_name(branch, "pull_off_pressure")] = flow.pull_off_pressure
    return values


def solve_path(
    case: Case, surface: Surface, restart: Mapping[str, np.ndarray] | None = None, start: int = 0
) -> Iterator[Step]:
    """Yield a step for each path point from number ``start`` on.

    Each state of Persson's theory starts from the one before, since under tension the branch matters; the first from
    the adhered branch, which the paper follows.

    Parameters
    ----------
    case : Case
        The case.
    surface : Surface
        Its surface.
    restart : mapping, optional
        ``Step.restart`` of point ``start`` − 1; None at the first.
    start : int, optional
        Number of the first point to solve.

    Raises
    ------
    InputError
        If the surface has no spectrum, or a point of the path is beyond any contact.
    """
    theory = persson_theory(case, surface)
    curve = _separation(case, theory)
    paths = [*gap_flow_paths(case, theory.spectrum), *edge_flow_paths(case, theory.spectrum)]
    by_pressure = case.loading.control == "pressure"
    pressures = [value if by_pressure else _pressure_at(curve, value) for value, _ in case.path]
    gaps = curve.mean_gap(np.array(pressures))
    stress: np.ndarray | str = (restart or {}).get("detachment_stress", "adhered")
    for number in range(start, len(case.path)):
        if np.isnan(pressures[number]):
            values = _unreachable(case.path[number][0])
        else:
            contact = solve(theory, pressures[number], stress, *_effort(case, theory))
            stress = contact.detachment_stress
            values = _persson_values(contact) | {"mean_gap": float(gaps[number])}
            if np.isfinite(gaps[number]) and not curve.converged_above(pressures[number]):
                values |= {"converged": False, "message": _UNSOUND_GAP}
        values = {name if name in _PERSSONS_OWN else f"persson/{name}": value for name, value in values.items()}
        for path in paths:
            values |= path[number]
        yield Step(
            _with_compression(values, case.solid),
            restart={} if isinstance(stress, str) else {"detachment_stress": stress},
        )


def _with_compression(values: dict[str, Any], solid: Elasticity) -> dict[str, Any]:
    """The values of every theory with its mean separation, and with a layer's uniform compression in its energy.

    Nothing slides in a theory of the mean gap: that compression is all that parts gap and separation.
    """
    for name in [name for name in values if quantity_of(name)[1] == "mean_gap"]:
        group = name.removesuffix("mean_gap")
        gap, pressure, energy = (float(values[group + key]) for key in ("mean_gap", "mean_pressure", "elastic_energy"))
        values[group + "mean_separation"] = gap - solid.compression(pressure)
        values[group + "elastic_energy"] = energy + solid.compression_energy(pressure)
    return values


def _separation(case: Case, theory: PerssonTheory) -> SeparationCurve:
    """The separation curve down to the lowest pressure, or out to the largest gap, of the path."""
    tolerance, max_iterations = _effort(case, theory)

    def sweep(lowest: float) -> SeparationCurve:
        return separation_curve(theory, lowest, tolerance=tolerance, max_iterations=max_iterations)

    if case.loading.control == "pressure":
        # Tension has no separation; a curve that nothing is read from stays short.
        lowest = min((p for p, _ in case.path if p > 0), default=theory.stress_scale)
        return sweep(min(lowest, theory.stress_scale))
    curve = sweep(1e-3 * theory.stress_scale)
    largest = max(gap for gap, _ in case.path)
    ends = _quiet_gap(curve, curve.pressure[:2])
    growth = ends[0] - ends[1]
    if ends[0] > largest or growth <= 0:  # reached, or sticking so strong that the gap no longer grows
        return curve
    # At light load the gap grows by the same step with every decade less pressure; one decade in reserve.
    decades = (largest - ends[0]) / growth * np.log10(curve.pressure[1] / curve.pressure[0]) + 1
    lowest = max(curve.pressure[0] * 10.0 ** (-decades), _LOWEST_PRESSURE * theory.stress_scale)
    return sweep(lowest)


def _quiet_gap(curve: SeparationCurve, pressure: np.ndarray | float) -> np.ndarray:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NegativeSeparation)
        return curve.mean_gap(pressure)


def _pressure_at(curve: SeparationCurve, gap: float) -> float:
    """Lowest pressure at which the mean gap has fallen to ``gap``; NaN if the theory reaches no such gap."""
    gaps = _quiet_gap(curve, curve.pressure)
    reached = np.flatnonzero(gaps <= gap)
    if gap <= 0 or reached.size == 0 or reached[0] == 0:
        return float("nan")
    low, high = np.log(curve.pressure[reached[0] - 1 : reached[0] + 1])
    return float(np.exp(brentq(lambda x: float(_quiet_gap(curve, np.exp(x))) - gap, low, high, xtol=1e-10)))


def _stored_wavevectors(theory: PerssonTheory) -> np.ndarray:
    return np.geomspace(theory.wavevectors[0], theory.wavevectors[-1], _STORED_WAVEVECTORS)


def _persson_values(contact: PerssonContact) -> dict[str, Any]:
    theory = contact.theory
    if contact.detached:
        return DETACHED | {
            **{name: np.zeros(_STORED_WAVEVECTORS) for name in _RESOLVED},
            "pressure_pdf": nowhere,
            "contact_stress": 0.0,
            "edge_stress": 0.0,
            "message": "detached: the adhered branch ends above this pressure",
            "iterations": contact.iterations,
        }
    stored, nodes = np.log(_stored_wavevectors(theory)), np.log(theory.wavevectors)
    message = ""
    if contact.pressure <= 0:
        message = "the theory's mean gap diverges at zero pressure and is not defined under tension"
    elif not contact.converged:
        message = f"the detachment stress did not converge; {contact.advice}"
    return {
        "mean_pressure": contact.pressure,
        "relative_contact_area": contact.relative_contact_area,
        "elastic_energy": contact.elastic_energy,
        "interaction_energy": contact.adhesion_energy,
        "pressure_pdf": contact.pressure_density,
        "contact_stress": contact.contact_stress,
        "edge_stress": contact.edge_stress,
        "relative_contact_area_at": np.interp(stored, nodes, contact.contact),
        "detachment_stress": np.interp(stored, nodes, contact.detachment_stress),
        "effective_work_of_adhesion": np.interp(stored, nodes, contact.effective_work_of_adhesion),
        "converged": contact.converged,
        "detached": contact.detached,
        "message": message,
        "residual": contact.residual * theory.stress_scale / theory.solid.contact_modulus,
        "iterations": contact.iterations,
    }


def _unreachable(gap: float) -> dict[str, Any]:
    """Values of a prescribed mean gap that Persson's theory has no pressure for: NaN."""
    names = ("mean_pressure", "relative_contact_area", "elastic_energy", "interaction_energy", "contact_stress")
    lost: dict[str, Any] = dict.fromkeys((*names, "edge_stress", "residual"), float("nan"))
    return lost | {
        **{name: np.full(_STORED_WAVEVECTORS, np.nan) for name in _RESOLVED},
        "pressure_pdf": lambda edges: np.full(edges.size - 1, np.nan),
        "mean_gap": gap,
        "converged": False,
        "detached": False,
        "message": "the theory has no pressure for this mean gap",
        "iterations": 0,
    }


if __name__ == "__main__":
    raise SystemExit(main())
