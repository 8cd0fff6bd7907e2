"""The continuum model for a campaign, and its warnings of a study whose grid cannot resolve its law or layer."""

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from bem_adhesion.study.interface import adhesion_of
from bem_adhesion.study.overdamped import OverdampedContact
from bem_adhesion.study.path_in_time import path_in_time
from bem_adhesion.study.paths import path_of_equilibria
from contact_study.campaign.memory import in_words, most_points, on_grid
from contact_study.campaign.model import MODELS
from contact_study.inputs.errors import InputError
from contact_study.inputs.units import force, length, stress
from contact_study.physics import process_zone as zones
from contact_study.physics.process_zone import SHARE_OF_HEIGHT, longest_range, process_zone
from contact_study.physics.solids import Viscoelastic
from contact_study.physics.spheres.numbers import tabor_parameter
from contact_study.physics.surfaces.surface import Surface, SurfaceScales
from contact_study.results import overdamped_path
from contact_study.results.schema import heights_on
from contact_study.results.state import Ensemble, InterfaceState, Value
from contact_study.study.case import Case
from contact_study.study.study import Study
from contact_study.study.sweep import points

MODEL = MODELS["continuum"]

_COARSEST = 1e5  # grid spacing, over the longer of process zone and law's length, beyond which a study is refused
_SMALLEST_PART = 30  # grid spacings along a part of the surface below which it is no sample of the surface


def check(case: Case) -> None:
    """Raise InputError for a gap below zero, or for overdamped motion with options that it does not support."""
    case.require_gap()
    trigger, hardness = case.loading.trigger_force, case.material.hardness
    if trigger is not None and hardness is not None and trigger >= (most := hardness * case.nominal_area):
        raise InputError(
            f"loading.trigger_force = {force(trigger)}: material.hardness = {stress(hardness)} carries less than "
            f"{force(most)}; give a smaller force"
        )
    if case.solver.path == "overdamped":
        overdamped_path.check(case, "solver.path")
        if case.elasticity.boundary != "periodic":
            given = f'elasticity.boundary = "{case.elasticity.boundary}"'
            raise InputError(f'{given}: solver.path = "overdamped" is for periodic boundaries')
        if case.material.hardness is not None and case.law.attracts:
            raise InputError('material.hardness: solver.path = "overdamped" is elastic; leave one out')
        if case.loading.adaptive:
            raise InputError(
                'loading.adaptive = true: solver.path = "overdamped" follows the load steadily; leave one out'
            )


def constants(case: Case, surface: Surface) -> dict[str, Value]:
    """Return the constants of a path."""
    law, modulus = case.law, case.solid.contact_modulus
    zone = process_zone(modulus, law) / case.strongest_adhesion
    adhesion = {"peak_distance": law.peak_distance, "process_zone": zone} if law.attracts else {}
    work = adhesion_of(case, surface.grid) if case.output.fields else None
    return {
        "contact_modulus": modulus,
        "work_of_adhesion": law.work_of_adhesion,
        "equilibrium_distance": law.equilibrium_distance,
        "peak_tensile_stress": law.peak_tensile_stress,
        "contact_distance": case.contact_distance,
        "rms_height": surface.rms_height,
        "rms_slope": surface.rms_slope,
        "pixel": max(surface.grid.spacing),
        **adhesion,
        **({} if work is None else {"work_of_adhesion_map": work}),
        **(heights_on(surface.grid, surface.sampled) if case.output.fields else {}),
    }


def solve_path(
    case: Case, surface: Surface, restart: Mapping[str, np.ndarray] | None = None, start: int = 0
) -> Iterator[InterfaceState | Ensemble]:
    """Yield states from path point ``start`` on; ``restart`` is that of the one before, None for separation."""
    if case.solver.path == "overdamped" and case.law.attracts:  # without attraction no state depends on the path
        pace = overdamped_path.pace_of(case, surface.size)
        contact = OverdampedContact(case, surface, pace.allowed)
        return overdamped_path.solve_path(case, contact, pace, restart, start)
    if isinstance(case.solid, Viscoelastic):
        return path_in_time(case, surface, case.solid, restart, start)
    return path_of_equilibria(case, surface, restart, start)


