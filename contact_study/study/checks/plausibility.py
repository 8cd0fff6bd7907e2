"""Plausibility of a study: numbers that do not fit each other, named before any work starts.

Every criterion is a ratio of the study's scales, so that no unit, material or size is favoured:

- **slope** √<|∇h|²>. Linear elasticity of a half-space is an expansion in it. Above 1 the study runs with a
  warning, above 100 (a surface steeper than 89°) heights and lateral size cannot belong together.
- **squeeze**: the distance at which the law's repulsion carries the stress of the contact, over the law's length. That
  stress is the deviation in full contact, of a half-space half of E* times the slope, or the applied pressure if that
  is larger. Atoms in contact stand at 0.9 to 1. Half the length takes stresses of 7000 times the law's peak (10-4
  law), and a contact distance then counts points as touching that carry nothing. Below 0.1 (4e11 times) it is no law
  for this modulus.
- **load** against E*: above 1 one of the two has the wrong unit.
- **table of a stiffness** against the waves of the grid, and its E* at the shortest of them against the material's.
- **peak over tolerance**: the law's largest tension against the residual stress that ``solver.tolerance`` leaves.

The models add what only they need.
"""

from collections.abc import Callable, Sequence

import numpy as np

from contact_study.inputs import units
from contact_study.inputs.errors import InputError
from contact_study.physics.laws.base import TractionLaw
from contact_study.physics.solids import Measured, contact_modulus_of
from contact_study.study.case import Case
from contact_study.study.checks.height_maps import map_warnings
from contact_study.study.checks.idle_keys import idle_keys
from contact_study.study.study import Study
from contact_study.study.sweep import points

STEEP, IMPOSSIBLY_STEEP = 1.0, 100.0
SQUEEZED, IMPOSSIBLY_SQUEEZED = 0.5, 0.1
# Fraction of a map's rms height or slope that a coarser grid may lose without a warning.
NEGLIGIBLE = 0.01
# Largest ratio of two contact moduli that are taken for one.
SAME_MODULUS = 2.0


# How far a case is beyond a criterion, in units of it, and the words before and after the part of the sweep that it is,
# of a warning and of an error.
_Judged = tuple[float, tuple[str, str], tuple[str, str] | None]


def review(study: Study) -> list[str]:
    """Check a study; return warnings, each once. Raises InputError if the numbers of a case cannot belong together."""
    cases, _ = study.cases, study.scales
    adhesive = [case for case in cases if case.law.attracts]
    tables = [case for case in cases if isinstance(case.solid, Measured)]
    return [
        *_worst(cases, _slope),
        *_worst(cases, _load),
        *_worst([case for case in adhesive if not case.law.has_wall], _softness),
        *_worst(adhesive, _residual),
        *_worst(tables, _table_waves, len(cases)),
        *_worst(tables, _table_modulus, len(cases)),
        *_coarse_maps(cases),
        *dict.fromkeys(line for case in cases for line in map_warnings(str(case.surface.map_path), case.scales)),
        *idle_keys(cases),
    ]


def _worst(cases: Sequence[Case], judge: Callable[[Case], _Judged], total: int = 0) -> list[str]:
    """One message on the worst of the cases beyond a criterion, with the part of the sweep that they are."""
    found = [(judged, case) for case in cases if (judged := judge(case))[0] > 1]
    if not found:
        return []
    (_, words, impossible), worst = max(found, key=lambda item: item[0][0])
    if impossible:
        raise InputError((f" at {worst.label}" if worst.label else "").join(impossible))
    return [points([case for _, case in found], total or len(cases)).join(words)]


def contact_stress(case: Case) -> float:
    """Stress that contacts carry (Pa): its deviation in full contact, or the applied pressure if larger."""
    return max(case.scales.full_contact_stress(case.solid), _applied(case))


def _applied(case: Case) -> float:
    return max(case.loading.path) if case.loading.control == "pressure" else 0.0


def squeeze(law: TractionLaw, stress: float) -> float:
    """Gap at which the law's repulsion carries a stress >= 0 (Pa), over its equilibrium distance."""
    return float(law.repulsive_gap(np.array(-stress))) / law.equilibrium_distance


