"""Mutation testing of the numerical modules: what changes to operators, numbers and branches the tests do not notice.

Each mutant is one change that Cosmic Ray makes to one module; the tests of the module's package run on it, its own test
file first, until one fails. ``make mutants`` runs a sample of each package; the score is printed and what survived goes
to ``build/mutants/<package>.txt``, to be read by a person: a survivor is either equivalent to the original or a test
that is missing.

The mutants are made in a copy of the working tree, so that nothing here is touched. Compiled kernels reach the tests:
Numba's cache is of a source file by its content, modules with a kernel that other files call have a cache for each
mutant, and Python's own cache, whose times are whole seconds, is off. A mutant that hangs is killed after several times
what the tests take.

Usage: ``python -m scripts.mutants theory bem_adhesion --sample 100 --seed 1``; ``--sample 0`` runs all.
"""

import argparse
import os
import random
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from cosmic_ray.work_db import WorkDB, use_db
from cosmic_ray.work_item import MutationSpec, TestOutcome, WorkerOutcome, WorkResult

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "mutants"
PACKAGES = {
    "contact_study/inputs": "tests/study",
    "theory": "tests/theory",
    "bem_adhesion": "tests/bem_adhesion",
    "md_reference": "tests/md_reference",
    "contact_study/study": "tests/study",
    "contact_study/physics": "tests/study tests/numerics tests/bem_adhesion tests/theory",
    "contact_study/numerics": "tests/numerics",
    "contact_study/results": "tests/results",
}
# Tests of a module, the quickest to fail first, "" for the whole package; by default its own file, then the package.
TESTS = {
    "theory/study/case_theories.py": "test_run.py",
    "theory/study/paths.py": "test_run.py",
    "theory/study/model.py": "test_run.py",
    "theory/non_adhesive/closed_forms.py": "test_persson.py test_separation.py",
    "theory/gap_flow/flow.py": "test_gap_flow.py test_run.py",
    "theory/gap_flow/state.py": "test_gap_flow.py test_run.py",
    "theory/gap_flow/kernels.py": "test_gap_flow.py",
    "theory/persson/theory.py": "test_persson.py test_separation.py test_run.py",
    "theory/persson/interface.py": "test_persson.py test_separation.py",
    "theory/persson/separation.py": "test_separation.py test_run.py",
    "theory/persson/diffusion.py": "test_stress_diffusion.py test_persson.py",
    "bem_adhesion/hard_wall/active_set.py": "test_hard_wall.py ",
    "bem_adhesion/hard_wall/kernels.py": "test_hard_wall.py ",
    "bem_adhesion/linear/conjugate_gradients.py": "test_loading.py ",
    "bem_adhesion/adhesive/multigrid.py": "test_loading.py ",
    "bem_adhesion/kernels/law.py": "test_kernels.py ",
    "md_reference/statics/atomwise.py": "test_linear.py ",
    "contact_study/physics/process_zone.py": "test_automatic.py test_studies.py",
    "contact_study/physics/height_maps/preparation.py": "test_map_preparation.py ",
    "contact_study/physics/height_maps/height_map.py": "test_surface.py test_map_files.py",
    "contact_study/physics/height_maps/text.py": "test_map_files.py ",
    "contact_study/inputs/number_tables.py": "test_map_files.py test_force_curves.py",
    "contact_study/physics/force_curves/curve.py": "test_force_curves.py ",
    "contact_study/physics/force_curves/columns.py": "test_force_curves.py ",
    "contact_study/physics/spheres/base.py": "test_spheres.py ",
    "contact_study/physics/spheres/maugis.py": "test_spheres.py test_references.py",
    "contact_study/physics/roughness/statistics.py": "test_spectrum.py ",
    "contact_study/physics/surfaces/surface.py": "test_map_files.py test_surface.py",
    "contact_study/physics/laws/base.py": "test_laws.py ",
    "contact_study/physics/laws/lennard_jones.py": "test_laws.py ",
}
# Modules with a kernel that is compiled into kernels of other files.
CALLED_ELSEWHERE = ("md_reference/block/verlet.py", "theory/numerics/tridiagonal.py")
# The options of the project leave out longer tests.
TEST = f"{sys.executable} -m pytest -o addopts=--import-mode=importlib -x -q -p no:xdist -p no:cacheprovider"
TEST += " --no-header --tb=no"
# Left out: changes that end in an error wherever the line is reached (// and shifts of floats), twins of others (+x for
# −x without its sign), decorators, and annotations' unions.
OPERATORS_LEFT_OUT = (
    "core/ReplaceBinaryOperator_.*_(FloorDiv|Mod|RShift|LShift|BitOr|BitAnd|BitXor)$",
    "core/ReplaceBinaryOperator_Bit(Or|Xor)_",
    "core/ReplaceBinaryOperator_(Add|Sub|Mul|Div)_Pow$",
    "core/ReplaceUnaryOperator_.*_(UAdd|Invert|Not)$",
    "core/ReplaceComparisonOperator_.*_(Is|IsNot|In|NotIn)$",
    "core/RemoveDecorator",
    "core/ExceptionReplacer",
)
# Lines left out: what their flags change is not a result (frozen classes, Numba's cache, lengths that agree).
LEFT_OUT = "line left out"
LINES_LEFT_OUT = re.compile(r"@dataclass|@njit|strict=True")


