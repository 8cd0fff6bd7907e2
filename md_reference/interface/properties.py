"""Adhesion of flat layers, measured from the pair potential alone.

No traction–separation law enters, so that the measured values can confirm or refute the continuum's law.
"""

from dataclasses import dataclass

import numpy as np
from scipy import optimize

from md_reference.interface.pairs import LennardJonesInterface
from md_reference.interface.substrate import Substrate

# Positions of a block atom over the substrate's cell, along each axis. The corrugation of a layer is periodic, its
# harmonics fall by exp(−2π·3.28/1.607) each, and the mean over n shifts is exact but for the n-th: 8 leave 1e-40.
_SHIFTS = 8


@dataclass(frozen=True)
class InterfaceProperties:
    """Flat block layer on flat substrate layer, averaged over the lateral registry."""

    work_of_adhesion: float  # depth of the energy's minimum (J/m²)
    equilibrium_distance: float  # distance of the layers there (m)
    peak_tensile_stress: float  # largest tension that the interface carries (Pa)
    peak_distance: float  # distance of the layers there (m)


class FlatInterface:
    """Energy and tension of a rigid flat layer of block atoms on the flat substrate layer.

    ``substrate_spacing`` is that of the sites along y and x (m), ``area_per_atom`` that of the block's layer (m²);
    ``well_depth`` ε (J), ``length`` r0 (m), ``cutoff`` in units of r0.
    """

    def __init__(
        self,
        substrate_spacing: tuple[float, float],
        area_per_atom: float,
        well_depth: float,
        length: float,
        cutoff: float,
    ):
        shifts = (_SHIFTS, _SHIFTS)
        spacing = (substrate_spacing[0] / _SHIFTS, substrate_spacing[1] / _SHIFTS)
        substrate = Substrate(np.zeros((2, 2)), substrate_spacing)
        self._interface = LennardJonesInterface(substrate, shifts, spacing, well_depth, length, cutoff)
        self._displacement = np.zeros((3, *shifts))
        self._force = np.empty((3, *shifts))
        self._area = area_per_atom * _SHIFTS**2

    def energy(self, distance: float) -> float:
        """Return the energy per area (J/m²) at a distance of the layers (m)."""
        self._displacement[2] = distance
        return self._interface.evaluate(self._displacement, self._force) / self._area

    def tension(self, distance: float) -> float:
        """Return the tensile stress (Pa) at a distance of the layers (m)."""
        self.energy(distance)
        return -float(np.sum(self._force[2])) / self._area


def measure_interface(flat: FlatInterface, length: float) -> InterfaceProperties:
    """Find equilibrium and peak of a flat interface whose minimum lies near ``length`` (m)."""
    # The 10-4 law has its zero at 1 and its peak at 1.14 lengths; the lattice and the cutoff move both slightly.
    equilibrium = optimize.brentq(flat.tension, 0.8 * length, 1.1 * length, xtol=1e-12 * length)
    peak = optimize.minimize_scalar(
        lambda distance: -flat.tension(distance * length), bounds=(1.02, 1.4), method="bounded", options={"xatol": 1e-8}
    )
    return InterfaceProperties(
        work_of_adhesion=-flat.energy(equilibrium),
        equilibrium_distance=equilibrium,
        peak_tensile_stress=-float(peak.fun),
        peak_distance=float(peak.x) * length,
    )
