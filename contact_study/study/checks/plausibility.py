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

Of measured maps see :mod:`contact_study.study.checks.height_maps`.

The models add what only they need: see ``review`` in their ``run.py``.
"""

from collections.abc import Sequence

import numpy as np

from contact_study import units
from contact_study.errors import InputError
from contact_study.physics.laws.base import TractionLaw
from contact_study.physics.solids import Measured, contact_modulus_of
from contact_study.physics.surfaces.scales import SurfaceScales
from contact_study.study.case import Case
from contact_study.study.checks.height_maps import map_warnings
from contact_study.study.checks.idle_keys import idle_keys
from contact_study.study.study import Study
from contact_study.study.sweep import points

STEEP, IMPOSSIBLY_STEEP = 1.0, 100.0
SQUEEZED, IMPOSSIBLY_SQUEEZED = 0.5, 0.1
# Part of a map's rms height or slope that a coarser grid may lose without a word.
NEGLIGIBLE = 0.01
# Largest ratio of two contact moduli that are one in other words.
SAME_MODULUS = 2.0


def review(study: Study) -> list[str]:
    """Check a study; return warnings for the user, each once.

    Raises
    ------
    InputError
        If the numbers of some case cannot belong together.
    """
    pairs = list(zip(study.cases, study.scales, strict=True))
    adhesive = [(case, scale, case.law) for case, scale in pairs if case.law.attracts]
    notes = _slopes(pairs)
    notes += _loads(study.cases)
    notes += _squeezes([item for item in adhesive if not item[2].has_wall])
    notes += _peaks(adhesive)
    notes += _missing_waves(pairs)
    notes += _other_moduli(pairs)
    notes += _maps(pairs)
    notes += dict.fromkeys(line for case, scale in pairs for line in map_warnings(str(case.surface.map_path), scale))
    notes += idle_keys(study.cases)
    return notes


def contact_stress(case: Case, scales: SurfaceScales) -> float:
    """Stress that contacts carry (Pa): its deviation in full contact, or the applied pressure if larger."""
    applied = max(case.loading.path) if case.loading.control == "pressure" else 0.0
    return max(scales.full_contact_stress(case.solid), applied)


def squeeze(law: TractionLaw, stress: float) -> float:
    """Gap at which the law's repulsion carries a stress >= 0 (Pa), over its equilibrium distance."""
    return float(law.repulsive_gap(np.array(-stress))) / law.equilibrium_distance


def _slopes(pairs: list[tuple[Case, SurfaceScales]]) -> list[str]:
    steep = [(scale.rms_slope, case, scale) for case, scale in pairs if scale.rms_slope > STEEP]
    if not steep:
        return []
    slope, case, scale = max(steep, key=lambda item: item[0])
    if slope > IMPOSSIBLY_STEEP:
        raise InputError(
            f"surface: heights of {scale.rms_height:.3g} m (root mean square) on a cell of {scale.size[0]:.3g} x "
            f"{scale.size[1]:.3g} m make an rms slope of {slope:.3g}{_at(case)}; beyond {IMPOSSIBLY_STEEP:g} the "
            f"heights ({case.surface.height_key}) and surface.size cannot belong together"
        )
    where = points([case for _, case, _ in steep], len(pairs))
    return [
        f"surface: rms slope {slope:.3g}{where}: linear elasticity of a half-space is meant for slopes well below 1"
    ]


def _loads(cases: Sequence[Case]) -> list[str]:
    """Warn of pressures above the contact modulus, which no elastic solid carries at small strains."""
    pressed = [case for case in cases if case.loading.control == "pressure"]
    heavy = [case for case in pressed if max(case.loading.path) > case.solid.contact_modulus]
    if not heavy:
        return []
    case = max(heavy, key=lambda case: max(case.loading.path) / case.solid.contact_modulus)
    pressure, modulus = max(case.loading.path), case.solid.contact_modulus
    return [
        f"loading.path: a pressure of {units.stress(pressure)} is {pressure / modulus:.2g} times the contact modulus, "
        f"{units.stress(modulus)}{points(heavy, len(cases))}; are the units of loading.path and "
        "material.youngs_modulus right?"
    ]


