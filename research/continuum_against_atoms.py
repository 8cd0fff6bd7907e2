"""By how much continuum and atoms differ on the same surface, and why.

Between the two stand models that change one thing at a time: the modulus as the lattice shows it, the work of adhesion
of the cut-off pair potential, the lattice's dispersion, the minimiser (which must change nothing), the distance normal
to the substrate instead of the vertical one, Lennard-Jones pairs instead of smeared layers, and at last the lateral
freedom of the atoms. Every one of them starts from the gap of the continuum at the same pressure, so that all are on
one branch. The tables are printed as Markdown and written to a NetCDF file.

    python -m research.continuum_against_atoms data/yang2008.toml --pressures "1 GPa"
"""

import argparse
import dataclasses
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

import md_reference.study.model
from bem_adhesion.adhesive.contact import AdhesiveContact
from bem_adhesion.solution import Outcome as ContinuumOutcome
from contact_study.campaign.store import files
from contact_study.inputs.errors import InputError
from contact_study.inputs.units import quantity
from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.physics.laws.base import TractionLaw
from contact_study.physics.solids import Elasticity, HalfSpace, Tabulated
from contact_study.physics.surfaces.surface import Surface
from contact_study.study.case import Case, realise
from md_reference.block.condensed import SurfaceStiffness
from md_reference.interface.pairs import LennardJonesInterface
from md_reference.statics import newton
from md_reference.statics.energy import BlockEnergy
from md_reference.study.system import build_contact
from research.two_starts import case_of
from scripts.harness import STUDY, Option, head, program, row

# Each model, and what sets it apart from the one before.
MODELS = {
    "continuum": "elastic half-space and 10-4 law, constants of the study",
    "measured_modulus": "modulus that the lattice shows to this surface",
    "measured_adhesion": "work of adhesion of the cut-off pair potential",
    "lattice_stiffness": "stiffness of the lattice at every wavevector",
    "other_minimiser": "same equations, minimiser of the atoms",
    "tilted_law": "distance normal to the tilted substrate",
    "pair_sums": "Lennard-Jones pairs, atoms on vertical rails",
    "atoms": "lateral freedom of the atoms",
}
QUANTITIES = {
    "relative_contact_area": ("1", "relative contact area, gap below the contact distance"),
    "mean_gap": ("m", "mean gap above the equilibrium distance"),
    "converged": ("1", "1 where the state is an equilibrium within the tolerance"),
    "relative_contact_area_increment": ("1", "change of the relative contact area from the model before"),
    "mean_gap_increment": ("m", "change of the mean gap from the model before"),
}
CONSTANTS = {
    "contact_modulus": ("Pa", "contact modulus of the study"),
    "measured_contact_modulus": ("Pa", "contact modulus of the lattice, weighted by q|h_q|² of the surface"),
    "work_of_adhesion": ("J m-2", "work of adhesion of two smeared layers"),
    "measured_work_of_adhesion": ("J m-2", "work of adhesion of two flat layers of atoms"),
}


