"""Time and result of the continuum solver beside those of public codes, on the same surfaces, as a Markdown table.

The codes are Tamaas (PolonskyKeerRey), ContactMechanics (constrained conjugate gradients of Polonsky and Keer) and
Adhesion (bound-constrained conjugate gradients, and L-BFGS-B for a soft wall), from PyPI: ``pip install
'.[peers]'``. Every code takes the heights and returns a state, each with one thread, in turn (ours, theirs,
ours, theirs …); times are CPU times of the process, medians of three runs or, of codes that take longer than half a
minute, one. Units: E* = 1, cell 1, rms slope 1.

The error is formed from the returned state by the same lines for all codes. Of a pressure on a hard wall: Σ p g over
Σ p × rms height, g the gap above its least, which bounds the distance to the least energy, and the relative error of
the load. Of a gap under adhesion: the largest imbalance K u + φ'(g) + p, over E*; where the surfaces touch, only what
the wall would have to pull. Areas (points that touch; of the soft wall those in repulsion) and energies (elastic, and
of the interaction) are formed alike.

Adhesion solves at a given displacement of a half-space that answers a mean displacement, too. "Adhesion, displacement"
compares both codes at one displacement, ours behind a spring of that stiffness; "Adhesion, pressure" searches for it
(Brent's method, each solve from the state before) within a tenth of the rms height.

    python -m scripts.benchmark_peers                         # all, half an hour
    python -m scripts.benchmark_peers --coarser 8             # on grids of an eighth, a minute
    python -m scripts.benchmark_peers --only "hard wall"
    python -m scripts.benchmark_peers --only displacement
    python -m scripts.benchmark_peers --table data/benchmark_peers.csv
    python -m scripts.benchmark_peers --from data/benchmark_peers.csv
"""

import argparse
import importlib.util
import os
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import redirect_stdout
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import pandas as pd

from bem_adhesion import Dugdale, Exponential, HardWall, LennardJones, TractionLaw, rough_contact
from contact_study.inputs.errors import InputError
from scripts.harness import Option, head, rough_surface, row, tabulated

MEAN_PRESSURE, ROLL_OFF, SEED = 0.05, 4, 1
WEAK, STRONG = (1e-4, 5e-3), (4e-4, 2e-3)  # work and range: a twelfth and half more contact
RAMP = 0.02  # of our Dugdale law; Tamaas' tension ends at a point
# Of what each code stops on itself: Tamaas' is our measure for the hard wall, and of the same form under adhesion.
TAMAAS_HARD, TAMAAS_ADHESIVE, PENETRATION, IMBALANCE = 1e-10, 1e-6, 1e-10, 1e-6
# Of ours under adhesion, beside each code: every state of theirs is further from balance. On the hard wall it is the
# solver's own.
OURS_BESIDE_TAMAAS, OURS_BESIDE_ADHESION = 1e-7, 3e-7
MOST_ITERATIONS = 20000
AT_DISPLACEMENT = "Adhesion, displacement"
LONG = 30.0  # seconds of one of their runs that is not repeated


class AtomOnHalfSpace(LennardJones):
    """φ(d) = Δγ[½(r0/d)⁹ − (3/2)(r0/d)³], the 9-3 law of Adhesion's ``LJ93``; ``length`` is r0."""

    title = "9-3 of an atom"
    words = "in the 9-3 law of an atom on a half-space"
    exponent = 4


@dataclass(frozen=True)
class Problem:
    """What every code is asked."""

    height: np.ndarray
    law: TractionLaw
    offset: float = np.nan  # of the displaced surface, for codes that solve at a displacement
    stiffness: float = np.nan  # of their solid's answer to a mean displacement

    @property
    def hard(self) -> bool:
        """Whether nothing attracts."""
        return not self.law.attracts


@dataclass(frozen=True)
class Measured:
    """A state by the common measures."""

    error: float
    area: float
    elastic: float
    interaction: float


def surface(points: int, cutoff_mode: int) -> np.ndarray:
    """Heights of rms slope 1 on a cell of 1: H = 0.8, roll-off at a quarter of the cell."""
    made = rough_surface(1.0, points, 0.02, roll_off_mode=ROLL_OFF, cutoff_mode=cutoff_mode, seed=SEED)
    return made.sampled / made.rms_slope


