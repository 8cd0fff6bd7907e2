"""States that a solve starts from: the block apart, on a gap field that something else has found, at a mean gap."""

import numpy as np
from scipy import optimize

from contact_study.errors import InputError
from contact_study.numerics import fourier
from md_reference.interface.pairs import LennardJonesInterface


def separated(interface: LennardJonesInterface) -> np.ndarray:
    """A flat layer of atoms just beyond the cutoff from the highest site of the substrate, shape (3, ny, nx) (m)."""
    displacement = np.zeros((3, *interface.shape))
    displacement[2] = np.max(interface.substrate.heights) + (1 + 1e-6) * interface.cutoff * interface.length
    return displacement


def predicted(heights: np.ndarray, gap: np.ndarray, length: float) -> np.ndarray:
    """Atoms at their lateral rest positions on a gap field of any grid, shape (3, ny, nx) (m).

    Parameters
    ----------
    heights : numpy.ndarray, shape (ny, nx)
        Surface under the rest positions (m).
    gap : numpy.ndarray
        Gap of a continuum solution over the same rectangle (m); interpolated trigonometrically.
    length : float
        r0; interpolation is kept from undershooting half of it (m).
    """
    displacement = np.zeros((3, *heights.shape))
    displacement[2] = heights + np.maximum(fourier.interpolate(gap, heights.shape), 0.5 * length)
    return displacement


def at_mean_gap(interface: LennardJonesInterface, displacement: np.ndarray, mean_gap: float) -> np.ndarray:
    """A state moved to a mean height of ``mean_gap`` + r0, with no atom below the surface (m).

    Atoms that a rigid approach would push closer to the surface, or to the height of the site next to them, than
    0.85 r0 stay at that distance: on steep flanks that site stands above the surface below the atom.

    Raises
    ------
    InputError
        If the mean gap is so small that all atoms would be closer.
    """
    length = interface.length
    floor = interface.floor(displacement) + 0.85 * length
    target = mean_gap + length
    if np.mean(floor) >= target:
        raise InputError(f"loading.path: a mean gap of {mean_gap:g} m needs atoms closer than 0.85 r0 everywhere")

    def excess(shift: float) -> float:
        return float(np.mean(np.maximum(displacement[2] + shift, floor))) - target

    rigid = target - float(np.mean(displacement[2]))
    lowest = float(np.min(floor - displacement[2]))  # so far down that all atoms stand on the floor
    shift = optimize.brentq(excess, lowest, rigid, xtol=1e-15 * length) if excess(rigid) > 0 else rigid
    moved = displacement.copy()
    moved[2] = np.maximum(displacement[2] + shift, floor)
    return moved
