"""Molecular dynamics: the explicit block approaches under its load, with Langevin damping and noise on demand."""

import dataclasses
import math
from collections.abc import Iterator

import numpy as np

from contact_study.inputs.errors import InputError, refuse
from contact_study.physics.surfaces.surface import Surface
from contact_study.results.schema import block_nodes, surface_atoms
from contact_study.results.state import Ensemble, InterfaceState, SolverReport
from contact_study.study.case import Case
from md_reference.block.condensed import isotropic_element, lame_constants
from md_reference.block.multiscale import MultiscaleBlock, NonlinearSpringBlock, level_layers
from md_reference.interface.pairs import LennardJonesInterface
from md_reference.statics.energy import separated
from md_reference.study.system import Predictor, Restart, States, build_interface, row_threads
from md_reference.thermal import equilibration
from md_reference.thermal.checkpoint import Frame, TrajectoryState
from md_reference.thermal.equilibration import Descent
from md_reference.thermal.langevin import MolecularDynamics, Motion, fastest_wave

_SAFE_STEP = 0.2  # of the largest stable one, the default: an energy error of one per cent
_SLOW = 0.1  # of the speed of sound, above which an approach is an impact


def check(case: Case) -> None:
    """Raise InputError unless a case can be in motion."""
    given, mass = case.dynamics, case.material.atom_mass
    if mass is None:
        raise InputError('missing key material.atom_mass: atomistic.method = "dynamics" needs the mass of an atom')
    driven, lowest = case.loading.control == "gap", min(case.loading.path)
    thickness = case.block_layers * case.lattice.constant
    largest = largest_time_step(case)
    step = time_step(case, largest)
    sound = math.sqrt(longitudinal_modulus(case) * case.lattice.constant**3 / mass)
    refuse(
        {
            'loading.control = "gap": atomistic.method = "dynamics" moves the block from one gap to the next; give '
            "dynamics.approach_speed": driven and given.approach_speed == 0,
            f"loading.path: a gap of {lowest:g} m presses a block of {thickness:g} m flat; the rigid plane above it is "
            "driven to the gap that the block would have without compression": driven and lowest <= -thickness,
            f"dynamics.time_step = {step:g} s: velocity Verlet is unstable from {largest:.3g} s on, 2/ω of the "
            "lattice's fastest wave and a stiff contact; use a fifth of that": step >= largest,
            f"dynamics.duration = {given.duration:g} s: shorter than dynamics.frames = {given.frames} steps of "
            f"{step:.3g} s": given.duration < given.frames * step,
            f"dynamics.approach_speed = {given.approach_speed:g} m/s: is an impact; use at most a tenth of the speed "
            f"of sound, {_SLOW * sound:.3g} m/s": given.approach_speed > _SLOW * sound,
            f"atomistic.temperature = {case.atomistic.temperature:g} K: a thermostat needs dynamics.damping above "
            "zero": case.atomistic.temperature > 0 and given.damping == 0,
        }
    )


def longitudinal_modulus(case: Case) -> float:
    """Return λ + 2μ, of compression without lateral strain and of the faster sound (Pa)."""
    first, shear = lame_constants(case.material.youngs_modulus, case.material.poissons_ratio)
    return first + 2 * shear


def largest_time_step(case: Case) -> float:
    """Return the limit of stability 2/ω (s), ω² that of the lattice's fastest wave plus a stiff contact's over mass."""
    assert case.material.atom_mass is not None
    constant, material = case.lattice.constant, case.material
    element = isotropic_element(constant, material.youngs_modulus, material.poissons_ratio)
    law = case.law
    contact = float(law.stiffness(np.array([law.equilibrium_distance]))[0]) * constant**2
    return 2 / math.sqrt(fastest_wave(element, case.material.atom_mass) ** 2 + contact / case.material.atom_mass)


def time_step(case: Case, largest: float | None = None) -> float:
    """Return the time step of a case (s); ``largest`` is :func:`largest_time_step`, if known."""
    given = case.dynamics.time_step
    return given if given is not None else _SAFE_STEP * (largest or largest_time_step(case))


def build_block(case: Case) -> MultiscaleBlock:
    """Return the explicit block of a case."""
    atoms, material = case.lattice.atoms, case.material
    assert material.atom_mass is not None
    lame = lame_constants(material.youngs_modulus, material.poissons_ratio)
    layers = level_layers(atoms, case.block_layers)
    kind = NonlinearSpringBlock if case.atomistic.block == "nonlinear_springs" else MultiscaleBlock
    return kind(atoms, case.lattice.constant, *lame, layers, material.atom_mass, row_threads(case))


