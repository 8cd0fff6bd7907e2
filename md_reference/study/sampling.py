"""Thermal averages: at each point of the path the canonical distribution about its equilibrium at zero temperature."""

import dataclasses
from collections.abc import Iterator

import numpy as np

from contact_study.physics.surfaces.surface import Surface
from contact_study.results.state import Ensemble, InterfaceState
from contact_study.study.case import Case
from md_reference.solution import Outcome
from md_reference.statics.contact import AtomisticContact
from md_reference.study.cold import equilibria
from md_reference.study.system import Predictor, Restart, States, build_contact, interface_state
from md_reference.thermal.checkpoint import ChainState
from md_reference.thermal.equilibration import mean_load_missing
from md_reference.thermal.hmc import ThermalSampler

_LOWEST_ACCEPTANCE = 0.1  # below which a point counts as not converged


def solve_path(case: Case, surface: Surface, restart: Restart, start: int, predictor: Predictor) -> States:
    """Yield thermal states about the quasi-static path, each point with independent random numbers.

    A point where the surfaces are apart has one state.
    """
    contact = build_contact(case, surface)
    if restart is not None and "spectrum" in restart:
        chain = ChainState.unpack(restart)
        yield Ensemble(_Sampling(case, contact, start).states(chain))
        restart, start = {"state": chain.equilibrium}, start + 1
    for number, found in enumerate(equilibria(case, contact, restart, start, predictor), start):
        if found.report.detached:
            yield found
            continue
        sampling = _Sampling(case, contact, number)
        yield Ensemble(sampling.states(sampling.begin(found)))


class _Sampling:
    """Sampling of one point of a case's path."""

    def __init__(self, case: Case, contact: AtomisticContact, number: int):
        self._case = case
        self._contact = contact
        self._number = number
        self._target = case.path[number][0]
        self._loaded = contact.control == "pressure"
        temperature, modulus = case.atomistic.temperature, case.material.contact_modulus
        self._sampler = ThermalSampler(
            contact.block, contact.interface, modulus, temperature, self._target, not self._loaded
        )

    def begin(self, cold: InterfaceState) -> ChainState:
        """Return an equilibrated chain that begins at an equilibrium at zero temperature."""
        case, state = self._case, cold.restart["state"]
        generator = np.random.Generator(np.random.PCG64([case.atomistic.random_seed, self._number]))
        sampler = self._sampler
        equilibrated = sampler.equilibrated(sampler.start(state), case.sampling.equilibration, generator)
        return ChainState(equilibrated, generator, state, cold.report.converged)

    def states(self, chain: ChainState) -> Iterator[InterfaceState]:
        """Yield the states of a chain to the end of the point, or until the block is torn off."""
        while chain.sampler.trajectories < self._case.sampling.trajectories:
            chain.sampler = self._sampler.next(chain.sampler, chain.generator)
            state = self._state(chain)
            yield state
            if state.report.detached:
                return

    def _state(self, chain: ChainState) -> InterfaceState:
        sampler, found = self._sampler, chain.sampler
        displacement = sampler.displacement(found)
        energy = self._contact.interface.evaluate(displacement, sampler.force)
        apart = not sampler.force.any()
        solution = self._contact.energy.solution(
            displacement,
            sampler.force,
            Outcome.DETACHED if apart else Outcome.CONVERGED,
            np.nan,
            sampler.elastic_energy(found),
            energy,
            iterations=found.trajectories,
            force_evaluations=found.evaluations,
            fft_pairs=float(found.evaluations),  # each takes one
        )
        chain.pressures.append(float(np.mean(solution.pressure)))
        over = apart or found.trajectories == self._case.sampling.trajectories
        state = interface_state(self._case, solution)
        rate = found.accepted / found.trajectories
        residual, missing = 0.0 if apart else np.nan, ""
        if self._loaded and over and not apart:  # the report of the last state is the point's
            lacking, missing = mean_load_missing(np.array(chain.pressures), self._target)
            residual = lacking / self._case.material.contact_modulus
        message = state.report.message
        if not chain.converged:
            message = "the equilibrium at zero temperature that the sampling starts from was not reached"
        elif rate < _LOWEST_ACCEPTANCE:
            message = f"only {rate:.2g} of the proposals were taken: raise sampling.equilibration"
        elif missing:
            message = f"{missing}: raise sampling.trajectories or sampling.equilibration"
        report = dataclasses.replace(
            state.report,
            residual=residual,
            converged=apart or (chain.converged and rate >= _LOWEST_ACCEPTANCE and not missing),
            acceptance_rate=rate,
            message=message,
        )
        restart = {"state": chain.equilibrium} if over else chain.pack()
        return dataclasses.replace(state, report=report, restart=restart)
