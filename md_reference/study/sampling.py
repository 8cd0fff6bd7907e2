"""Thermal averages: at each point of the path the canonical distribution about its equilibrium at zero temperature."""

import dataclasses
from collections.abc import Iterator, Mapping

import numpy as np

from contact_study.physics.surfaces.surface import Surface
from contact_study.results.state import Ensemble, InterfaceState
from contact_study.study.case import Case
from md_reference.solution import Equilibrium, Outcome
from md_reference.statics.contact import AtomisticContact
from md_reference.study import quasi_static
from md_reference.study.system import Predictor, build_contact, interface_state
from md_reference.thermal.checkpoint import ChainState
from md_reference.thermal.equilibration import mean_load_missing
from md_reference.thermal.hmc import ThermalSampler

_LOWEST_ACCEPTANCE = 0.1


def solve_path(
    case: Case,
    surface: Surface,
    restart: Mapping[str, np.ndarray] | None = None,
    start: int = 0,
    predictor: Predictor | None = None,
) -> Iterator[InterfaceState | Ensemble]:
    """Thermal states about the quasi-static path, each point with random numbers of its own.

    Parameters
    ----------
    case, surface, predictor
        As :func:`md_reference.study.quasi_static.solve_path`.
    restart : mapping, optional
        Of the point before ``start``, or of a state of the point ``start`` itself.
    start : int, optional
        First point of the path to solve.

    Yields
    ------
    InterfaceState or Ensemble
        For each point from ``start`` on; a state where the surfaces are apart.
    """
    contact = build_contact(case, surface)

    def sampler_at(number: int) -> ThermalSampler:
        return ThermalSampler(
            contact.block,
            contact.interface,
            case.material.contact_modulus,
            case.atomistic.temperature,
            case.path[number][0],
            contact.control == "gap",
        )

    if restart is not None and "spectrum" in restart:
        chain = ChainState.unpack(restart)
        yield Ensemble(_states(case, contact, sampler_at(start), chain, case.path[start][0]))
        restart, start = {"state": chain.equilibrium}, start + 1
    for number, found in enumerate(quasi_static.states(case, contact, restart, start, predictor), start):
        if found.report.detached:
            yield found
            continue
        sampler = sampler_at(number)
        generator = np.random.Generator(np.random.PCG64([case.atomistic.random_seed, number]))
        state = sampler.equilibrated(sampler.start(found.restart["state"]), case.sampling.equilibration, generator)
        chain = ChainState(state, generator, found.restart["state"], found.report.converged)
        yield Ensemble(_states(case, contact, sampler, chain, case.path[number][0]))


def _states(
    case: Case, contact: AtomisticContact, sampler: ThermalSampler, chain: ChainState, target: float
) -> Iterator[InterfaceState]:
    while chain.sampler.trajectories < case.sampling.trajectories:
        chain.sampler = sampler.next(chain.sampler, chain.generator)
        state = _thermal_state(case, contact, sampler, chain, target)
        yield state
        if state.report.detached:
            return


def _thermal_state(
    case: Case, contact: AtomisticContact, sampler: ThermalSampler, chain: ChainState, target: float
) -> InterfaceState:
    displacement = sampler.displacement(chain.sampler)
    energy = contact.interface.evaluate(displacement, sampler.force)
    apart = not sampler.force.any()
    found = contact.solution(
        Equilibrium(
            displacement=displacement,
            force=sampler.force.copy(),
            residual=np.nan,
            outcome=Outcome.DETACHED if apart else Outcome.CONVERGED,
            iterations=chain.sampler.trajectories,
            force_evaluations=chain.sampler.evaluations,
            fft_pairs=float(chain.sampler.evaluations),  # each takes one pair
            elastic_energy=sampler.elastic_energy(chain.sampler),
            interaction_energy=energy,
        )
    )
    chain.pressures.append(float(np.mean(found.pressure)))
    count, rate = chain.sampler.trajectories, chain.sampler.accepted / chain.sampler.trajectories
    loaded, over = contact.control == "pressure", apart or count == case.sampling.trajectories
    state = interface_state(case, found)
    residual, missing = np.nan, ""
    if apart:
        residual = 0.0
    elif loaded and over:  # the report of the last state is the point's
        lacking, missing = mean_load_missing(np.array(chain.pressures), target)
        residual = lacking / case.material.contact_modulus
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
    return dataclasses.replace(state, report=report, restart={"state": chain.equilibrium} if over else chain.pack())
