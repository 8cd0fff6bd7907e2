"""Warnings of a study before it runs: implausible values, suspicious height maps, keys without effect."""

import dataclasses
from collections.abc import Callable, Sequence

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.inputs.units import length, stress
from contact_study.physics.height_maps.height_map import WIDEST
from contact_study.physics.laws.base import TractionLaw
from contact_study.physics.roughness.statistics import Roughness, SelfAffineFit
from contact_study.physics.solids import Measured, Viscoelastic, contact_modulus_of
from contact_study.physics.surfaces.surface import SurfaceScales
from contact_study.study.case import Case
from contact_study.study.schema.loading import LoadingSection
from contact_study.study.study import Study
from contact_study.study.sweep import points

# Linear elasticity is an expansion in the rms slope; beyond 89° heights and lateral size cannot belong together.
STEEP, IMPOSSIBLY_STEEP = 1.0, 100.0
# Distance at which the law's repulsion carries the stress of contacts, over its length; atoms stand at 0.9 to 1. Half
# of the length takes 7000 times the peak of the 10-4 law, a tenth 4e11 times.
SQUEEZED, IMPOSSIBLY_SQUEEZED = 0.5, 0.1
# Fraction of a map's rms height or slope that a coarser grid may lose without a warning.
NEGLIGIBLE = 0.01
# Largest ratio of two contact moduli that are taken for one.
SAME_MODULUS = 2.0
# Jump of heights across an edge over that from line to line: 1 where periodic, rarely above 2, tens in a map cut out.
JUMP = 4.0
# Limits of rms heights (m) and of the slope outside of which a unit was taken for another.
HEIGHTS, FLATTEST = (1e-12, 1e-3), 1e-4
# Power of q above which short waves are noise of single points (self-affine ones have -2 or less), and their share.
NOISE_POWER, NOISE_SHARE = -1.0, 0.1

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
        *dict.fromkeys(line for case in cases for one in case.measured_maps for line in map_warnings(*one)),
        *_open_edges(cases),
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
        f"; beyond {IMPOSSIBLY_STEEP:g} the heights ({case.geometry.height_key}) and surface.size cannot belong "
        "together",
    )
    harmless = ": linear elasticity of a half-space is meant for slopes well below 1"
    words = f"surface: rms slope {scale.rms_slope:.3g}", harmless
    return scale.rms_slope / STEEP, words, impossible if scale.rms_slope > IMPOSSIBLY_STEEP else None


def _load(case: Case) -> _Judged:
    applied, modulus = _applied(case), case.solid.contact_modulus
    share = f"is {applied / modulus:.2g} times the contact modulus, {stress(modulus)}"
    doubt = "; are the units of loading.path and material.youngs_modulus right?"
    return applied / modulus, (f"loading.path: a pressure of {stress(applied)} {share}", doubt), None


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
    weak = f"interaction: the law's peak, {peak:.3g} Pa, is below the residual stress that solver.tolerance leaves"
    words = f"{weak}, {left:.3g} Pa", ": adhesion is not resolved; use a smaller tolerance"
    return 2.0 if peak < left else 0.0, words, None


def _table_waves(case: Case) -> _Judged:
    assert isinstance(case.solid, Measured)
    smallest, largest = case.solid.wavenumbers[0], case.solid.wavenumbers[-1]
    longest, shortest = (2 * np.pi / wave for wave in case.scales.grid_waves)
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
    for case, (path, scale) in ((one, own) for one in cases for own in one.measured_maps):
        height, slope = scale.lost or (scale.rms_height, scale.rms_slope)
        if height < (1 - NEGLIGIBLE) * scale.rms_height or slope < (1 - NEGLIGIBLE) * scale.rms_slope:
            notes[path, case.scales.shape] = (
                f"surface.shape = {list(case.scales.shape)} is coarser than the height map {path}: waves "
                f"shorter than two grid spacings are left out, rms height {length(scale.rms_height)} becomes "
                f"{length(height)} ({_change(height, scale.rms_height)}), rms slope {scale.rms_slope:.4g} "
                f"becomes {slope:.4g} ({_change(slope, scale.rms_slope)})"
            )
    return list(notes.values())


def _open_edges(cases: Sequence[Case]) -> list[str]:
    """Warn of a form that jumps where its cell is repeated."""
    found = {}
    for case in cases:
        form = case.form.made(case.scales.size, case.scales.shape) if case.elasticity.boundary == "periodic" else None
        if form is not None and form.edge_jump > NEGLIGIBLE * case.scales.peak_to_valley:
            found[case.form] = (
                f"form: heights of the {case.form.kind} jump by {length(form.edge_jump)} across the edges of the cell, "
                'which is repeated; use elasticity.boundary = "free", or no offset, rotation and tilt'
            )
    return list(found.values())


def _change(left: float, whole: float) -> str:
    return f"{100 * (left / whole - 1):+.2g} %" if left < (1 - NEGLIGIBLE) * whole else "the same"


