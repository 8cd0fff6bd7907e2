"""Whether a change of the code leaves every number as it was: datasets of a fixed list of studies, before and after.

``freeze`` runs sixty random studies of the continuum, the example studies and small atoms by every method, some minutes
in all; a study whose dataset is there is not run again. ``compare`` reads two such folders: of each variable it finds
the same bits, a difference within 1e-12 of its largest value, or more, which it names.

    python -m research.same_numbers freeze build/before
    python -m research.same_numbers freeze build/after --only random first
    python -m research.same_numbers compare build/before build/after
"""

import argparse
import sys
import tomllib
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

import contact_study
from contact_study.inputs.errors import InputError
from contact_study.study.examples import example
from research.state_checks.drawing import drawn
from scripts.harness import Option, program

RANDOM_STUDIES = 60
CLOSE = 1e-12  # over the largest value of a variable
NO_RESULTS = ("wall_time", "restart")  # a variable, a group: they may differ from run to run
EXAMPLES = {
    "first": ("continuum", "theory", "atomistic"),
    "rubber": ("continuum", "theory"),
    "sphere": ("continuum",),
    "yang2008_quick": ("continuum", "theory", "atomistic"),
}
SMALL = {
    "surface": {
        "kind": "self_affine",
        "size": "83.2 angstrom",
        "shape": [64, 64],
        "hurst_exponent": 0.8,
        "rms_height": "1 angstrom",
        "roll_off_mode": 2,
        "cutoff_mode": 6,
        "seed": 2,
    },
    "material": {
        "youngs_modulus": "77.2 GPa",
        "poissons_ratio": 0.42,
        "lattice_constant": "2.6 angstrom",
        "atom_mass": "197 u",
    },
    "interaction": {
        "well_depth": "18.6 meV",
        "well_depth_ratio": 4,
        "length": "3.28 angstrom",
        "contact_distance": "3.68 angstrom",
    },
    "loading": {"path": ["0.5 GPa", "1 GPa"]},
}
METHODS: dict[str, dict[str, Any]] = {
    "quasi_static": {},
    "overdamped": {},
    "dynamics": {"dynamics": {}},
    "sampling": {"atomistic": {"temperature": "300 K"}, "sampling": {"trajectories": 8, "equilibration": 10}},
}


def studies() -> Iterator[tuple[str, Mapping[str, Any], str]]:
    """Name, table and model of every study."""
    for number in range(RANDOM_STUDIES):
        yield f"random{number:02d}", drawn(number).table | {"output": {"fields": True}}, "continuum"
    for name, models in EXAMPLES.items():
        for model in models:
            yield f"{name}_{model}", tomllib.loads(example(name)), model
    yield "overdamped_continuum", SMALL | {"solver": {"path": "overdamped"}}, "continuum"
    for method, more in METHODS.items():
        yield (
            f"atoms_{method}",
            SMALL | more | {"atomistic": {"method": method} | more.get("atomistic", {})},
            "atomistic",
        )


def freeze(folder: Path, only: tuple[str, ...]) -> None:
    """Write the dataset of every study, or of those whose names begin so; an error is kept in its place."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, table, model in studies():
        path = folder / f"{name}.nc"
        if name.startswith(only) and not path.exists():
            print(name, file=sys.stderr, flush=True)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # grids are coarse on purpose
                try:
                    contact_study.run(table, model, output=path)
                except InputError as error:  # of random constants that fit no solid
                    path.with_suffix(".error").write_text(f"{error}\n")


def difference(one: np.ndarray, other: np.ndarray) -> float:
    """Largest difference of two variables over the largest value of the first: 0 for the same bits."""
    if one.shape != other.shape or one.dtype.kind != other.dtype.kind:
        return np.inf
    floats = one.dtype.kind in "fc"
    if np.array_equal(one, other, equal_nan=floats):
        return 0.0
    if not floats or not np.array_equal(np.isfinite(one), np.isfinite(other)):
        return np.inf
    known = np.isfinite(one)
    largest = np.abs(one[known]).max()
    return float(np.abs(one - other)[known].max() / largest) if largest else np.inf


def variables(path: Path) -> dict[str, np.ndarray]:
    """The results of a dataset, by group and name."""
    with xr.open_datatree(path, decode_timedelta=False, decode_times=False) as tree:
        return {
            f"{node.path.strip('/')}/{name}".strip("/"): values.to_numpy()
            for node in tree.subtree
            for name, values in node.to_dataset(inherit=False).variables.items()
            if not {name, *node.path.split("/")} & {*NO_RESULTS}
        }


def compare(before: Path, after: Path) -> int:
    """Print what differs; 1 if something does."""
    found: Counter[str] = Counter()
    for path in sorted(before.iterdir()):
        other = after / path.name
        if not other.exists():
            print(f"{path.name}: not in {after}")
            found["missing"] += 1
        elif path.suffix == ".nc":
            one, two = variables(path), variables(other)
            for name in sorted(one.keys() | two.keys()):
                apart = difference(one[name], two[name]) if name in one and name in two else np.inf
                verdict = "the same bits" if apart == 0 else f"within {CLOSE:g}" if apart <= CLOSE else "different"
                found[verdict] += 1
                if verdict == "different":
                    where = "only before" if name not in two else "only after" if name not in one else f"{apart:.1e}"
                    print(f"{path.stem}: {name}: {where}")
    print(", ".join(f"{count} {verdict}" for verdict, count in sorted(found.items())) or "nothing to compare")
    return int(bool(found["missing"] or found["different"] or not found))


def run(given: argparse.Namespace) -> int:
    if len(given.folders) != (1 if given.action == "freeze" else 2):
        raise InputError("freeze takes one folder, compare takes two")
    if given.action == "compare":
        return compare(*given.folders)
    freeze(*given.folders, tuple(given.only))
    return 0


main = program(
    run,
    Option("action", str, "what to do", choices=("freeze", "compare")),
    Option("folders", Path, "of datasets", nargs="+"),
    Option("--only", [""], "beginnings of the names of studies"),
    interrupted="finished datasets are kept",
)


if __name__ == "__main__":
    sys.exit(main())
