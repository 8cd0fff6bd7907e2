"""Where the grid of a study cannot resolve its law or layer, each said in one line for the whole study."""

import math
from collections.abc import Sequence
from dataclasses import replace

from scipy.fft import next_fast_len

from bem_adhesion.multilevel import POINTS_PER_PROCESS_ZONE, process_zone
from contact_study.campaign.memory import grid_fits
from contact_study.problem.case import Case
from contact_study.problem.errors import InputError
from contact_study.problem.study import Study
from contact_study.problem.surface_scales import SurfaceScales
from contact_study.problem.sweep import points
from contact_study.problem.tabor import JKR_LIKE, longest_range, tabor_parameter

# Grid spacing, in units of the longer of process zone and law's length, beyond which a study is refused: steps stop
# converging from some 1e3 on where roughness and cell grow together, rubber with an atomic law works at 5e3.
_COARSEST = 1e5


def review(study: Study, scales: Sequence[SurfaceScales]) -> list[str]:
    """Say where the grid cannot resolve law or layer, each in one line for the whole study; errors as for the law."""
    return _unresolved_law(study, scales) + _unresolved_layer(study, scales)


def _unresolved_layer(study: Study, scales: Sequence[SurfaceScales]) -> list[str]:
    """Below the grid spacing a layer's points hardly know of their neighbours: its edges, a depth wide, are lost."""
    pairs = zip(study.cases, scales, strict=True)
    thin = [(case, scale) for case, scale in pairs if case.solid.layer_thickness < scale.pixel]
    if not thin:
        return []
    case, scale = max(thin, key=lambda item: item[1].pixel / item[0].solid.layer_thickness)
    return [
        f"the layer of {case.solid.layer_thickness:.3g} m is thinner than the grid spacing {scale.pixel:.3g} m"
        f"{points([case for case, _ in thin], len(study.cases))}: what happens at contact edges within a thickness is "
        "not resolved; use a finer surface.shape or a larger elasticity.thickness"
    ]


def _unresolved_law(study: Study, scales: Sequence[SurfaceScales]) -> list[str]:
    """Where the grid cannot resolve the law.

    A grid coarser than a quarter of the process zone E*Δγ/σ_max² lets contact edges lock in to its points ("lattice
    trapping"): its hysteresis is then not the continuum's. E* is the least of
    the grid's waves: a bound, as a zone shorter than a stiff layer on a soft base feels the layer alone.

    Raises
    ------
    InputError
        If the grid is so coarse that law and surface have nothing to do with each other.
    """
    unresolved = []
    for case, scale in zip(study.cases, scales, strict=True):
        if case.law.attracts:
            zone = process_zone(_modulus(case, scale), case.law)
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


def _modulus(case: Case, scale: SurfaceScales) -> float:
    """E* of the wave of the grid for which the solid is softest (Pa)."""
    return case.solid.softest_modulus(*scale.grid_waves)


def _jkr_like(case: Case, scale: SurfaceScales, resolved: float) -> str:
    """Where a range that the grid resolves is too long, or may be longer: the longest that leaves JKR's contacts."""
    modulus, work = case.solid.contact_modulus, case.law.work_of_adhesion  # those of "auto"
    try:
        longest = longest_range(scale.rms_curvature, scale.rms_height, modulus, work)
    except ValueError:  # flat, or not soft
        return ""
    if longest <= case.law.length:
        return ""
    needed = _resolving(scale.size, process_zone(_modulus(case, scale), replace(case.law, length=longest)))
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
