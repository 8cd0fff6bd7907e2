"""Two threads of FFTW against one, with the other cores idle and with them busy.

Ratios of interleaved transform pairs, the median of one thread over that of two: above one where the second thread
gains. Once with OpenMP's threads asleep while they wait, as the project sets them, and once with threads that spin,
their own default where cores are free.

    python scripts/benchmark_threads.py --points 512 1024 2048
"""

import argparse
import os
import subprocess
import sys
import time
from collections.abc import Sequence

import numpy as np

from contact_study.fields.fourier import RealTransform


def ratio(points: int, repetitions: int) -> float:
    """Median time of a transform pair in one thread over that in two, interleaved."""
    transforms = [RealTransform((points, points), np.float64, threads) for threads in (1, 2)]
    seconds: list[list[float]] = [[], []]
    for _ in range(repetitions):
        for transform, times in zip(transforms, seconds, strict=True):
            began = time.perf_counter()
            transform.forward()
            transform.backward()
            times.append(time.perf_counter() - began)
    one, two = (float(np.median(times[1:])) for times in seconds)
    return one / two


def measured(policy: str, busy: bool, points: Sequence[int], repetitions: int) -> list[float]:
    """Ratios of all sizes in a process of its own, whose OpenMP has that policy."""
    spinning = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(busy * (_cores() - 1))]
    try:
        command = [sys.executable, __file__, "--here", "--repetitions", str(repetitions)]
        command += ["--points", *map(str, points)]
        environment = os.environ | {"OMP_WAIT_POLICY": policy}
        out = subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout
    finally:
        for process in spinning:
            process.kill()
            process.wait()
    return [float(word) for word in out.split()]


def _cores() -> int:
    return os.cpu_count() or 1


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--points", type=int, nargs="+", default=[512, 1024, 2048], help="points a side")
    parser.add_argument(
        "--repetitions", type=int, default=15, help="transform pairs of each size and number of threads"
    )
    parser.add_argument("--here", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.here:
        print(*(ratio(points, options.repetitions) for points in options.points))
        return 0
    print("| threads that wait | other cores | " + " | ".join(f"{points}²" for points in options.points) + " |")
    print("|---|---|" + "---|" * len(options.points))
    for policy, word in (("passive", "sleep"), ("active", "spin")):
        for busy, cores in ((False, "idle"), (True, "busy")):
            ratios = measured(policy, busy, options.points, options.repetitions)
            print(f"| {word} | {cores} | " + " | ".join(f"{value:.2f}" for value in ratios) + " |")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
