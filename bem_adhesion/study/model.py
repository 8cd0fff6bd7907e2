"""The continuum model for a campaign."""

from collections.abc import Iterator, Mapping

import numpy as np

from bem_adhesion.study.checks import review
from bem_adhesion.study.overdamped import OverdampedContact
from bem_adhesion.study.paths import path_in_time, path_of_equilibria
from contact_study.campaign.model import MODELS
from contact_study.inputs.errors import InputError
from contact_study.physics.process_zone import process_zone
from contact_study.physics.solids import Viscoelastic
from contact_study.physics.surfaces.surface import Surface
from contact_study.results import overdamped_path
from contact_study.results.schema import heights_on
from contact_study.results.state import Ensemble, InterfaceState, Value
from contact_study.study.case import Case

__all__ = ["MODEL", "check", "constants", "review", "solve_path"]

MODEL = MODELS["continuum"]


def check(case: Case) -> None:
    """Raise InputError for a gap below zero, or for overdamped motion with options that it does not support."""
    case.require_gap()
    if case.solver.path == "overdamped":
        overdamped_path.check(case, "solver.path")
        if case.elasticity.boundary == "free":
            raise InputError('elasticity.boundary = "free": solver.path = "overdamped" is for periodic boundaries')
        if case.loading.adaptive:
            raise InputError(
                'loading.adaptive = true: solver.path = "overdamped" follows the load steadily; leave one out'
            )


def constants(case: Case, surface: Surface) -> dict[str, Value]:
    """Return the constants of a path."""
    law, modulus = case.law, case.solid.contact_modulus
    adhesion = {"peak_distance": law.peak_distance, "process_zone": process_zone(modulus, law)} if law.attracts else {}
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
