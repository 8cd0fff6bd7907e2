"""The whole comparison of Yang et al. 2008: continuum, theory, atoms, figures and report from one study file.

Runs the four commands; each spreads its cases over the cores, shows progress and can be stopped and run again: finished
steps are not repeated. The atoms take longest, by the one path under the strongest adhesion: all else runs beside them
at the lowest priority, on the cores that they leave idle. Each model goes its own way from separated surfaces;
--predictor starts every state of the atoms from the continuum's gap instead, as a cross-check. The continuum alone also
runs over more surfaces of the same spectrum, whose scatter stands behind the points of the one surface in the figures.
At the paper's size the atoms of half its lengths also stand at 1 GPa, cold and at 300 K.
"""

import argparse
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterable, Sequence
from pathlib import Path

from contact_study.inputs.errors import INTERRUPTED, NOT_CONVERGED

ROOT = Path(__file__).resolve().parent.parent
SURFACES = {"paper": 12, "quick": 4}  # of the scatter
STUDIES = {"paper": "data/yang2008.toml", "quick": "data/yang2008_quick.toml"}
TRAJECTORIES = {"paper": 60, "quick": 0}  # thermal states at 300 K
_PAUSE, _LOWEST_PRIORITY = 0.1, 19
# Of half the paper's lengths, one state: what 300 K does to it.
WARM_STUDY, WARM_STATE = "quick", ["--loading.path", "1 GPa", "--interaction.well_depth_ratio", "1"]
WARM = ["--atomistic.method", "sampling", "--atomistic.temperature", "300 K", "--sampling.equilibration", "25"]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--preset", choices=STUDIES, default="paper", help="size of the study (default paper)")
    parser.add_argument("--output", type=Path, help="folder of the results (default results/yang2008-PRESET)")
    parser.add_argument("--overwrite", action="store_true", help="begin anew where results exist")
    parser.add_argument(
        "--predictor", action="store_true", help="start the atoms' states from the continuum's gap, not their own path"
    )
    parser.add_argument(
        "--surfaces", type=int, metavar="N", help="surfaces of the scatter; 0: none (default 12, quick: 4)"
    )
    parser.add_argument(
        "--trajectories", type=int, metavar="N", help="thermal states at 300 K; 0: none (default 60, quick: 0)"
    )
    given = parser.parse_args()
    surfaces = SURFACES[given.preset] if given.surfaces is None else given.surfaces
    if surfaces < 0 or surfaces == 1:
        parser.error(f"--surfaces {surfaces}: a scatter takes two surfaces or more")
    trajectories = TRAJECTORIES[given.preset] if given.trajectories is None else given.trajectories
    if trajectories < 0 or trajectories == 1:
        parser.error(f"--trajectories {trajectories}: a thermal mean takes two states or more")
    study = ROOT / STUDIES[given.preset]
    folder = given.output or Path("results") / f"yang2008-{given.preset}"
    bem, md, theory, comparison = (folder / f"{name}.nc" for name in ("bem", "md", "theory", "comparison"))
    seeds = folder / "bem_seeds.nc"
    figures, report = folder / "figures", folder / "report.html"
    again = "--overwrite" if given.overwrite else "--resume"
    compared = [bem, md, theory, "-o", comparison, "--figures", figures, "--report", report, "--overwrite"]
    continuum = ["bem-adhesion", study, "-o", bem, again]
    atoms = ["md-reference", study, "-o", md, *(["--predictor", bem] if given.predictor else []), again]
    first, beside = ([continuum, atoms], []) if given.predictor else ([atoms], [continuum])
    beside.append(["persson-theory", study, "-o", theory, again])
    if surfaces:
        numbers = ",".join(str(seed) for seed in range(1, surfaces + 1))
        beside.append(
            ["bem-adhesion", study, "-o", seeds, "--surface.seed", numbers, "--output.fields", "false", again]
        )
        compared += ["--scatter", seeds]
    cold, warm = folder / "md_0K.nc", folder / "md_300K.nc"
    if trajectories:
        state = [*WARM_STATE, "--output.fields", "false", again]
        beside.append(["md-reference", ROOT / STUDIES[WARM_STUDY], "-o", cold, *state])
        thermal = [*WARM, "--sampling.trajectories", str(trajectories)]
        beside.append(["md-reference", ROOT / STUDIES[WARM_STUDY], "-o", warm, *state, *thermal])
    began, worst = time.monotonic(), 0
    for lanes in ([first, beside], [[["contact-compare", *compared]]]):
        status = run(lanes)
        if status not in (0, NOT_CONVERGED):  # a step that is not is named in the dataset and the report
            return status
        worst = max(worst, status)
    print(f"\ndone in {time.monotonic() - began:.0f} s; results:", file=sys.stderr, flush=True)
    kept = [*([seeds] if surfaces else []), *([cold, warm] if trajectories else [])]
    print(bem, md, theory, *kept, comparison, *sorted(figures.glob("figure_*.png")), report, sep="\n")
    return worst


def run(lanes: Sequence[Sequence[Sequence[object]]]) -> int:
    """Run lists of the project's commands beside each other, all but the first at the lowest priority.

    The first failure interrupts the others; returned is its status, or else the largest.
    """
    waiting = [[[str(part) for part in command] for command in lane] for lane in lanes]
    running: dict[int, subprocess.Popen[bytes]] = {}
    statuses, failed = [0], 0
    while True:
        try:
            for number in [number for number, command in running.items() if command.poll() is not None]:
                status = running.pop(number).returncode
                statuses.append(status)
                if status not in (0, NOT_CONVERGED) and not failed:
                    failed = status
                    _stop(running.values(), status)
            for number, lane in enumerate(waiting):
                if lane and number not in running and not failed:
                    running[number] = _started(lane.pop(0), behind=number > 0)
            if not running:
                return failed or max(statuses)
            time.sleep(_PAUSE)
        except KeyboardInterrupt:
            continue  # the commands got it too, say how to go on and end


def _stop(others: Iterable["subprocess.Popen[bytes]"], status: int) -> None:
    """Interrupt the commands beside one that failed, which keep what they have finished; Ctrl-C has reached all."""
    if status != INTERRUPTED:
        for other in others:
            other.send_signal(signal.SIGINT)


def _started(command: Sequence[str], behind: bool) -> "subprocess.Popen[bytes]":
    """One of the project's commands, from this interpreter's environment."""
    print(f"\n$ {' '.join(command)}", file=sys.stderr, flush=True)
    executable = str(Path(sys.executable).with_name(command[0]))
    # What the commands print on stdout is named once, at the end; a terminal has room for one bar.
    if not behind:
        return subprocess.Popen([executable, *command[1:]], stdout=subprocess.DEVNULL)
    return subprocess.Popen(
        [executable, *command[1:]],
        stdout=subprocess.DEVNULL,
        env={**os.environ, "TQDM_DISABLE": "1"},
        preexec_fn=lambda: os.nice(_LOWEST_PRIORITY),
    )


if __name__ == "__main__":
    raise SystemExit(main())