def _slope(case: Case) -> _Judged:
    scale = case.scales
    impossible = (
        f"surface: heights of {scale.rms_height:.3g} m (root mean square) on a cell of {scale.size[0]:.3g} x "
        f"{scale.size[1]:.3g} m make an rms slope of {scale.rms_slope:.3g}",
        f"; beyond {IMPOSSIBLY_STEEP:g} the heights ({case.surface.height_key}) and surface.size cannot belong "
        "together",
    )
    words = (
        f"surface: rms slope {scale.rms_slope:.3g}",
        ": linear elasticity of a half-space is meant for slopes well below 1",
    )
    return scale.rms_slope / STEEP, words, impossible if scale.rms_slope > IMPOSSIBLY_STEEP else None


def _load(case: Case) -> _Judged:
    share = _applied(case) / case.solid.contact_modulus
    words = (
        f"loading.path: a pressure of {units.stress(_applied(case))} is {share:.2g} times the contact modulus, "
        f"{units.stress(case.solid.contact_modulus)}",
        "; are the units of loading.path and material.youngs_modulus right?",
    )
    return share, words, None


def _softness(case: Case) -> _Judged:
    pressed, stress = squeeze(case.law, contact_stress(case)), contact_stress(case)
    words = (
        f"interaction: against stresses of {stress:.3g} Pa the law's peak, {case.law.peak_tensile_stress:.3g} Pa, is "
        f"so weak that contacts are pressed to {pressed:.2g} of its length"
    )
    impossible = (
        '; use interaction.law = "hard_wall", or check work_of_adhesion (well_depth), well_depth_ratio and length'
    )
    harmless = ": interaction.contact_distance counts points as touching that carry next to nothing"
    excess = SQUEEZED / pressed if pressed > 0 else np.inf
    return excess, (words, harmless), (words, impossible) if pressed < IMPOSSIBLY_SQUEEZED else None


def _residual(case: Case) -> _Judged:
    left, peak = case.solver.tolerance * case.solid.contact_modulus, case.law.peak_tensile_stress
    words = (
        f"interaction: the law's peak, {peak:.3g} Pa, is below the residual stress that solver.tolerance leaves, "
        f"{left:.3g} Pa",
        ": adhesion is not resolved; use a smaller tolerance",
    )
    return 2.0 if peak < left else 0.0, words, None


def _table_waves(case: Case) -> _Judged:
    assert isinstance(case.solid, Measured)
    smallest, largest = case.solid.wavenumbers[0], case.solid.wavenumbers[-1]
    longest, shortest = (2 * np.pi / length for length in case.scales.grid_waves)
    missing = max(smallest / longest, shortest / largest) / 1.01  # tables of three digits may end at the waves
    words = (
        f"elasticity.path: the table holds waves of {smallest:.3g} to {largest:.3g} m^-1, the grid has waves of "
        f"{longest:.3g} to {shortest:.3g} m^-1",
        ": beyond the table E*(q) is taken to be constant; check elasticity.wavenumber_unit, surface.size and shape",
    )
    return missing, words, None


def _table_modulus(case: Case) -> _Judged:
    shortest = np.array(2 * np.pi / case.scales.grid_waves[1])
    modulus = float(contact_modulus_of(case.solid.stiffness(shortest), shortest))
    ratio = modulus / case.solid.contact_modulus
    words = (
        f"elasticity.path: at the grid's shortest wave the table's E* is {modulus:.3g} Pa, that of material, which "
        f"datasets quote and stresses are measured in, {case.solid.contact_modulus:.3g} Pa",
        ": check elasticity.stiffness_unit, or give the table's in material.youngs_modulus",
    )
    return max(ratio, 1 / ratio) / SAME_MODULUS, words, None


def _coarse_maps(cases: Sequence[Case]) -> list[str]:
    """Warn of each map that the continuum's grid cannot carry."""
    notes = {}
    for case in cases:
        scale = case.scales
        height, slope = scale.lost or (scale.rms_height, scale.rms_slope)
        if height < (1 - NEGLIGIBLE) * scale.rms_height or slope < (1 - NEGLIGIBLE) * scale.rms_slope:
            notes[case.surface.map_path, case.surface.shape] = (
                f"surface.shape = {list(scale.shape)} is coarser than the height map {case.surface.map_path}: waves "
                f"shorter than two grid spacings are left out, rms height {units.length(scale.rms_height)} becomes "
                f"{units.length(height)} ({_change(height, scale.rms_height)}), rms slope {scale.rms_slope:.4g} "
                f"becomes {slope:.4g} ({_change(slope, scale.rms_slope)})"
            )
    return list(notes.values())


def _change(left: float, whole: float) -> str:
    return f"{100 * (left / whole - 1):+.2g} %" if left < (1 - NEGLIGIBLE) * whole else "the same"