def described(roughness: Roughness) -> list[str]:
    """Describe a surface, repeated and alone (without the edges of a map), in a few lines."""
    grid, sample, fit = roughness.grid, roughness.sample, roughness.sample.fit
    lines = [
        f"{grid.shape[0]} x {grid.shape[1]} points, spacing {length(*grid.spacing)}, size {length(*grid.size)} "
        f"(y, x), {100 * roughness.filled:.3g} % filled",
        f"h_rms {length(roughness.rms_height)}, rms slope {sample.rms_slope:.4g}, rms curvature "
        f"{sample.rms_curvature:.4g} 1/m, jump at the edges {length(roughness.edge_jump)} "
        f"({roughness.edge_ratio:.3g} times that of neighbouring lines)",
    ]
    if fit is not None:
        long, short = (length(2 * np.pi / q) for q in (fit.roll_off, fit.cutoff))
        lines.append(f"spectrum: {law_in_words(fit)} between wavelengths of {long} and {short}")
    return lines


def law_in_words(fit: SelfAffineFit) -> str:
    """Write the Hurst exponent of a law with its uncertainty, or the power of q of one that is not self-affine."""
    hurst, error = fit.hurst_exponent, fit.uncertainty
    if hurst + error >= 0 and hurst - error <= 1:
        return f"Hurst exponent {hurst:.2f} ± {error:.2f}"
    how = "steeper, as of filtered surfaces" if hurst > 1 else "flatter, as of noise"
    return f"C falls as q^{-2 - 2 * hurst:.1f} ± {2 * error:.1f}, {how}, than any self-affine surface's,"


def map_warnings(path: str, scales: SurfaceScales) -> list[str]:
    """Warn of a measured map that looks wrong; each line says what to do."""
    found = scales.measured
    if found is None:
        return []
    sample, notes, strange = found.sample, [], []
    if found.rms_height and not HEIGHTS[0] <= found.rms_height <= HEIGHTS[1]:
        strange.append(f"rms heights of {found.rms_height:.3g} m")
    if max(scales.size) > WIDEST:
        strange.append(f"a cell of {length(*scales.size)}")
    if 0 < sample.rms_slope < FLATTEST:
        strange.append(f"an rms slope of {sample.rms_slope:.2g}")
    if strange:
        notes.append(
            f"surface: {path} has {' and '.join(strange)}; are its units right (heights in {scales.unit}, cell of "
            f"{length(*scales.size)})?"
        )
    if found.edge_ratio > JUMP:
        notes.append(
            f"surface: the edges of {path} do not meet: heights jump by {length(found.edge_jump)} across them, "
            f"{found.edge_ratio:.3g} times as much as between neighbouring lines, and repeated the map has an rms "
            f'slope of {scales.rms_slope:.3g} in place of {sample.rms_slope:.3g}; surface.detrend = "tilt" and '
            'surface.edges = "mirror" or "window" join them'
        )
    power, share = sample.noise
    if power > NOISE_POWER and share > NOISE_SHARE:
        notes.append(
            f"surface: {path} has the spectrum of noise in single points (q^{power:.2g} below four of them), which "
            f"makes {100 * share:.0f} % of the mean square slope; surface.lowpass = "
            f'"{length(4 * max(found.grid.spacing))}" would leave it out'
        )
    return notes


def describe_maps(cases: Sequence[Case]) -> list[str]:
    """Describe each measured map of a study as it was read, each once."""
    words = (
        f"surface {path}: {line}"
        for case in cases
        for path, scales in case.measured_maps
        if scales.measured is not None
        for line in described(scales.measured)
    )
    return list(dict.fromkeys(words))


def idle_keys(cases: Sequence[Case]) -> list[str]:
    """One line for each reason why keys of some cases are without effect."""
    names, notes = ("work_of_adhesion", "well_depth", "length", "contact_distance"), []
    walls = [case.interaction for case in cases if case.law.bare_wall]
    without = [f"interaction.{name}" for name in names if any(getattr(wall, name) is not None for wall in walls)]
    if without:
        why = f'where interaction.law = "{walls[0].law}", which neither attracts nor reaches'
        notes.append(f"{', '.join(without)}: without effect {why}")
    viscoelastic = 'elasticity.kind = "viscoelastic"'
    for said, is_used, belongs in (
        (
            "adaptive = true",
            lambda case: case.law.attracts or isinstance(case.solid, Viscoelastic),
            f"laws that attract, or {viscoelastic}",
        ),
        ("resolution", lambda case: case.loading.adaptive, "loading.adaptive = true"),
        (
            "time_steps",
            lambda case: isinstance(case.solid, Viscoelastic) and not case.loading.adaptive,
            f"{viscoelastic} without loading.adaptive",
        ),
    ):
        name = said.partition(" ")[0]
        default = getattr(LoadingSection, name)
        idle = [case for case in cases if getattr(case.loading, name) != default and not is_used(case)]
        if idle:
            notes.append(f"loading.{said}: without effect{points(idle, len(cases))}; it belongs to {belongs}")
    return notes


def idle_motion(cases: Sequence[Case]) -> list[str]:
    """One line for each way of motion whose keys are given and that no case goes; several may be compared."""
    notes = []
    for section in ("overdamped", "sampling", "dynamics"):
        if any(section in (case.atomistic.method, case.solver.path) for case in cases):
            continue
        belongs = f'atomistic.method{" or solver.path" if section == "overdamped" else ""} = "{section}"'
        given = [getattr(case, section) for case in cases]
        names = [
            f"{section}.{field.name}"
            for field in dataclasses.fields(given[0])
            if any(getattr(one, field.name) != field.default for one in given)
        ]
        if names:
            notes.append(f"{', '.join(names)}: without effect; it belongs to {belongs}")
    return notes