def _squeezes(adhesive: list[tuple[Case, SurfaceScales, TractionLaw]]) -> list[str]:
    found = [(squeeze(law, contact_stress(case, scale)), case, scale, law) for case, scale, law in adhesive]
    weak = [item for item in found if item[0] < SQUEEZED]
    if not weak:
        return []
    smallest, case, scale, law = min(weak, key=lambda item: item[0])
    words = (
        f"interaction: against stresses of {contact_stress(case, scale):.3g} Pa the law's peak, "
        f"{law.peak_tensile_stress:.3g} Pa, is so weak that contacts are pressed to {smallest:.2g} of its length"
    )
    if smallest < IMPOSSIBLY_SQUEEZED:
        raise InputError(
            f'{words}{_at(case)}; use interaction.law = "hard_wall", or check work_of_adhesion (well_depth), '
            "well_depth_ratio and length"
        )
    where = points([case for _, case, *_ in weak], len(adhesive))
    return [f"{words}{where}: interaction.contact_distance counts points as touching that carry next to nothing"]


def _peaks(adhesive: list[tuple[Case, SurfaceScales, TractionLaw]]) -> list[str]:
    lost = [
        case
        for case, _, law in adhesive
        if law.peak_tensile_stress < case.solver.tolerance * case.solid.contact_modulus
    ]
    if not lost:
        return []
    case = lost[0]
    residual = case.solver.tolerance * case.solid.contact_modulus
    return [
        f"interaction: the law's peak, {case.law.peak_tensile_stress:.3g} Pa, is below the residual stress that "
        f"solver.tolerance leaves, {residual:.3g} Pa{points(lost, len(adhesive))}: adhesion is not resolved; use a "
        "smaller tolerance"
    ]


def _waves(scale: SurfaceScales) -> tuple[float, float]:
    """Wavenumbers of the longest and of the shortest wave along an axis of the grid (1/m)."""
    longest, shortest = scale.grid_waves
    return 2 * np.pi / longest, 2 * np.pi / shortest


def _missing_waves(pairs: list[tuple[Case, SurfaceScales]]) -> list[str]:
    """Warn of a table of the stiffness that leaves out waves of the grid."""
    found = []
    for case, scale in pairs:
        if isinstance(case.solid, Measured):
            table, grid = (float(case.solid.wavenumbers[0]), float(case.solid.wavenumbers[-1])), _waves(scale)
            missing = max(table[0] / grid[0], grid[1] / table[1])
            if missing > 1.01:  # tables written with three digits may end at the waves themselves
                found.append((missing, case, table, grid))
    if not found:
        return []
    _, case, table, grid = max(found, key=lambda item: item[0])
    return [
        f"elasticity.path: the table holds waves of {table[0]:.3g} to {table[1]:.3g} m^-1, the grid has waves of "
        f"{grid[0]:.3g} to {grid[1]:.3g} m^-1{points([case for _, case, *_ in found], len(pairs))}: beyond the table "
        "E*(q) is taken to be constant; check elasticity.wavenumber_unit, surface.size and shape"
    ]


def _other_moduli(pairs: list[tuple[Case, SurfaceScales]]) -> list[str]:
    """Warn of a table of the stiffness that differs from the material at the grid's shortest wave."""
    found = []
    for case, scale in pairs:
        if isinstance(case.solid, Measured):
            shortest = np.array(_waves(scale)[1])
            modulus = float(contact_modulus_of(case.solid.stiffness(shortest), shortest))
            ratio = modulus / case.solid.contact_modulus
            if max(ratio, 1 / ratio) > SAME_MODULUS:
                found.append((max(ratio, 1 / ratio), case, modulus))
    if not found:
        return []
    _, case, modulus = max(found, key=lambda item: item[0])
    return [
        f"elasticity.path: at the grid's shortest wave the table's E* is {modulus:.3g} Pa, that of material, which "
        f"datasets quote and stresses are measured in, {case.solid.contact_modulus:.3g} Pa"
        f"{points([case for _, case, _ in found], len(pairs))}: check elasticity.stiffness_unit, or give the table's "
        "in material.youngs_modulus"
    ]


def _maps(pairs: list[tuple[Case, SurfaceScales]]) -> list[str]:
    """Warn of each map that the continuum's grid cannot carry."""
    notes = {}
    for case, scale in pairs:
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


def _at(case: Case) -> str:
    return f" at {case.label}" if case.label else ""