def review(study: Study, scales: Sequence[SurfaceScales]) -> list[str]:
    """Return a line each if the grid does not resolve the law or a layer of some cases; errors as for the law."""
    notes, pairs = _unresolved_law(study, scales), zip(study.cases, scales, strict=True)
    thin = [(case, scale) for case, scale in pairs if case.solid.layer_thickness < scale.pixel]
    if not thin:
        return notes
    case, scale = max(thin, key=lambda item: item[1].pixel / item[0].solid.layer_thickness)
    return [
        *notes,
        f"the layer of {case.solid.layer_thickness:.3g} m is thinner than the grid spacing {scale.pixel:.3g} m"
        f"{points([case for case, _ in thin], len(study.cases))}: what happens at contact edges within a thickness is "
        "not resolved; use a finer surface.shape or a larger elasticity.thickness",
    ]


def _unresolved_law(study: Study, scales: Sequence[SurfaceScales]) -> list[str]:
    """Return a line if the grid does not resolve the law, with its softest wave; InputError if it is far too coarse."""
    unresolved = []
    for case, scale in zip(study.cases, scales, strict=True):
        if case.law.attracts:
            zone = process_zone(case.solid.softest_modulus(*scale.grid_waves), case.law) / case.strongest_adhesion
            if not zones.resolves(scale.pixel, zone):
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
    _, zone, case, scale = max(unresolved, key=lambda item: item[0])
    where = points([case for *_, case, _ in unresolved], len(study.cases))
    return [f"{zones.too_coarse(scale.pixel, zone, where)}; {_way_out(case, scale, zone)}"]


def _way_out(case: Case, scale: SurfaceScales, zone: float) -> str:
    """Advise on a process zone (m) not resolved: a longer JKR-like range, more points, or a part of the surface."""
    law, longest = case.law, 0.0
    with suppress(ValueError):  # flat, or not soft: "auto" has no range
        constants = scale.rms_curvature, scale.rms_height, case.solid.contact_modulus, law.work_of_adhesion
        longest = longest_range(*constants)
    resolved = zones.resolved_length(law, scale.pixel, zone)
    cost = _cost(case, scale, resolved)
    accepted = f'interaction.length = "{length(resolved)}" of the same work of adhesion ({cost})'
    if resolved <= longest:
        return f"{accepted} resolves it"
    reach = max(longest, law.length)
    zone *= (reach / law.length) ** 2
    y, x = zones.resolving_shape(scale.size, zone)
    needs = in_words(on_grid((y, x)))
    if y * x <= most_points():
        range_too, cost = "", ""
        if longest > law.length:
            range_too = f'interaction.length = "auto" ({length(reach)}) on '
            cost = f"; {_cost(case, scale, reach)}"
        return f"{range_too}surface.shape = [{y}, {x}] ({needs}{cost}) resolves it"
    # As a number: a part has another rms height, which would shorten "auto".
    this_range = f'interaction.length = "{length(reach)}"'
    options = []
    # In whole spacings, of which a crop may take one more.
    spacings = math.floor(0.9 * math.sqrt(most_points()) * zone / zones.POINTS_PER_PROCESS_ZONE / scale.pixel) - 1
    if spacings >= _SMALLEST_PART:
        widest = spacings * scale.pixel
        part = zones.resolving_shape((widest + scale.pixel, widest + scale.pixel), zone)
        options.append(
            f"take a part of the surface of up to {length(widest)} with {this_range} and surface.shape = {list(part)}"
        )
    if resolved < scale.rms_height:
        options.append(f"accept {accepted}")
    head = f"it cannot be resolved here: {this_range} on surface.shape = [{y}, {x}] needs {needs}"
    return "; ".join(filter(None, [head, ", or ".join(options)]))


def _cost(case: Case, scale: SurfaceScales, reach: float) -> str:
    """Describe an asperity's contact with another range (m) and the same work of adhesion."""
    if not scale.rms_curvature > 0:
        return "a flat surface's pull-off falls as its inverse"
    constants = (1 / scale.rms_curvature, case.solid.contact_modulus, case.law.work_of_adhesion)
    longer = replace(case.law, length=reach)
    before, after = (zones.sphere_pull_off(*constants, law.peak_tensile_stress) for law in (case.law, longer))
    change = 100 * (after / before - 1)
    share = reach / scale.rms_height
    blurred = f", {share:.2g} of the rms height" if share > SHARE_OF_HEIGHT * (1 + 1e-9) else ""
    return f"Tabor parameter {tabor_parameter(*constants, reach):.2g}, a sphere's pull-off {change:+.2g} %{blurred}"
