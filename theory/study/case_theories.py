"""The theories of a case: the spectra that they use, and the curves that all points of its path share."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.physics.roughness.spectrum import RoughnessSpectrum
from contact_study.physics.surfaces.surface import Surface
from contact_study.results.schema import SPECTRUM_MARK
from contact_study.study.case import Case
from theory.edge_flow.apparent_adhesion import (
    AREA_ERRORS,
    LARGEST_SIMULATED,
    adhesion_ratio,
    apparent_adhesion,
    stronger,
)
from theory.edge_flow.flow import EDGE_FLOW_GAPS, EDGE_FLOW_SCALES, EdgeFlow, edge_flow
from theory.gap_flow.flow import BRANCHES, GAP_FLOW_GAPS, GAP_FLOW_SCALES, GapFlow, gap_flow
from theory.gap_flow.state import GapState
from theory.numerics.background import BackgroundExecutor, BackgroundTask
from theory.persson.separation import TOLERANCE, NotConverged
from theory.persson.theory import PerssonTheory

# Smallest tolerance of σ_a over the full-contact stress, and reach of the edge flow's curve over the highest pressure.
_FINEST_TOLERANCE, _RESERVE = 1e-11, 1.1

_kept: list[Any] = []  # the last case, its surface and its theories


@dataclass(frozen=True)
class CaseTheories:
    """The theories of a case with one spectrum."""

    case: Case
    spectrum: RoughnessSpectrum
    other: str = ""  # the spectrum's name in the study where it is not the first one
    coarsening: int = 1  # divisor of the default nodes, cells and scales
    ahead: BackgroundExecutor = field(default_factory=lambda: BackgroundExecutor(1))  # that may begin with the flows

    def named(self, quantity: str) -> str:
        """The name of a theory's quantity, ``"gap_flow/mean_gap"``, with the spectrum where that is not the first."""
        theory, _, rest = quantity.partition("/")
        return f"{theory}{SPECTRUM_MARK}{self.other}/{rest}" if self.other else quantity

    @contextmanager
    def naming_the_spectrum(self) -> Iterator[None]:
        """Prefix warnings with the name of the spectrum, if the case has several."""
        with warnings.catch_warnings(record=True) as caught:
            yield
        kinds = self.case.spectra
        prefix = f'spectrum "{self.other or kinds[0]}": ' if len(kinds) > 1 else ""
        for item in caught:
            warnings.warn(f"{prefix}{item.message}", item.category, stacklevel=3)

    @cached_property
    def persson(self) -> PerssonTheory:
        """Persson's theory with the choices of the case."""
        chosen, law = self.case.theory, self.case.law
        choices = chosen.energy_weight, chosen.beta, chosen.true_area, chosen.alpha
        cap = law.peak_tensile_stress if chosen.cap_detachment_stress else np.inf
        resolution = PerssonTheory.nodes // self.coarsening, PerssonTheory.cells // self.coarsening
        return PerssonTheory(self.spectrum, self.case.solid, law.work_of_adhesion, *choices, cap, *resolution)

    @property
    def effort(self) -> tuple[float, int]:
        """Tolerance, over the full-contact stress where ``solver.tolerance`` is over E*, and most iterations."""
        asked = self.case.solver.tolerance * self.persson.solid.contact_modulus / self.persson.stress_scale
        return float(np.clip(asked, _FINEST_TOLERANCE, TOLERANCE)), self.case.solver.max_iterations

    @cached_property
    def gap_flows(self) -> tuple[GapFlow, ...]:
        """The gap flow in each branch; none for laws with a hard wall, and where the study asks for none."""
        flows = tuple(begun.result() for begun in self._gap_flows_begun)
        for flow in flows:
            if not flow.converged:
                lost = f"{flow.unconverged_steps} of {flow.steps} steps of the roughness"
                warnings.warn(f"gap flow, {flow.branch}: {lost} did not converge", NotConverged, stacklevel=2)
        return flows

    @cached_property
    def _gap_flows_begun(self) -> tuple[BackgroundTask[GapFlow], ...]:
        case = self.case
        if case.law.has_wall or not case.theory.has("gap_flow"):
            return ()
        by_gap = case.loading.control == "gap"
        largest = max(gap for gap, _ in case.path) + case.law.equilibrium_distance if by_gap else 0.0
        gaps, scales = GAP_FLOW_GAPS // self.coarsening, GAP_FLOW_SCALES // self.coarsening
        return tuple(
            self.ahead.begin(partial(gap_flow, self.spectrum, case.solid, case.law, branch, largest, gaps, scales))
            for branch in BRANCHES
        )

    @cached_property
    def gap_flow_states(self) -> tuple[BackgroundTask[list[GapState | None]], ...]:
        """States of each branch along the path, None where none carries the pressure; may raise an InputError."""
        return tuple(self.ahead.begin(partial(_states_along, self.case, begun)) for begun in self._gap_flows_begun)

    @cached_property
    def edge_flows(self) -> tuple[EdgeFlow, ...]:
        """The edge flow's branches as far as the path needs them, if the study asks; InputError beyond contact."""
        try:
            flows = tuple(begun.result() for begun in self._edge_flows_begun)
        except ValueError as error:
            raise InputError(_too_close(self.case, str(error).rpartition(": ")[2])) from None
        return (flows[0], replace(flows[-1], branch="unloading")) if flows else ()

    @cached_property
    def apparent_adhesion(self) -> float:
        """Work of adhesion on unloading over that on loading."""
        with self.naming_the_spectrum():
            return apparent_adhesion(self.spectrum, self.case.solid, self.case.law)

    def area_error(self, branch: str) -> float:
        """Relative error of the edge flow's area in the atlas; NaN beyond all simulated loops."""
        return AREA_ERRORS[branch] if self.apparent_adhesion <= adhesion_ratio(LARGEST_SIMULATED) else np.nan

    @cached_property
    def _edge_flows_begun(self) -> tuple[BackgroundTask[EdgeFlow], ...]:
        """The curves of both branches, or one where they are the same."""
        case = self.case
        if case.law.has_wall or not case.theory.has("edge_flow"):
            return ()
        ratio = self.apparent_adhesion
        laws = (case.law, stronger(case.law, ratio)) if ratio > 1 else (case.law,)
        asked = np.array([value for value, _ in case.path])
        nodes, scales = EDGE_FLOW_GAPS // self.coarsening, EDGE_FLOW_SCALES // self.coarsening
        flow = partial(edge_flow, self.spectrum, case.solid, gaps=nodes, scales=scales)
        if case.loading.control == "pressure":
            # Up to nearly full contact: beyond the pull-off, wherever that is.
            stress = np.sqrt(self.spectrum.full_contact_stress_variance(case.solid.stiffness))
            flow = partial(flow, highest_pressure=max(_RESERVE * asked.max(), float(stress)))
        else:
            reached = asked + case.law.equilibrium_distance
            farthest, closest = float(reached.max()), float(reached.min())
            flow = partial(flow, highest_pressure=0.0, largest_gap=farthest, smallest_gap=closest)
        # Threads do not warn: the law of unloading is made here.
        return tuple(self.ahead.begin(partial(flow, law=law)) for law in laws)


