"""Energies per nominal area."""

from contact_study.numerics.distributions import Bins
from contact_study.results.state import InterfaceState, Observable, Variable


def _read(state: InterfaceState, _: Bins) -> dict[str, float]:
    return {"elastic_energy": state.elastic_energy, "interaction_energy": state.interaction_energy}


ENERGIES = Observable(
    {
        "elastic_energy": Variable(
            "J m-2",
            "elastic energy per nominal area",
            attrs={
                "comment": "of sampled atoms thermal energy of the bottom layer is in it, of warm atoms in motion "
                "that of all nodes of the block"
            },
        ),
        "interaction_energy": Variable("J m-2", "interaction energy per nominal area"),
    },
    _read,
)