@dataclass(frozen=True)
class Score:
    """What became of the mutants of one package."""

    package: str
    made: int
    killed: int
    survivors: tuple[str, ...]

    @property
    def tried(self) -> int:
        return self.killed + len(self.survivors)

    def __str__(self) -> str:
        share = 100 * self.killed / max(self.tried, 1)
        return f"{self.package}: {self.killed} of {self.tried} killed ({share:.0f} %), of {self.made} mutants"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("packages", nargs="*", metavar="PACKAGE", help=f"of {', '.join(PACKAGES)}; default all")
    parser.add_argument("--module", help="only files whose name contains this")
    parser.add_argument(
        "--sample", type=int, default=60, help="mutants a package, drawn at random; 0: all (default 60)"
    )
    parser.add_argument("--seed", type=int, default=1, help="seed of the sample (default 1)")
    chosen = parser.parse_args()
    unknown = set(chosen.packages) - set(PACKAGES)
    if unknown:
        parser.error(f"{', '.join(sorted(unknown))}: expected {', '.join(PACKAGES)}")
    for package in chosen.packages or PACKAGES:
        print(run(package, chosen.module or "", chosen.sample, chosen.seed), flush=True)
    return 0


def run(package: str, part: str, sample: int, seed: int) -> Score:
    """Try mutants of a package and write down the survivors."""
    copy = copied_tree(package)
    sessions = list(prepared(package, part, copy, seconds_unchanged(package, copy)))
    keep_sample(sessions, sample, seed)
    for session in sessions:
        with use_db(session, WorkDB.Mode.open) as database:
            idle = not any(database.pending_work_items)
        if not idle:
            call("cosmic-ray", "exec", f"{session.stem}.toml", session.name, folder=copy)
    score = scored(package, sessions)
    (BUILD / f"{package.replace('/', '-')}.txt").write_text("\n".join((str(score), *score.survivors)) + "\n")
    return score


def copied_tree(package: str) -> Path:
    """A fresh copy of all files that git knows or would add."""
    copy = BUILD / package.replace("/", "-")
    shutil.rmtree(copy, ignore_errors=True)
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True
    )
    for name in listed.stdout.splitlines():
        if (ROOT / name).is_file():
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, copy / name)
    return copy


def seconds_unchanged(package: str, copy: Path) -> float:
    """Time of the package's tests on the unchanged copy; ends the run if they fail or test something else."""
    code = f"import {package.replace('/', '.')} as package; print(*package.__path__)"
    used = call(sys.executable, "-c", code, folder=copy)
    if Path(used.strip()) != copy / package:
        sys.exit(f"the tests would import {used}, not the copy {copy}")
    began = time.monotonic()
    call(*TEST.split(), *PACKAGES[package].split(), folder=copy)
    return time.monotonic() - began