def _states_along(case: Case, begun: BackgroundTask[GapFlow]) -> list[GapState | None]:
    flow = begun.result()
    try:
        if case.loading.control == "pressure":
            gaps = np.array([flow.gap_at(pressure) for pressure, _ in case.path])
        else:
            gaps = np.array([value + case.law.equilibrium_distance for value, _ in case.path])
        held = np.isfinite(gaps)
        states = iter(flow.states(gaps[held]))
    except ValueError as error:
        raise InputError(f"loading.path: {error}") from None
    return [next(states) if there else None for there in held]


def _too_close(case: Case, limit: str) -> str:
    """The message about a path that presses the surfaces closer than a flow's nodes, in the unit of the path."""
    unit, size = case.loading.unit
    if case.loading.control == "pressure":
        asked, instead = f"{max(case.loading.path) / size:g} {unit}", "lower pressures"
    else:
        asked = f"a mean gap of {min(case.loading.path) / size:g} {unit} beyond equilibrium"
        instead = f"larger ones, equilibrium being at {case.law.equilibrium_distance:.6g} m"
    return f"loading.path: {asked} presses the surfaces closer than the edge flow follows ({limit}); give {instead}"


def case_theories(case: Case, surface: Surface) -> tuple[CaseTheories, ...]:
    """The theories of a case for each spectrum, kept until another case or surface follows."""
    if not (_kept and _kept[0] is case and _kept[1] is surface):
        ahead = BackgroundExecutor(case.solver.threads)
        every = tuple(
            CaseTheories(case, roughness(case, surface, kind), kind if number else "", ahead=ahead)
            for number, kind in enumerate(case.spectra)
        )
        _kept[:] = case, surface, every
        for theories in every:  # the flows in other threads, the longest first
            theories._edge_flows_begun, theories.gap_flow_states  # noqa: B018
    return _kept[2]


def roughness(case: Case, surface: Surface, kind: str) -> RoughnessSpectrum:
    """The roughness of one kind of spectrum of a case; InputError if a height map is flat."""
    if kind == "table":
        return case.theory.table()
    if kind == "analytic" and surface.spectrum is not None:
        return surface.spectrum
    try:
        return surface.measured_spectrum()
    except ValueError as error:
        raise InputError(f"surface: {error}") from None