class SmearedLayers:
    """The traction-separation law on each atom's area, as the atoms' minimiser takes it.

    Over a substrate tilted by θ an atom at the vertical gap u is at the distance u cos θ from a layer whose sites are
    as dense per projected area as ever, thus cos θ times as dense in their plane: its energy is cos θ φ(u cos θ) a².

    Heights (m) and cos θ are those under the atoms' rest positions; a cosine of one leaves the law on the vertical gap.
    """

    def __init__(self, law: TractionLaw, heights: np.ndarray, area_per_atom: float, cosine: np.ndarray):
        self.law = law
        self.length = law.length
        self.cutoff = math.inf
        self.heights = heights
        self.area_per_atom = area_per_atom
        self.cosine = cosine

    def evaluate_some(
        self, displacement: np.ndarray, due: np.ndarray, force: np.ndarray, hessian: np.ndarray, energy: np.ndarray
    ) -> bool:
        """Forces, second derivatives and energies of some atoms; False where a gap is closed."""
        gap = self.gap(displacement)[due]
        if not gap.min() > 0.3 * self.length:  # as the atoms' own interface
            return False
        law, cosine, area = self.law, self.cosine[due], self.area_per_atom
        distance = cosine * gap
        force[:, due] = 0.0
        force[2, due] = -area * cosine**2 * law.traction(distance)
        hessian[:, due] = 0.0
        hessian[2, due] = area * cosine**3 * law.stiffness(distance)
        energy[due] = area * cosine * law.potential(distance)
        return True

    def gap(self, displacement: np.ndarray) -> np.ndarray:
        """Vertical gap at the rest positions (m)."""
        return displacement[2] - self.heights

    def gap_and_cosine(self, displacement: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """That and cos θ."""
        return self.gap(displacement), self.cosine

    @property
    def force_prefactor(self) -> float:
        """Of the 10-4 law, on an atom's area (N)."""
        return self.area_per_atom * 20 * self.law.work_of_adhesion / (3 * self.length)


def without_lateral_freedom(stiffness: SurfaceStiffness) -> SurfaceStiffness:
    """A block with the same normal compliance whose bottom atoms cannot move sideways."""
    coefficients = np.zeros_like(stiffness.coefficients)
    # Stiff beyond any force of the interface; the value only keeps the matrix invertible.
    coefficients[:2] = 1e6 * np.max(stiffness.coefficients)
    coefficients[2] = stiffness.area_per_atom * stiffness.normal_stiffness
    return dataclasses.replace(stiffness, coefficients=coefficients)


class OnRails:
    """An interface whose forces along the surface the rails take up."""

    def __init__(self, interaction: LennardJonesInterface):
        self._interaction = interaction
        self.length = interaction.length
        self.cutoff = interaction.cutoff
        self.force_prefactor = interaction.force_prefactor
        self.gap = interaction.gap
        self.gap_and_cosine = interaction.gap_and_cosine

    def evaluate_some(
        self, displacement: np.ndarray, due: np.ndarray, force: np.ndarray, hessian: np.ndarray, energy: np.ndarray
    ) -> bool:
        """As the interface, but of force and second derivatives the normal ones."""
        outside = self._interaction.evaluate_some(displacement, due, force, hessian, energy)
        force[:2] = 0.0
        hessian[[0, 1, 3, 4, 5]] = 0.0
        return outside


def run(given: argparse.Namespace) -> None:
    pressures = [quantity(text, "Pa", "--pressures") for text in given.pressures]
    given.output.parent.mkdir(parents=True, exist_ok=True)
    files.writable_output(given.output)
    cases = [case_of(given, ratio, pressures) for ratio in given.ratios]
    surface = realise(cases[0])
    measured = [constants(case, surface) for case in cases]
    states = [solve(case, surface, values) for case, values in zip(cases, measured, strict=True)]
    dataset = _dataset(given, pressures, states, measured)
    for pressure in pressures:
        print(table(dataset.sel(pressure=pressure)), flush=True)
    if len(given.ratios) * len(pressures) > 1:
        print(ranges(dataset))
    print(constants_in_words(dataset))
    files.write_aside(given.output, dataset.to_netcdf)
    print(given.output, file=sys.stderr)


def cosine_of_tilt(heights: np.ndarray, grid: Grid) -> np.ndarray:
    """1/√(1 + |∇h|²) of a surface sampled on a grid."""
    heights_q = fourier.transform(heights)
    gradient = [fourier.synthesise(1j * q * heights_q, grid.shape) for q in grid.wavevectors]
    return 1 / np.sqrt(1 + gradient[0] ** 2 + gradient[1] ** 2)


def solve(case: Case, surface: Surface, measured: dict[str, float]) -> list[list[tuple[float, float, bool]]]:
    """Relative contact area, mean gap (m) and convergence of every model (inner) at every pressure (outer)."""
    contact = build_contact(case, surface)
    stiffness, pairs = contact.block, contact.interface
    heights = surface.heights(case.lattice.atoms)
    grid = Grid(
        case.lattice.atoms, surface.size
    )  # the continuum's too: discretisation is no difference between the models
    adhesion = dataclasses.replace(case.law, work_of_adhesion=measured["measured_work_of_adhesion"])
    modulus = measured["measured_contact_modulus"]
    lattice = Tabulated(modulus, grid, stiffness.normal_stiffness)

    def continuum(solid: Elasticity, law: TractionLaw) -> AdhesiveContact:
        given = case.solver
        return AdhesiveContact(
            heights, grid, solid, law, tolerance=given.tolerance, max_iterations=given.max_iterations
        )

    smeared, tilted = (
        SmearedLayers(adhesion, heights, stiffness.area_per_atom, cosine)
        for cosine in (np.ones(case.lattice.atoms), cosine_of_tilt(heights, grid))
    )
    railed = without_lateral_freedom(stiffness)
    first = continuum(case.solid, case.law)
    shown = HalfSpace(modulus)
    continua = [continuum(shown, case.law), continuum(shown, adhesion), continuum(lattice, adhesion)]
    minimisers = [
        BlockEnergy(block, interaction, case.material.contact_modulus, False)
        for block, interaction in ((railed, smeared), (railed, tilted), (railed, OnRails(pairs)), (stiffness, pairs))
    ]
    found = []
    displacement = first.separated()
    for pressure in case.loading.path:
        start = first.step(displacement, pressure)
        displacement = start.displacement
        if start.outcome is ContinuumOutcome.DETACHED:
            raise InputError(f"--pressures: {pressure:g} Pa pulls the continuum off; give a state in contact")
        limits = case.solver.tolerance, case.solver.max_iterations
        solutions = [start, *(other.step(displacement, pressure) for other in continua)]
        above = contact.predicted(start.gap)
        solutions += [newton.solve(energy, above, pressure, *limits) for energy in minimisers]
        found.append([_state(solution, case) for solution in solutions])
    return found


def _state(solution: Any, case: Case) -> tuple[float, float, bool]:
    gap, converged = solution.gap, solution.converged and not solution.detached
    return float(np.mean(gap < case.contact_distance)), float(np.mean(gap)) - case.law.length, converged


def constants(case: Case, surface: Surface) -> dict[str, float]:
    """Modulus and work of adhesion as the study gives them and as the atoms have them."""
    measured = md_reference.study.model.constants(case, surface)
    return {
        "contact_modulus": case.material.contact_modulus,
        "measured_contact_modulus": measured["contact_modulus"],
        "work_of_adhesion": case.work_of_adhesion,
        "measured_work_of_adhesion": measured["work_of_adhesion"],
    }


def _dataset(
    given: argparse.Namespace,
    pressures: Sequence[float],
    states: list[list[list[tuple[float, float, bool]]]],
    measured: list[dict[str, float]],
) -> xr.Dataset:
    values = np.array(states, dtype=float)
    names = list(QUANTITIES)
    arrays = {names[i]: values[..., i] for i in range(3)}
    for name in names[:2]:
        # The first model stands alone: its increment is nothing.
        arrays[f"{name}_increment"] = np.diff(arrays[name], axis=-1, prepend=arrays[name][..., :1])
    dims = ("well_depth_ratio", "pressure", "model")
    data = {
        name: (dims, arrays[name], {"units": units, "long_name": meaning})
        for name, (units, meaning) in QUANTITIES.items()
    }
    data |= {
        name: ("well_depth_ratio", [row[name] for row in measured], {"units": units, "long_name": meaning})
        for name, (units, meaning) in CONSTANTS.items()
    }
    return xr.Dataset(
        data,
        coords={
            "well_depth_ratio": ("well_depth_ratio", given.ratios, {"units": "1", "long_name": "ε over the study's"}),
            "pressure": ("pressure", pressures, {"units": "Pa", "long_name": "mean pressure"}),
            "model": ("model", list(MODELS), {"long_name": "model, each with all changes of those before"}),
            "change": ("model", list(MODELS.values()), {"long_name": "what sets the model apart from the one before"}),
        },
        attrs={"title": "From the continuum to the atoms, one change at a time", "study": given.study.name},
    )


def table(at: xr.Dataset) -> str:
    """Markdown tables of area and mean gap at one pressure: a model a row, its increment in brackets."""
    ratios = at["well_depth_ratio"].values
    names = [f"{ratio:g} ε₀" for ratio in ratios]
    heads = head("change", f"A: {names[0]}", *names[1:], f"ū (Å): {names[0]}", *names[1:])
    lines = [f"{float(at['pressure']) / 1e9:g} GPa", "", heads]
    for model, change in MODELS.items():
        here = at.sel(model=model)
        cells = []
        for area, step, first in zip(
            here["relative_contact_area"].values,
            here["relative_contact_area_increment"].values,
            at["relative_contact_area"].sel(model="continuum").values,
            strict=True,
        ):
            cells.append(f"{area:.4f}" + ("" if model == "continuum" else f" ({100 * step / first:+.2f} %)"))
        for gap, step in zip(here["mean_gap"].values, here["mean_gap_increment"].values, strict=True):
            cells.append(f"{1e10 * gap:.3f}" + ("" if model == "continuum" else f" ({1e10 * step:+.3f})"))
        flag = "" if bool(here["converged"].all()) else " (not converged)"
        lines.append(row(change + flag, *cells))
    area = at["relative_contact_area"]
    total = (area.sel(model="atoms") / area.sel(model="continuum") - 1).values
    shift = (at["mean_gap"].sel(model="atoms") - at["mean_gap"].sel(model="continuum")).values
    sums = [f"{100 * value:+.2f} %" for value in total] + [f"{1e10 * value:+.3f}" for value in shift]
    return "\n".join([*lines, row("**atoms against continuum**", *sums), ""])


def ranges(dataset: xr.Dataset) -> str:
    """Markdown: smallest and largest increment of every change over all states, areas over the continuum's."""
    first = dataset.sel(model="continuum")
    lines = ["All states", "", head("change", "ΔA", "Δū (Å)")]
    every = {MODELS[name]: dataset.sel(model=name) for name in list(MODELS)[1:]}
    steps = {
        change: (one["relative_contact_area_increment"] / first["relative_contact_area"], one["mean_gap_increment"])
        for change, one in every.items()
    }
    last = dataset.sel(model="atoms")
    steps["**all together**"] = (
        last["relative_contact_area"] / first["relative_contact_area"] - 1,
        last["mean_gap"] - first["mean_gap"],
    )
    for change, (area, gap) in steps.items():
        areas = f"{100 * float(area.min()):+.2f} to {100 * float(area.max()):+.2f} %"
        lines.append(row(change, areas, f"{1e10 * float(gap.min()):+.3f} to {1e10 * float(gap.max()):+.3f}"))
    return "\n".join([*lines, ""])


def constants_in_words(dataset: xr.Dataset) -> str:
    """What the lattice has for the constants of the study, at the first multiple of the well depth."""
    at = dataset.isel(well_depth_ratio=0)
    given, measured = (float(at[name]) for name in ("contact_modulus", "measured_contact_modulus"))
    work, cut_off = (float(at[name]) for name in ("work_of_adhesion", "measured_work_of_adhesion"))
    return (
        f"The lattice shows this surface E* = {measured / 1e9:.3f} GPa, the study has {given / 1e9:.3f} GPa; the "
        f"cut-off pairs have Δγ = {cut_off:.4f} J/m², the smeared layers {work:.4f} J/m², both at "
        f"{float(at['well_depth_ratio']):g} ε₀."
    )


main = program(
    run,
    STUDY,
    Option("--ratios", [1.0, 4.0, 8.0], "multiples of the well depth"),
    Option("--pressures", ["1 GPa"], "loading path, from separation"),
    Option("--seed", int, "surface, in place of the study's"),
    Option("-o, --output", Path("results/continuum_against_atoms.nc"), ""),
)

if __name__ == "__main__":
    sys.exit(main())
