"""Whether the atoms reach the same states from their own past as from the continuum's gap.

Along one loading path the atoms are solved twice: from separation, each pressure from the atoms' state before it, and
each pressure from the continuum's gap field. The energy has many minima, so the answer may be no; what differs is
printed as Markdown and written to a NetCDF file.

    python -m research.two_starts data/yang2008.toml --pressures "0.1 GPa" "1 GPa" "10 GPa" -o results/two_starts.nc
"""

import argparse
import dataclasses
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

import bem_adhesion.study.model
import md_reference.study.model
from contact_study.campaign.store import files
from contact_study.inputs.errors import InputError
from contact_study.inputs.units import quantity
from contact_study.results.state import InterfaceState
from contact_study.study.case import Case, realise
from contact_study.study.study import read_study
from scripts.harness import STUDY, Option, head, per_cent, program, row

# Name: units and meaning.
VARIABLES = {
    "area_own": ("1", "relative contact area, atoms on their own path from separation"),
    "area_predicted": ("1", "relative contact area, each pressure started from the continuum's gap"),
    "mean_gap_own": ("m", "mean gap above the equilibrium distance, atoms on their own path from separation"),
    "mean_gap_predicted": ("m", "mean gap above the equilibrium distance, started from the continuum's gap"),
    "largest_gap_difference": ("m", "largest difference of the two states' gaps over all atoms"),
    "changed_atoms": ("1", "fraction of atoms in contact in one of the two states only"),
    "energy_difference": ("J m-2", "energy of the predicted state less that of the own path, load included, per area"),
    "evaluations_own": ("1", "evaluations of the interface, own path"),
    "evaluations_predicted": ("1", "evaluations of the interface, from the continuum's gap"),
    "converged": ("1", "1 where both states converged"),
}

COLUMNS = [
    "ε/ε₀",
    "p (GPa)",
    "A own",
    "A from continuum",
    "ΔA",
    "Δū (Å)",
    "max\\|Δu\\| (Å)",
    "atoms changed",
    "ΔE (mJ/m²)",
    "evaluations",
]


def run(given: argparse.Namespace) -> None:
    pressures = [quantity(text, "Pa", "--pressures") for text in given.pressures]
    given.output.parent.mkdir(parents=True, exist_ok=True)
    files.writable_output(given.output)
    rows = []
    print(head(*COLUMNS))
    for ratio in given.ratios:
        for pressure, state in zip(pressures, compare(case_of(given, ratio, pressures)), strict=True):
            rows.append(state)
            print(_line(ratio, pressure, state), flush=True)
    print(f"\n{conclusion(rows)}")
    shape = (len(given.ratios), len(pressures))
    dataset = xr.Dataset(
        {
            name: (
                ("well_depth_ratio", "pressure"),
                np.reshape([state[name] for state in rows], shape),
                {"units": units, "long_name": meaning},
            )
            for name, (units, meaning) in VARIABLES.items()
        },
        coords={
            "well_depth_ratio": ("well_depth_ratio", given.ratios, {"units": "1", "long_name": "ε over the study's"}),
            "pressure": ("pressure", pressures, {"units": "Pa", "long_name": "mean pressure"}),
        },
        attrs={"title": "Atoms from their own past and from the continuum's gap", "study": given.study.name},
    )
    files.write_aside(given.output, dataset.to_netcdf)
    print(given.output, file=sys.stderr)


def compare(case: Case) -> Iterator[dict[str, float]]:
    """What differs between the two states at each point of a case's path, by the names of ``VARIABLES``."""
    surface = realise(case)
    gaps = [
        None if state.report.detached else state.gap for state in bem_adhesion.study.model.solve_path(case, surface)
    ]
    own = md_reference.study.model.solve_path(case, surface)
    predicted = md_reference.study.model.solve_path(case, surface, predictor=gaps.__getitem__)
    for (pressure, _), first, second in zip(case.path, own, predicted, strict=True):
        if first.report.detached or second.report.detached:
            raise InputError(f"--pressures: {pressure:g} Pa pulls the atoms off; give states in contact")
        yield {
            "area_own": float(np.mean(first.contact)),
            "area_predicted": float(np.mean(second.contact)),
            "mean_gap_own": float(np.mean(first.gap)) - first.equilibrium_distance,
            "mean_gap_predicted": float(np.mean(second.gap)) - second.equilibrium_distance,
            "largest_gap_difference": float(np.max(np.abs(second.gap - first.gap))),
            "changed_atoms": float(np.mean(first.contact != second.contact)),
            "energy_difference": _energy(second, pressure) - _energy(first, pressure),
            "evaluations_own": first.report.force_evaluations,
            "evaluations_predicted": second.report.force_evaluations,
            "converged": first.report.converged and second.report.converged,
        }


def conclusion(rows: Sequence[dict[str, float]]) -> str:
    """How many states differ, by how much, and which of two has the lower energy."""
    different = [row for row in rows if row["changed_atoms"] > 0]
    if not different:
        return f"The two starts end in the same state at all {len(rows)} points."
    areas = [row["area_predicted"] / row["area_own"] - 1 for row in different]
    lower = sum(row["energy_difference"] < 0 for row in different)
    return (
        f"The two starts end in different states at {len(different)} of {len(rows)} points, by "
        f"{100 * min(areas):+.2f} to {100 * max(areas):+.2f} % of the area; at {lower} of them the state from the "
        "continuum has the lower energy."
    )


def _energy(state: InterfaceState, pressure: float) -> float:
    """Elastic and interaction energy with the work of the load on the mean separation, per area (J/m²)."""
    return state.elastic_energy + state.interaction_energy + pressure * state.mean_separation


def case_of(given: argparse.Namespace, ratio: float, pressures: Sequence[float]) -> Case:
    """The one surface of a study at one adhesion, under these pressures (Pa)."""
    overrides = {"interaction.well_depth_ratio": ratio}
    if given.seed is not None:
        overrides["surface.seed"] = given.seed
    cases = read_study(given.study, overrides).cases
    if len(cases) != 1:
        raise InputError(f"{given.study}: sweeps more than the well depth; give a study of one surface")
    loading = dataclasses.replace(cases[0].loading, control="pressure", path=tuple(pressures), unload=False)
    case = dataclasses.replace(cases[0], loading=loading)
    md_reference.study.model.check(case)
    return case


def _beyond_rounding(difference: float) -> str:
    """A difference of gaps (Å); the residual leaves some 1e-8 Å between equal states."""
    return f"{difference:.2f}" if difference >= 0.005 else "0"


def _line(ratio: float, pressure: float, state: dict[str, float]) -> str:
    area, shift = state["area_own"], state["mean_gap_predicted"] - state["mean_gap_own"]
    return row(
        f"{ratio:g}",
        f"{pressure / 1e9:g}",
        f"{area:.4f}",
        f"{state['area_predicted']:.4f}",
        per_cent(state["area_predicted"], area, 2),
        f"{1e10 * shift:+.4f}",
        _beyond_rounding(1e10 * state["largest_gap_difference"]),
        f"{100 * state['changed_atoms']:.2f} %",
        f"{1e3 * state['energy_difference']:+.3f}",
        f"{state['evaluations_own']}, {state['evaluations_predicted']}",
    )


main = program(
    run,
    STUDY,
    Option("--ratios", [1.0, 4.0, 8.0], "multiples of the well depth"),
    Option("--pressures", ["0.1 GPa", "1 GPa", "10 GPa"], "the loading path"),
    Option("--seed", int, "surface, in place of the study's"),
    Option("-o, --output", Path("results/two_starts.nc"), ""),
)

if __name__ == "__main__":
    sys.exit(main())