def prepared(package: str, part: str, copy: Path, seconds: float) -> Iterator[Path]:
    """A Cosmic Ray session for each module of the package."""
    for module in sorted((copy / package).rglob("*.py")):
        name = module.relative_to(copy).as_posix()
        if module.name == "__init__.py" or part not in name:
            continue
        command = " ".join((TEST, *tests_of(package, name, copy)))
        if name in CALLED_ELSEWHERE:
            command = f"sh -c 'NUMBA_CACHE_DIR=$(mktemp -dp .) {command}'"
        stem = name.removesuffix(".py").replace("/", "-")
        (copy / f"{stem}.toml").write_text(
            f"""[cosmic-ray]
module-path = "{name}"
timeout = {4 * seconds + 60:.0f}
excluded-modules = []
test-command = "{command}"

[cosmic-ray.distributor]
name = "local"

[cosmic-ray.filters.operators-filter]
exclude-operators = {list(OPERATORS_LEFT_OUT)!r}
"""
        )
        call("cosmic-ray", "init", f"{stem}.toml", f"{stem}.sqlite", folder=copy)
        call("cr-filter-operators", f"{stem}.sqlite", f"{stem}.toml", folder=copy)
        yield copy / f"{stem}.sqlite"


def tests_of(package: str, module: str, copy: Path) -> list[str]:
    """Files and folders of the tests of a module, in the order in which they run."""
    names = TESTS.get(module, f"test_{Path(module).name} ").split(" ")
    paths = (Path(folder) / name for name in names for folder in PACKAGES[package].split())
    return [str(path) for path in paths if (copy / path).exists()]


def keep_sample(sessions: list[Path], sample: int, seed: int) -> None:
    """Leave ``sample`` mutants of all sessions together to be tried."""
    pending = {}
    for session in sessions:
        with use_db(session, WorkDB.Mode.open) as database:
            items = {item.job_id: item.mutations[0] for item in database.pending_work_items}
            same = [job for job, mutation in items.items() if LINES_LEFT_OUT.search(line_of(mutation, session.parent))]
            database.set_multiple_results(same, WorkResult(worker_outcome=WorkerOutcome.SKIPPED, output=LEFT_OUT))
            # Their identifiers are drawn anew each time: the place in the source makes the sample repeatable.
            pending |= {(str(session), *place(items[job])): job for job in items if job not in set(same)}
    drawn = random.Random(seed).sample(sorted(pending), min(sample or len(pending), len(pending)))
    left = WorkResult(worker_outcome=WorkerOutcome.SKIPPED, output="not drawn")
    for session in sessions:
        with use_db(session, WorkDB.Mode.open) as database:
            rest = [job for key, job in pending.items() if key[0] == str(session) and key not in set(drawn)]
            database.set_multiple_results(rest, left)


def line_of(mutation: MutationSpec, copy: Path) -> str:
    return (copy / mutation.module_path).read_text().splitlines()[mutation.start_pos[0] - 1]


def place(mutation: MutationSpec) -> tuple[int, int, str, int]:
    return (*mutation.start_pos, mutation.operator_name, mutation.occurrence)


def scored(package: str, sessions: list[Path]) -> Score:
    made = killed = 0
    survivors = []
    for session in sessions:
        with use_db(session, WorkDB.Mode.open) as database:
            items = {item.job_id: item.mutations[0] for item in database.work_items}
            for job, result in database.results:
                made += result.output not in (LEFT_OUT, "Filtered operator")
                killed += result.test_outcome is TestOutcome.KILLED
                if result.test_outcome is TestOutcome.SURVIVED:
                    survivors.append(described(items[job], result.diff))
    return Score(package, made, killed, tuple(survivors))


def described(mutation: MutationSpec, difference: str) -> str:
    changed = [line for line in difference.splitlines() if line[:1] in "+-" and line[:3] not in ("+++", "---")]
    lines = "\n".join(f"    {line}" for line in changed)
    return f"{mutation.module_path}:{mutation.start_pos[0]} {mutation.operator_name}\n{lines}"


def call(*command: str, folder: Path) -> str:
    """Output of a command of this environment in the copy; ends the run with it if the command fails."""
    binaries = Path(sys.executable).parent
    program = str(binaries / command[0]) if (binaries / command[0]).exists() else command[0]
    environment = os.environ | {"PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run([program, *command[1:]], cwd=folder, env=environment, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(command)}: status {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout


if __name__ == "__main__":
    sys.exit(main())