def solve_path(case: Case, surface: Surface, restart: Restart, start: int, predictor: Predictor) -> States:
    """Yield the motion along the path: at each point its pressure acts for ``dynamics.duration``.

    Under gap control the rigid plane moves to each point, and rests for the duration where a point repeats the one
    before. A point's result is its last state, or, with a thermostat or without damping, the mean of the second half.
    """
    run = _Run(case, build_interface(case, surface))
    at = run.begin(start) if restart is None else TrajectoryState.unpack(restart)
    for number in range(start, len(case.path)):
        if at.point != number:
            at.point, at.frame, at.series = number, 0, []
        target, before = case.path[number][0], case.path[number - 1][0] if number else None
        # A driven motion passes a value once: there is no mean of it.
        passing = case.loading.control == "gap" and target != before
        comes_to_rest = case.atomistic.temperature == 0 and case.dynamics.damping > 0
        discarded = None if passing or comes_to_rest else case.dynamics.frames // 2
        yield Ensemble(run.states(at, target, discarded), discarded)


class _Run:
    """The moving block of a case, and its states for the campaign."""

    def __init__(self, case: Case, interface: LennardJonesInterface):
        self._case = case
        self._interface = interface
        self._driven = case.loading.control == "gap"
        self._mean_height = float(np.mean(interface.rest_heights()))
        self._area = case.lattice.constant**2
        step, temperature = time_step(case), case.atomistic.temperature
        block = build_block(case)
        self._system = MolecularDynamics(block, interface, step, case.dynamics.damping, temperature, self._driven)
        self._steps = round(case.dynamics.duration / step)

    def begin(self, point: int, time: float = 0.0) -> TrajectoryState:
        """Return a separated block at the approach speed."""
        motion = self._system.start(separated(self._interface), -self._case.dynamics.approach_speed)
        motion.time = time
        seed = [self._case.atomistic.random_seed, point]
        return TrajectoryState(motion, np.random.Generator(np.random.PCG64(seed)), point)

    def states(self, at: TrajectoryState, target: float, discarded: int | None) -> Iterator[InterfaceState]:
        """Yield the remaining states of a point, moving the block; stop early where tension tears it off."""
        system, pressure = self._system, 0.0 if self._driven else target
        if at.frame == 0:
            at.steps = self._drive(at, target) if self._driven else self._steps
            at.frames = min(self._case.dynamics.frames, at.steps)
        while at.frame < at.frames:
            before = at.taken
            at.frame += 1
            try:
                system.move(at.motion, pressure, at.generator, at.taken - before)
            except FloatingPointError as error:
                raise InputError(
                    f"dynamics.time_step = {system.time_step:.3g} s: {error} {1e12 * at.motion.time:.3g} ps or more "
                    "after the start; a hard impact is stiffer than the contact at rest that the step is stable for: "
                    "use a shorter one, or a lower dynamics.approach_speed"
                ) from None
            within_reach = bool(system.interface_force.any())
            at.touched |= within_reach
            # A driven plane has a definite position, and can come back.
            apart = not (self._driven or within_reach or pressure > 0 or at.motion.top_velocity < 0)
            state = self._state(at, pressure, discarded, apart)
            if apart:
                fresh = self.begin(at.point, at.motion.time)
                at.motion, at.touched, at.frame = fresh.motion, False, at.frames
            yield dataclasses.replace(state, restart=at.pack())

    def _drive(self, at: TrajectoryState, gap: float) -> int:
        """Set the rigid plane's velocity, toward a gap or for a rest; return the number of time steps."""
        way = gap + self._mean_height + self._case.law.equilibrium_distance - at.motion.top
        if abs(way) < 1e-9 * self._case.law.equilibrium_distance:  # it has arrived, within rounding
            at.motion.top_velocity = 0.0
            return self._steps
        step = self._system.time_step
        steps = math.ceil(abs(way) / (self._case.dynamics.approach_speed * step))
        at.motion.top_velocity = way / (steps * step)
        return steps

    def _state(self, at: TrajectoryState, pressure: float, discarded: int | None, apart: bool) -> InterfaceState:
        case, system, motion, law = self._case, self._system, at.motion, self._case.law
        displacement = np.ascontiguousarray(system.block.bottom_of(motion.displacement))
        stress = system.interface_force[2] / self._area
        nominal = self._area * stress.size
        gap = np.full(stress.shape, np.inf) if apart else self._interface.gap(displacement)
        is_layer = math.isfinite(case.solid.depth)  # whose separation is that of its base
        height = motion.top if is_layer else float(np.mean(displacement[2]))
        elastic = whole = system.elastic_energy(motion) / nominal
        if not is_layer:  # a half-space has no uniform compression: that of the block is subtracted
            elastic -= system.block.compression_energy(motion.displacement)
        interaction, kinetic = system.interaction_energy / nominal, system.kinetic_energy(motion) / nominal
        lifted = pressure * (motion.top - self._mean_height)
        temperature, whole_temperature = system.temperature(motion), system.temperature_of_whole(motion)
        at.series.append(Frame(motion.time, motion.top, float(np.mean(stress)), temperature, whole_temperature))
        return InterfaceState(
            gap=gap,
            pressure=stress.copy(),
            contact=law.in_contact(gap, stress, case.contact_distance),
            equilibrium_distance=law.equilibrium_distance,
            mean_separation=np.inf if apart else height - self._mean_height - law.equilibrium_distance,
            elastic_energy=0.0 if apart else elastic,
            interaction_energy=interaction,
            report=self._report(at, pressure, discarded, apart),
            spacing=(case.lattice.constant, case.lattice.constant),
            further={
                "time": motion.time,
                "temperature": temperature,
                "kinetic_energy": kinetic,
                "mechanical_energy": kinetic + whole + interaction + lifted,
            },
            atoms=self._atoms(motion) if apart or at.frame == at.frames else {},
            wall_bounded=law.wall_bounded(case.contact_distance),
        )

    def _atoms(self, motion: Motion) -> dict[str, np.ndarray]:
        """Return the atoms one by one, as far as the study asks for them."""
        case, block = self._case, self._system.block
        if case.output.atoms == "none":
            return {}
        stress = self._system.interface_force / self._area
        found = surface_atoms(block.bottom_of(motion.displacement), stress, block.bottom_of(motion.velocity))
        if case.output.atoms == "block":
            velocity = motion.velocity.copy()
            block.top_of(velocity)[2] = motion.top_velocity
            found |= block_nodes(block.rest_positions + block.nodes_of(motion.displacement), block.nodes_of(velocity))
        return found

    def _report(self, at: TrajectoryState, pressure: float, discarded: int | None, apart: bool) -> SolverReport:
        # Mean pressures in the states that count; before there are any, in the last one.
        last = len(at.series) - 1
        carried = np.array(at.series[last if discarded is None else min(discarded, last) :])[:, 2]
        message, converged, detached = "", True, apart
        if apart:
            event = "was torn off and" if at.touched else "has not been within reach of the substrate, and"
            residual, message = 0.0, f"detached: the block {event} moves away"
        elif self._driven and not np.any(carried):
            residual, message, detached = 0.0, "detached: no atom is within reach", True
        elif self._driven:  # a state of the prescribed motion; none in balance
            residual = self._system.unbalanced(at.motion) / self._area / self._case.material.contact_modulus
        elif at.frame < at.frames:  # the report of the last state is the point's
            residual = np.nan
        else:
            residual, message = self._test(at, pressure, carried)
            converged = not message
        return SolverReport(
            converged=converged,
            detached=detached,
            residual=residual,
            iterations=at.taken,
            fft_pairs=0.0,
            force_evaluations=at.taken + at.frame,  # a frame ends with the forces of its last step, as the next begins
            message=message,
        )

    def _test(self, at: TrajectoryState, pressure: float, carried: np.ndarray) -> tuple[float, str]:
        """Return the residual of a finished point, and advice if the block is not in equilibrium."""
        case, modulus = self._case, self._case.material.contact_modulus
        block, counted = self._system.block, at.series[-carried.size :]
        # The block's motion in the states that count begins with the one before them.
        time, top, *_ = np.array(at.series[-carried.size - 1 :]).T
        assert case.material.atom_mass is not None
        density = case.material.atom_mass / case.lattice.constant**3
        drag = block.total_mass / (self._area * math.prod(case.lattice.atoms)) * case.dynamics.damping
        descent = Descent(
            carried=carried,
            load=pressure,
            reached=bool(np.any(carried)),
            speed=float((top[0] - top[-1]) / (time[-1] - time[0])),
            terminal_speed=pressure / drag if drag else math.inf,
            impact=math.sqrt(density * longitudinal_modulus(case))
            * abs(self._system.momentum(at.motion) / block.total_mass),
        )
        if case.atomistic.temperature > 0:
            return equilibration.not_in_equilibrium(
                descent,
                modulus,
                nodes=float(np.mean([frame.temperature for frame in counted])),
                whole=float(np.mean([frame.whole for frame in counted])),
                bath=case.atomistic.temperature,
                freedoms=block.freedoms,
                forgotten=case.dynamics.damping * (counted[-1].time - counted[0].time),
            )
        if case.dynamics.damping == 0:
            return equilibration.load_missing(descent, modulus, swings=True)
        return equilibration.still_moving(descent, self._system.unbalanced(at.motion) / self._area, modulus)
