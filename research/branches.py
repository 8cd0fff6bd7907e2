"""Which of its many states a contact is loaded into: the same path by equilibria, by slow flow and by Newton's law.

Beside them "after 3 GPa": equilibria on the way back, of a contact that was pressed harder before.

Area and mean gap of atoms and continuum along one loading path from separation, by every way of going it. Rows that
the file has already are not computed again, so that ways, sizes and surfaces can be added one after the other.

    python -m research.branches data/yang2008.toml --atoms 200 --seeds 1 2 3 -o data/branches.csv
    python -m research.branches --from data/branches.csv --pressures "0.1 GPa" "1 GPa" "10 GPa"
"""

import argparse
import itertools
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

import contact_study
from contact_study.inputs.errors import InputError
from contact_study.inputs.units import quantity
from contact_study.study.study import Study, read_study
from scripts.harness import STUDY, Option, head, minus, program, read_rows, row, shrunk, write_rows

PRESSURES = ("0.1 GPa", "0.2 GPa", "0.5 GPa", "1 GPa", "2 GPa", "5 GPa", "10 GPa")
_SMALL = 5  # small steps from one pressure to the next
_PRESSED, _BACK = 3e9, "after 3 GPa"
# Motion by Newton's law: friction so weak that the block's longest wave rings, at each pressure for as long as it does,
# on larger blocks in proportion. The time step is a third of the largest stable one: half of it is too long for the
# impact at 8 ε0.
_NEWTON = {"damping": "0.1 ps^-1", "time_step": "20 fs", "frames": 20}
_RINGING_PS, _ON_ATOMS = 120, 200

SECTIONS: dict[str, dict[str, Any]] = {
    "steps": {},
    "small steps": {},
    _BACK: {},
    "flow 1e-2": {"overdamped": {"loading_rate": 1e-2}},
    "flow 1e-3": {"overdamped": {"loading_rate": 1e-3}},
    "flow 1e-3, half the error": {"overdamped": {"loading_rate": 1e-3, "step_error": 0.05}},
    "Newton 100 m/s": {"dynamics": {**_NEWTON, "approach_speed": "100 m/s"}},
    "Newton 300 m/s": {"dynamics": {**_NEWTON, "approach_speed": "300 m/s"}},
}
POINT = ["model", "atoms", "seed", "ratio", "pressure_GPa"]
# To the digits that the table has.
_SAME_AREA, _SAME_GAP = 5e-5, 5e-4
KEYS = [*POINT, "way"]
NAMES = {"atomistic": "atoms", "continuum": "continuum"}


def run(given: argparse.Namespace) -> None:
    if given.source is not None:
        table = pd.read_csv(given.source)
    else:
        table, study = read_rows(given.output, KEYS), read_study(given.study)
        for one in itertools.product(given.models, given.ratios, given.seeds, given.ways):
            table = _with(table, study, given, *one)
    print("\n".join(lines(table, [quantity(text, "Pa", "--pressures") / 1e9 for text in given.pressures])))


def _with(
    table: pd.DataFrame, study: Study, given: argparse.Namespace, model: str, ratio: float, seed: int, way: str
) -> pd.DataFrame:
    """The table with the rows of one more run, also on disk."""
    if model == "continuum" and way.startswith("Newton"):
        return table
    same = table[(table.model == model) & (table.atoms == given.atoms) & (table.seed == seed)]
    same = same[(same.ratio == ratio) & (same.way == way)]
    pressures = [quantity(text, "Pa", "--pressures") for text in given.pressures]
    if way == _BACK:
        pressures = [pressure for pressure in pressures if pressure < _PRESSED]
    if {round(pressure / 1e9, 6) for pressure in pressures} <= set(same.pressure_GPa):
        return table
    found = pd.DataFrame(walked(study, model, given.atoms, ratio, seed, way, pressures))
    table = pd.concat([table, found], ignore_index=True).drop_duplicates(KEYS, keep="last").sort_values(KEYS)
    write_rows(table, given.output)
    return table


def _path(way: str, pressures: Sequence[float]) -> list[float]:
    """The loading path (Pa) of one way; what counts is the state where it is last at a pressure."""
    if way == "small steps":
        starts = [0.0, *pressures[:-1]]
        return [
            low + (high - low) * step / _SMALL
            for low, high in zip(starts, pressures, strict=True)
            for step in range(1, _SMALL + 1)
        ]
    if way == _BACK:
        return [*pressures, _PRESSED, *pressures[::-1]]
    return list(pressures)


