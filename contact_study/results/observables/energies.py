"""Energies per nominal area: stored, dissipated by jumps, by a viscoelastic solid and by plastic flow."""

import numpy as np

from contact_study.numerics.distributions import Bins
from contact_study.results.state import InterfaceState, Observable, Value, Variable


def _read(state: InterfaceState, _: Bins) -> dict[str, Value]:
    values: dict[str, Value] = {"elastic_energy": state.elastic_energy, "interaction_energy": state.interaction_energy}
    if state.own_steps is not None:
        values["dissipated_energy"] = state.own_steps.dissipated
        values["dissipated_energy_resolution_error"] = state.own_steps.uncertain
    if state.plasticity is not None:
        indentation = state.plasticity.indentation
        mean = float(np.mean(indentation))
        values["relative_plastic_area"] = float(np.mean(indentation > 0))
        values["mean_plastic_indentation"] = mean
        # The pressure on a yielding point is the hardness throughout.
        values["plastic_work"] = state.plasticity.hardness * mean
    if state.relaxation is not None:
        values["viscous_dissipation"] = state.relaxation.dissipated
    return values


ENERGIES = Observable(
    {
        "elastic_energy": Variable(
            "J m-2",
            "elastic energy per nominal area",
            attrs={
                "comment": "sampled atoms: includes thermal energy of the bottom layer; warm atoms in motion: includes "
                "that of all nodes of the block"
            },
        ),
        "interaction_energy": Variable("J m-2", "interaction energy per nominal area"),
        "dissipated_energy": Variable("J m-2", "energy dissipated in jumps so far per nominal area, without pull-off"),
        "dissipated_energy_resolution_error": Variable(
            "J m-2", "uncertainty of dissipated_energy: position of a jump within its step"
        ),
        "relative_plastic_area": Variable("1", "plastically deformed area so far over nominal area"),
        "mean_plastic_indentation": Variable("m", "mean plastic indentation so far"),
        "plastic_work": Variable("J m-2", "plastic work so far per nominal area"),
        "viscous_dissipation": Variable("J m-2", "energy dissipated by the viscoelastic solid so far per nominal area"),
    },
    _read,
)
