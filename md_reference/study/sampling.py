"""Thermal averages: at each point of the path the canonical distribution about its equilibrium at zero temperature."""

import dataclasses
from collections.abc import Iterator, Mapping

import numpy as np

from contact_study.errors import InputError
from contact_study.physics.surfaces.realisation import Surface
from contact_study.results.state import Ensemble, InterfaceState
from contact_study.study.case import Case
from md_reference.solution import Equilibrium, Outcome
from md_reference.statics.contact import AtomisticContact
from md_reference.statics.system import build_contact, interface_state
from md_reference.study import quasi_static
from md_reference.study.method import OTHER_VERSION, Predictor
from md_reference.thermal.equilibration import mean_load_missing
from md_reference.thermal.hmc import SamplerState, ThermalSampler
from md_reference.thermal.random_state import generator_of, packed

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
        chain = _Chain.unpacked(restart)
        yield Ensemble(_states(case, contact, sampler_at(start), chain, case.path[start][0]))
        restart, start = {"state": chain.equilibrium}, start + 1
    for number, found in enumerate(quasi_static.states(case, contact, restart, start, predictor), start):
        if found.report.detached:
            yield found
            continue
        sampler = sampler_at(number)
        generator = np.random.Generator(np.random.PCG64([case.atomistic.random_seed, number]))
        state = sampler.equilibrated(sampler.start(found.restart["state"]), case.sampling.equilibration, generator)
        chain = _Chain(state, generator, found.restart["state"], found.report.converged)
        yield Ensemble(_states(case, contact, sampler, chain, case.path[number][0]))


@dataclasses.dataclass
class _Chain:
    """Where the sampling of one point stands.

    Attributes
    ----------
    state : SamplerState
        Of the sampler.
    generator : numpy.random.Generator
        Of its random numbers.
    equilibrium : numpy.ndarray, shape (3, ny, nx)
        State at zero temperature, which the next point starts from (m).
    converged : bool
        Whether that is an equilibrium.
    pressures : list of float
        Mean pressures of the interface so far (Pa).
    """

    state: SamplerState
    generator: np.random.Generator
    equilibrium: np.ndarray
    converged: bool
    pressures: list[float] = dataclasses.field(default_factory=list)

    @property
    def packed(self) -> dict[str, np.ndarray]:
        """All of it as arrays that a file can hold."""
        state = self.state
        return {
            "state": self.equilibrium,
            "spectrum": state.displacement.view(np.float64),
            "generator": packed(self.generator),
            "mass": state.mass,
            "sampler": np.array([state.time_step]),
            "pressures": np.array(self.pressures),
            "counts": np.array([state.trajectories, state.accepted, state.evaluations, int(self.converged)]),
        }

    @classmethod
    def unpacked(cls, arrays: Mapping[str, np.ndarray]) -> "_Chain":
        """What :attr:`packed` was made of.

        Raises
        ------
        InputError
            If a version of this program packed it that kept no pressures.
        """
        if "pressures" not in arrays:
            raise InputError(OTHER_VERSION)
        time_step = float(arrays["sampler"][0])
        trajectories, accepted, evaluations, converged = map(int, arrays["counts"])
        spectrum = np.ascontiguousarray(arrays["spectrum"]).view(np.complex128)
        state = SamplerState(spectrum, time_step, arrays["mass"], trajectories, accepted, evaluations)
        return cls(
            state, generator_of(arrays["generator"]), arrays["state"], bool(converged), arrays["pressures"].tolist()
        )


def _states(
    case: Case, contact: AtomisticContact, sampler: ThermalSampler, chain: _Chain, target: float
) -> Iterator[InterfaceState]:
    while chain.state.trajectories < case.sampling.trajectories:
        chain.state = sampler.next(chain.state, chain.generator)
        state = _thermal_state(case, contact, sampler, chain, target)
        yield state
        if state.report.detached:
            return


def _thermal_state(
    case: Case, contact: AtomisticContact, sampler: ThermalSampler, chain: _Chain, target: float
) -> InterfaceState:
    displacement = sampler.displacement(chain.state)
    energy = contact.interface.evaluate(displacement, sampler.force)
    apart = not sampler.force.any()
    found = contact.solution(
        Equilibrium(
            displacement=displacement,
            force=sampler.force.copy(),
            residual=np.nan,
            outcome=Outcome.DETACHED if apart else Outcome.CONVERGED,
            iterations=chain.state.trajectories,
            evaluations=chain.state.evaluations,
            fft_pairs=float(chain.state.evaluations),  # each takes one pair
            elastic_energy=sampler.elastic_energy(chain.state),
            interaction_energy=energy,
        )
    )
    chain.pressures.append(float(np.mean(found.pressure)))
    count, rate = chain.state.trajectories, chain.state.accepted / chain.state.trajectories
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
    return dataclasses.replace(state, report=report, restart={"state": chain.equilibrium} if over else chain.packed)
