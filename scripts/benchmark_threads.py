"""Two threads against one, with the other cores idle and with them busy.

Ratios of interleaved runs, the median of one thread over that of two: above one where the second thread gains. Of
FFTW's transform pairs, once with OpenMP's threads asleep while they wait, as the project sets them, and once with
threads that spin, their own default where cores are free; of whole solves of the continuum; of the atoms' interface
and of a time step of their explicit block. The threads of the last three sleep.

    python -m scripts.benchmark_threads --points 512 1024 2048
    python -m scripts.benchmark_threads --of solves --points 1024 2048 --repetitions 4
    python -m scripts.benchmark_threads --of atoms --points 64 100 200 400
"""

import argparse
import os
import subprocess
import sys
import time
from collections.abc import Callable, Sequence

import numpy as np

from bem_adhesion import HardWall, rough_contact
from contact_study.numerics.fourier import RealTransform
from contact_study.physics.lattice import lattice_of
from contact_study.study.case import realise
from contact_study.study.study import read_study
from md_reference.block.condensed import isotropic_element, lame_constants
from md_reference.block.multiscale import MultiscaleBlock, level_layers
from md_reference.interface.pairs import interface_of
from md_reference.thermal.langevin import MolecularDynamics, fastest_wave
from scripts.harness import PAPER, Option, program, show

# Of the paper's system, at any scale of the lengths.
_CONSTANT, _LENGTH, _WELL_DEPTH, _CUTOFF = 2.6e-10, 3.28e-10, 2.98e-21, 4.0
_STEPS = 5  # of the block in one go
_YOUNGS_MODULUS, _POISSONS_RATIO, _ATOM_MASS = 77.2e9, 0.42, 3.27e-25
_PRESSURE = 1e9


def transform_pair(points: int, threads: int) -> Callable[[], object]:
    """Forward and back."""
    transform = RealTransform((points, points), np.float64, threads)

    def run() -> None:
        transform.forward()
        transform.backward()

    return run


def hard_wall(points: int, threads: int) -> Callable[[], object]:
    """The paper's surface without adhesion, from separation."""
    return _solve(points, threads, adheres=False)


def adhesive(points: int, threads: int) -> Callable[[], object]:
    """The same at ε0."""
    return _solve(points, threads, adheres=True)


def _solve(points: int, threads: int, adheres: bool) -> Callable[[], object]:
    case = read_study(PAPER).cases[0]
    surface = realise(case)
    heights = surface.heights((points, points))
    law = case.law if adheres else HardWall()
    contact = rough_contact(heights, surface.size, case.solid, law, threads=threads)
    return lambda: contact.step(contact.separated(), _PRESSURE)


def interface_pass(atoms: int, threads: int) -> Callable[[], object]:
    """Forces and second derivatives of flat surfaces in contact."""
    lattice = lattice_of((atoms * _CONSTANT,) * 2, _CONSTANT)
    interface = interface_of(np.zeros, lattice, _WELL_DEPTH, _LENGTH, _CUTOFF, threads)
    surface = np.zeros((3, atoms, atoms))
    surface[2] = _LENGTH
    force, hessian = np.empty(surface.shape), np.empty((6, atoms, atoms))
    return lambda: interface.evaluate(surface, force, hessian)


def time_step(atoms: int, threads: int) -> Callable[[], object]:
    """Steps of the explicit block out of reach, with friction."""
    lame = lame_constants(_YOUNGS_MODULUS, _POISSONS_RATIO)
    layers = level_layers((atoms, atoms), atoms)
    block = MultiscaleBlock((atoms, atoms), _CONSTANT, *lame, layers, _ATOM_MASS, threads)
    lattice = lattice_of((atoms * _CONSTANT,) * 2, _CONSTANT)
    interface = interface_of(np.zeros, lattice, _WELL_DEPTH, _LENGTH, _CUTOFF, threads)
    step = 0.4 / fastest_wave(isotropic_element(_CONSTANT, _YOUNGS_MODULUS, _POISSONS_RATIO), _ATOM_MASS)
    system = MolecularDynamics(block, interface, step, damping=0.01 / step)
    surface = np.zeros((3, atoms, atoms))
    surface[2] = 2 * _CUTOFF * _LENGTH
    motion, generator = system.start(surface), np.random.default_rng(0)
    return lambda: system.move(motion, 0.0, generator, _STEPS)


WORK = {"transforms": (transform_pair,), "solves": (hard_wall, adhesive), "atoms": (interface_pass, time_step)}
WORDS = {
    "hard_wall": "hard wall",
    "adhesive": "adhesive, ε₀",
    "interface_pass": "interface",
    "time_step": "time step of the block",
}


def ratio(make: Callable[[int, int], Callable[[], object]], points: int, repetitions: int) -> float:
    """Median time of a piece of work in one thread over that in two, interleaved."""
    runs = [make(points, threads) for threads in (1, 2)]
    seconds: list[list[float]] = [[], []]
    for _ in range(repetitions):
        for run, times in zip(runs, seconds, strict=True):
            began = time.perf_counter()
            run()
            times.append(time.perf_counter() - began)
    one, two = (float(np.median(times[1:])) for times in seconds)
    return one / two


def measured(policy: str, busy: bool, of: str, points: Sequence[int], repetitions: int) -> list[list[float]]:
    """Ratios of all sizes, for each piece of work, in a process of its own, whose OpenMP has that policy."""
    spinning = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(busy * (_cores() - 1))]
    try:
        command = [
            sys.executable,
            "-m",
            "scripts.benchmark_threads",
            "--here",
            "--of",
            of,
            "--repetitions",
            str(repetitions),
        ]
        command += ["--points", *map(str, points)]
        environment = os.environ | {"OMP_WAIT_POLICY": policy}
        out = subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout
    finally:
        for process in spinning:
            process.kill()
            process.wait()
    return [[float(word) for word in line.split()] for line in out.splitlines()]


def _cores() -> int:
    return os.cpu_count() or 1


def run(options: argparse.Namespace) -> int:
    if options.here:
        for make in WORK[options.of]:
            print(*(ratio(make, points, options.repetitions) for points in options.points))
        return 0
    transforms = options.of == "transforms"
    rows = []
    for policy, word in (("passive", "sleep"), ("active", "spin"))[: 2 if transforms else 1]:
        for busy, cores in ((False, "idle"), (True, "busy")):
            found = measured(policy, busy, options.of, options.points, options.repetitions)
            for make, ratios in zip(WORK[options.of], found, strict=True):
                rows.append((WORDS.get(make.__name__, word), cores, *(f"{value:.2f}" for value in ratios)))
    what = "threads that wait" if transforms else "of"
    show((what, "other cores", *(f"{points}²" for points in options.points)), rows)
    return 0


main = program(
    run,
    Option("--of", "transforms", "what is done", choices=tuple(WORK)),
    Option("--points", [512, 1024, 2048], "points or atoms a side"),
    Option("--repetitions", 15, "runs of each size and number of threads"),
    Option("--here", False, argparse.SUPPRESS),
)

if __name__ == "__main__":
    sys.exit(main())