def walked(
    study: Study, model: str, atoms: int, ratio: float, seed: int, way: str, pressures: Sequence[float]
) -> Iterator[dict[str, Any]]:
    """The states at the pressures (Pa), by one way."""
    scaled = shrunk(study, atoms / study.cases[0].lattice.atoms[1])
    table = {name: dict(keys) for name, keys in scaled.items() if name not in ("sweep", "override")}
    table["surface"]["seed"] = seed
    table["interaction"]["well_depth_ratio"] = ratio
    path = _path(way, pressures)
    table["loading"] = {"path": path}
    table["output"] = {}
    # An equilibrium of a strong adhesion may take many steps; a flow takes more.
    table["solver"] = {"max_iterations": 20000, "path": "overdamped" if way.startswith("flow") else "quasi_static"}
    method = {"flow": "overdamped", "Newton": "dynamics"}.get(way.split()[0], "quasi_static")
    table |= {"atomistic": {"method": method}, **SECTIONS[way]}
    if method == "dynamics":
        table["dynamics"] = table["dynamics"] | {"duration": f"{_RINGING_PS * max(1, atoms / _ON_ATOMS):g} ps"}
    dataset = contact_study.run(table, model)
    for pressure in pressures:
        state = dataset.isel(step=len(path) - 1 - path[::-1].index(pressure))
        yield {
            "model": model,
            "atoms": atoms,
            "seed": seed,
            "ratio": ratio,
            "way": way,
            "pressure_GPa": round(pressure / 1e9, 6),
            "area": state.relative_contact_area.item(),
            "mean_gap_A": state.mean_gap.item() * 1e10,
            "converged": state.converged.item(),
            "fft_pairs": state.fft_pairs.item(),
        }


def lines(table: pd.DataFrame, pressures: Sequence[float]) -> Iterator[str]:
    """The table as Markdown: the mean state by steps, and by how much the other ways differ, and where they do most."""
    if table.empty:
        raise InputError("nothing to print: no run has been made")
    ways = [way for way in SECTIONS if way != "steps" and way in set(table.way)]
    yield head("", "atoms (surfaces)", "ε/ε₀", "p (GPa)", "steps: A; ū (Å)", *ways)
    steps = table[table.way == "steps"].set_index(POINT)
    own = steps.rename(columns={"area": "by_steps", "mean_gap_A": "gap_by_steps"})[["by_steps", "gap_by_steps"]]
    others = table[table.way != "steps"].join(own, on=POINT)
    others = others.assign(d_area=others.area - others.by_steps, d_gap=others.mean_gap_A - others.gap_by_steps)
    others = others.dropna(subset="d_area")
    shown = table[table.pressure_GPa.isin([round(pressure, 6) for pressure in pressures])]
    for group, here in shown.groupby(["model", "atoms", "ratio", "pressure_GPa"]):
        model, atoms, ratio, pressure = group
        state = here[here.way == "steps"]
        known = others.set_index(["model", "atoms", "ratio", "pressure_GPa"]).sort_index()
        own = known.loc[[group]] if group in known.index else known.iloc[:0]
        cells = [_largest(own[own.way == way]) for way in ways]
        by_steps = minus(f"{state.area.mean():.4f}; {state.mean_gap_A.mean():.3f}")
        surfaces = f"{atoms}² ({state.seed.nunique()})"
        yield row(NAMES[str(model)], surfaces, f"{ratio:g}", f"{pressure:g}", by_steps, *cells)
    yield ""
    for way in ways:
        one = others[others.way == way]
        alike = (one.d_area.abs() < _SAME_AREA) & (one.d_gap.abs() < _SAME_GAP)
        sentence = f"- {way}: the same in {alike.sum()} of {len(one)} states"
        if not alike.all():
            worst = one.iloc[one.d_area.abs().argmax()]
            sentence += (
                f"; the area differs by {minus(f'{worst.d_area:+.4f}')} at most ({NAMES[worst.model]}, "
                f"{worst.atoms}², surface {worst.seed}, {worst.ratio:g} ε₀, {worst.pressure_GPa:g} GPa), the mean "
                f"gap by {one.d_gap.abs().max():.3f} Å"
            )
        yield sentence + "."


def _largest(own: pd.DataFrame) -> str:
    """The largest difference over the surfaces of area and mean gap, with the sign of each."""
    if own.empty:
        return ""
    area, gap = (own[name].iloc[own[name].abs().argmax()] for name in ("d_area", "d_gap"))
    same = abs(area) < _SAME_AREA and abs(gap) < _SAME_GAP
    return ("=" if same else minus(f"{area:+.4f}; {gap:+.3f}")) + ("" if own.converged.all() else " (moving)")


main = program(
    run,
    STUDY,
    Option("--models", ["atomistic", "continuum"], "", choices=("atomistic", "continuum")),
    Option("--ways", ["steps", "small steps", "flow 1e-3"], "", choices=tuple(SECTIONS)),
    Option("--atoms", 200, "atoms a side: the study's slopes in a smaller cell"),
    Option("--seeds", [1], "surfaces"),
    Option("--ratios", [1.0, 4.0, 8.0], "multiples of the well depth"),
    Option("--pressures", list(PRESSURES), "the loading path; what is shown of a CSV"),
    Option("-o, --output", Path, "CSV to add to"),
    Option("--from", Path, "CSV to print, in place of a run"),
    interrupted="finished runs are kept",
)

if __name__ == "__main__":
    sys.exit(main())
