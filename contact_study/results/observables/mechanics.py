"""Means, distributions and energies of a state, and what only its model has."""

import math

import numpy as np

from contact_study.numerics.distributions import Bins, probability_density
from contact_study.results.state import PASSED, InterfaceState, Observable, Value, Variable, noted

_PASSED = ("step", "passed")


def _mechanics(state: InterfaceState, bins: Bins) -> dict[str, Value]:
    pressure = float(np.mean(state.pressure))
    values: dict[str, Value] = {
        "mean_pressure": pressure,
        "mean_gap": float(np.mean(state.gap)) - state.equilibrium_distance,
        "mean_separation": state.mean_separation,
        "elastic_energy": state.elastic_energy,
        "interaction_energy": state.interaction_energy,
        "pressure_pdf": probability_density(state.pressure, bins.pressure_edges),
        "gap_pdf": probability_density(state.gap, bins.gap_edges),
    }
    if state.spacing is not None:
        values["total_force"] = pressure * state.pressure.size * math.prod(state.spacing)
    if state.highest_point is not None:
        values["displacement"] = state.highest_point - state.mean_separation
    if state.passed is not None:
        values |= {f"passed_{name}": column for name, column in zip(PASSED, state.passed.T, strict=False)}
    if state.plastic_indentation is not None:
        values["relative_plastic_area"] = float(np.mean(state.plastic_indentation > 0))
        values["mean_plastic_indentation"] = float(np.mean(state.plastic_indentation))
    return values


MECHANICS = Observable(
    {
        "mean_pressure": Variable("Pa", "mean normal pressure at the interface, compression positive"),
        "total_force": Variable("N", "mean pressure times the area of the cell, compression positive"),
        "mean_gap": Variable("m", "mean local gap minus the law's equilibrium distance"),
        "mean_separation": noted(
            "m",
            "distance of the mean planes of block and surface minus the equilibrium distance",
            "conjugate to the pressure; layer: plane of its undeformed surface",
        ),
        "displacement": noted(
            "m",
            "displacement of the body towards the surface beyond first touch",
            "of its undeformed surface, from the equilibrium distance to the highest point on; periodic half-space: of "
            "the mean plane of its surface; negative before",
        ),
        "passed_pressure": Variable(
            "Pa", "mean pressure of each state passed since the last point; detached: the load", _PASSED
        ),
        "passed_separation": Variable(
            "m", "mean separation of each state passed since the last point; detached: infinite", _PASSED
        ),
        "passed_energy": Variable(
            "J m-2", "elastic and interaction energy and plastic work per nominal area of each state passed", _PASSED
        ),
        "passed_viscous_dissipation": Variable(
            "J m-2", "viscous dissipation so far per nominal area at each state passed", _PASSED
        ),
        "elastic_energy": noted(
            "J m-2",
            "elastic energy per nominal area",
            "sampled atoms: includes thermal energy of the bottom layer; warm atoms in motion: includes "
            "that of all nodes of the block",
        ),
        "interaction_energy": Variable("J m-2", "interaction energy per nominal area"),
        "relative_plastic_area": Variable("1", "plastically deformed area so far over nominal area"),
        "mean_plastic_indentation": Variable("m", "mean plastic indentation so far"),
        "pressure_pdf": Variable("Pa-1", "probability density of the interfacial pressure", ("step", "pressure_bin")),
        "gap_pdf": Variable("m-1", "probability density of the local gap", ("step", "gap_bin")),
    },
    _mechanics,
)

FURTHER = Observable(
    {
        "contact_stiffness": noted(
            "Pa m-1",
            "contact stiffness -dp/du of the linearised problem",
            "u: mean gap; free boundaries: position of the undeformed surface",
        ),
        "contact_conductance": noted(
            "m-1",
            "contact conductance per nominal area over the half-spaces' harmonic mean conductivity",
            "contact_stiffness over contact modulus, by the analogy of J. R. Barber, Proc. R. Soc. A 459, 53 (2003); "
            "exact for a wall without adhesion, whose contact alone conducts; half-spaces only",
        ),
        "approach": Variable(
            "m", "approach of the machine beyond its stiffness: displacement plus force over stiffness"
        ),
        "dissipated_energy": Variable("J m-2", "energy dissipated in jumps so far per nominal area, without pull-off"),
        "dissipated_energy_resolution_error": Variable(
            "J m-2", "uncertainty of dissipated_energy: position of a jump within its step"
        ),
        "work_of_adhesion_in_contact": Variable("J m-2", "mean local work of adhesion of the points in contact"),
        "plastic_work": Variable("J m-2", "plastic work so far per nominal area"),
        "viscous_dissipation": Variable("J m-2", "energy dissipated by the viscoelastic solid so far per nominal area"),
        "unaccounted_work": Variable(
            "J m-2", "work of the load minus energy and dissipation so far (adaptive, viscoelastic)"
        ),
        "temperature": noted(
            "K",
            "kinetic temperature of the nodes, driven plane: in its frame",
            "by velocities in the middle of time steps",
        ),
        "kinetic_energy": noted(
            "J m-2",
            "kinetic energy of nodes and rigid plane per nominal area",
            "by velocities at the end of time steps",
        ),
        "mechanical_energy": noted(
            "J m-2",
            "mechanical energy of atoms in motion and load per nominal area",
            "kinetic, whole elastic and interaction energy, and the potential of the load: applied "
            "pressure times height of the rigid plane",
        ),
        "overdamped_time": Variable("m Pa-1", "time of overdamped motion over the friction of a unit of area"),
        "overdamped_load": Variable("Pa", "mean pressure on a state in overdamped motion"),
    },
    lambda state, _: state.further,
)