def _half_space(field: np.ndarray, inverse: bool = False) -> np.ndarray:
    """K u, K = q/2, or C p without a mean."""
    q = 2 * np.pi * np.hypot(np.fft.fftfreq(len(field), 1 / len(field))[:, None], np.arange(len(field) // 2 + 1))
    kernel = np.divide(2, q, out=np.zeros_like(q), where=q > 0) if inverse else q / 2
    return np.fft.irfft2(kernel * np.fft.rfft2(field), s=field.shape)


def measured(problem: Problem, state: np.ndarray) -> Measured:
    """Error, area and energies of a pressure (hard wall) or of a gap (adhesion)."""
    if problem.hard:
        pressure = np.maximum(state, 0)
        displacement = _half_space(pressure, inverse=True)
        gap = displacement - problem.height
        error = np.sum(pressure * (gap - gap.min())) / (pressure.sum() * problem.height.std())
        error += abs(pressure.mean() / MEAN_PRESSURE - 1)
        return Measured(float(error), float(np.mean(pressure > 0)), 0.5 * float(np.mean(pressure * displacement)), 0.0)
    law, gap = problem.law, state
    displacement = gap + problem.height
    elastic = _half_space(displacement)
    free = gap > 0
    imbalance = elastic + law.traction(gap) + MEAN_PRESSURE
    error = np.max(np.where(free, np.abs(imbalance), -imbalance))
    touching = ~free if law.has_wall else gap < law.equilibrium_distance
    energy = 0.5 * float(np.mean(displacement * elastic))
    return Measured(float(error), float(np.mean(touching)), energy, float(np.mean(law.potential(gap))))


def ours(problem: Problem, code: str) -> tuple[np.ndarray, float]:
    """Our pressure or gap beside a code, and the transform pairs it took."""
    adhesive = OURS_BESIDE_TAMAAS if code == "Tamaas" else OURS_BESIDE_ADHESION
    tolerance = None if problem.hard else adhesive
    make = partial(rough_contact, problem.height, 1.0, 1.0, problem.law, tolerance=tolerance)
    if code == AT_DISPLACEMENT and np.isfinite(problem.offset):
        contact = make(control="approach", machine_stiffness=problem.stiffness)
        first_touch = float(problem.height.max()) + problem.law.equilibrium_distance
        found = contact.step(contact.separated(), first_touch + problem.offset)
    else:
        contact = make()
        found = contact.step(contact.separated(), MEAN_PRESSURE)
    if not found.converged:
        raise RuntimeError(found.message)
    return found.pressure if problem.hard else found.gap, found.fft_pairs


def tamaas(problem: Problem) -> np.ndarray:
    import tamaas as tm

    tm.set_log_level(tm.LogLevel.warning)
    model = tm.Model(tm.model_type.basic_2d, [1.0, 1.0], list(problem.height.shape))
    model.E, model.nu = 1.0, 0.0
    method = tm.PolonskyKeerRey
    if problem.hard:
        solver = method(model, problem.height, TAMAAS_HARD)
    else:
        solver = method(model, problem.height, TAMAAS_ADHESIVE, primal_type=method.gap, constraint_type=method.pressure)
        exponential = isinstance(problem.law, Exponential)
        attraction = (tm.ExponentialAdhesionFunctional if exponential else tm.MaugisAdhesionFunctional)(problem.height)
        attraction.parameters = {"rho": problem.law.length, "surface_energy": problem.law.work_of_adhesion}
        solver.addFunctionalTerm(attraction)
    solver.max_iter = MOST_ITERATIONS
    solver.solve(MEAN_PRESSURE)
    return np.array(model.traction) if problem.hard else np.maximum(np.array(model["gap"]), 0)


def contact_mechanics(problem: Problem) -> np.ndarray:
    import ContactMechanics
    import SurfaceTopography
    from ContactMechanics.Optimization import constrained_conjugate_gradients

    points = problem.height.shape
    topography = SurfaceTopography.Topography(problem.height, (1.0, 1.0), periodic=True)
    substrate = ContactMechanics.PeriodicFFTElasticHalfSpace(points, 1.0, (1.0, 1.0))
    tolerance = PENETRATION * problem.height.std()
    limits = {"pentol": tolerance, "forcetol": 1e-12, "thermotol": PENETRATION}
    found = constrained_conjugate_gradients(substrate, topography, external_force=MEAN_PRESSURE, **limits)
    return np.asarray(found.jac) * problem.height.size


def _adhesion_system(problem: Problem):
    """Adhesion's description of the problem, and its largest imbalance of a point's force."""
    import SurfaceTopography
    from Adhesion.Interactions import LJ93
    from Adhesion.Interactions import Exponential as TheirExponential
    from Adhesion.System import BoundedSmoothContactSystem, SmoothContactSystem, make_system

    law = problem.law
    if law.has_wall:
        kind, interaction = BoundedSmoothContactSystem, TheirExponential(law.work_of_adhesion, law.length)
    else:
        sigma = law.length * 2.5 ** (1 / 6)
        kind, interaction = SmoothContactSystem, LJ93(law.work_of_adhesion / (2 / 3 * 2.5**0.5), sigma)
        interaction = interaction.linearize_core(r_ti=0.7 * law.length)
    topography = SurfaceTopography.Topography(problem.height, (1.0, 1.0), periodic=True)
    system = make_system(
        interaction=interaction, surface=topography, substrate="periodic", young=1.0, system_class=kind
    )
    imbalance = max(topography.rms_gradient(), abs(interaction.max_tensile))
    return system, IMBALANCE * imbalance * topography.area_per_pt


class _Adhesion:
    """Adhesion's solver of one problem, at any offset of the displaced surface; each solve starts from the last."""

    def __init__(self, problem: Problem):
        self._problem = problem
        self._system, self._tolerance = _adhesion_system(problem)
        self.last: np.ndarray | None = None

    def gap(self, offset: float) -> np.ndarray:
        import scipy.optimize
        from NuMPI.Optimization import constrained_conjugate_gradients

        height, system = self._problem.height, self._system
        closest = 0.0 if self._problem.law.has_wall else self._problem.law.equilibrium_distance
        start = np.maximum(-height - offset, closest) if self.last is None else self.last
        if self._problem.law.has_wall:
            objective = system.primal_objective(offset, gradient=True)
            options = {"gtol": self._tolerance, "maxiter": MOST_ITERATIONS}
            found = constrained_conjugate_gradients(objective, system.primal_hessian_product, x0=start, **options)
            gap = found.x
        else:
            objective = system.objective(offset, gradient=True)
            options = {"gtol": self._tolerance, "ftol": 0, "maxiter": MOST_ITERATIONS, "maxfun": 2 * MOST_ITERATIONS}
            first = (start + height + offset).reshape(-1)
            found = scipy.optimize.minimize(objective, first, method="L-BFGS-B", jac=True, options=options)
            gap = found.x.reshape(height.shape) - height - offset
        if not found.success:
            print(f"Adhesion: {found.message}", file=sys.stderr)
        self.last = np.reshape(gap, height.shape)
        return self.last

    def excess(self, offset: float) -> float:
        """Mean pressure less the one asked for, zero within 1e-6 of that."""
        self.gap(offset)
        difference = float(self._system.compute_normal_force()) - MEAN_PRESSURE
        return difference if abs(difference) > 1e-6 * MEAN_PRESSURE else 0.0


def adhesion_at_displacement(problem: Problem) -> np.ndarray:
    return _Adhesion(problem).gap(problem.offset)


def adhesion_at_pressure(problem: Problem) -> np.ndarray:
    from scipy.optimize import brentq

    code, width = _Adhesion(problem), 0.1 * problem.height.std()
    brentq(code.excess, problem.offset - 0.8 * width, problem.offset + 1.2 * width, xtol=1e-15)
    assert code.last is not None
    return code.last


def with_offset(problem: Problem, gap: np.ndarray) -> Problem:
    """The problem at the displacement that our state has in Adhesion: its solid answers a mean displacement, too."""
    system, _ = _adhesion_system(problem)
    stiffness = -float(np.mean(system.substrate.evaluate_force(np.ones_like(gap)))) * gap.size
    offset = MEAN_PRESSURE / stiffness - float(np.mean(gap + problem.height))
    return replace(problem, offset=offset, stiffness=stiffness)


@dataclass(frozen=True)
class Row:
    """A problem by its words, and the codes that are asked it."""

    words: str
    points: int
    cutoff_mode: int
    law: TractionLaw
    codes: Mapping[str, Callable[[Problem], np.ndarray]]


def problems() -> list[Row]:
    """What the table compares."""
    on_wall = {"Tamaas": tamaas, "ContactMechanics": contact_mechanics}
    of_adhesion = {AT_DISPLACEMENT: adhesion_at_displacement, "Adhesion, pressure": adhesion_at_pressure}
    found = [Row(f"hard wall, {n} waves", 1024, n, HardWall(), on_wall) for n in (16, 128)]
    for points in (256, 512, 1024):
        for name, (work, length) in (("weak", WEAK), ("strong", STRONG)):
            # Tamaas would take minutes a run on the last.
            codes = of_adhesion if points == 1024 else {"Tamaas": tamaas, **of_adhesion}
            found.append(Row(f"exponential, {name}", points, 32, Exponential(work, length), codes))
    for name, (work, length) in (("weak", WEAK), ("strong", STRONG)):
        found.append(Row(f"Maugis, {name}", 256, 32, Dugdale(work, length, RAMP), {"Tamaas": tamaas}))
    for points in (128, 512, 1024):
        found.append(Row("soft 9-3 wall", points, 32, AtomOnHalfSpace(1e-4, 4.3e-3), of_adhesion))
    return found


def compared(
    problem: Problem, code: str, theirs: Callable[[Problem], np.ndarray], repeat: int
) -> dict[str, str | float]:
    """What the table says of one problem and one code: medians over interleaved runs."""
    state, pairs = ours(problem, code)  # compiles and plans
    if code.startswith("Adhesion"):
        problem = with_offset(problem, state)
        ours(problem, code)  # other code is compiled at a displacement
    seconds: dict[str, list[float]] = {"ours": [], "theirs": []}
    for _ in range(repeat):
        began = time.process_time()
        state, pairs = ours(problem, code)
        between = time.process_time()
        with redirect_stdout(sys.stderr):  # they report on their way
            their_state = theirs(problem)
        seconds["theirs"].append(time.process_time() - between)
        seconds["ours"].append(between - began)
        if seconds["theirs"][-1] > LONG:
            break
    own, other = measured(problem, state), measured(problem, their_state)
    energies = [(own.elastic, other.elastic)] + ([] if problem.hard else [(own.interaction, other.interaction)])
    return {
        "code": code,
        "error": own.error,
        "their_error": other.error,
        "area": own.area,
        "their_area": other.area,
        "energy_difference": max(abs(another / one - 1) for one, another in energies),
        "fft_pairs": pairs,
        "seconds": np.median(seconds["ours"]),
        "their_seconds": np.median(seconds["theirs"]),
        "ratio": np.median(np.array(seconds["theirs"]) / seconds["ours"]),
    }


def rows(table: pd.DataFrame) -> Iterator[str]:
    """The table's lines."""
    results = "error: ours", "theirs", "A/A₀: ours", "theirs", "energies differ by"
    yield head("problem", "points", "code", *results, "pairs", "s: ours", "theirs", "ratio")
    for each in table.itertuples():
        cells = f"{each.error:.0e}", f"{each.their_error:.0e}", f"{each.area:.5f}", f"{each.their_area:.5f}"
        costs = f"{each.energy_difference:.0e}", f"{each.fft_pairs:.0f}", f"{each.seconds:.3g}"
        times = f"{each.their_seconds:.3g}", f"{each.ratio:.0f}"
        yield row(each.problem, f"{each.points}²", each.code, *cells, *costs, *times)


def run(given: argparse.Namespace) -> Iterator[dict[str, str | float]]:
    """Every row whose words hold those given."""
    missing = [name for name in ("tamaas", "ContactMechanics", "Adhesion") if importlib.util.find_spec(name) is None]
    if missing:
        raise InputError(f"not installed: {', '.join(missing)}; pip install '.[peers]'")
    if os.environ.get("OMP_NUM_THREADS") != "1":  # libraries read it as they are imported
        os.execve(sys.executable, sys.orig_argv, os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"})
    for asked in problems():
        codes = {code: theirs for code, theirs in asked.codes.items() if given.only in f"{asked.words}, {code}"}
        if codes:
            points = asked.points // given.coarser
            problem = Problem(surface(points, max(asked.cutoff_mode // given.coarser, ROLL_OFF)), asked.law)
            for code, theirs in codes.items():
                yield {"problem": asked.words, "points": points} | compared(problem, code, theirs, given.repeat)


main = tabulated(
    run,
    rows,
    Option("--only", "", "problems and codes whose names have these words", metavar="WORDS"),
    Option("--coarser", 1, "factor by which every grid is coarser, for a first look"),
    Option("--repeat", 3, "runs of each solve; one of long ones"),
)


if __name__ == "__main__":
    sys.exit(main())
