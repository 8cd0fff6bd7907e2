"""Diffusion of the interfacial stress distribution with an absorbing boundary that moves.

B. N. J. Persson, J. Chem. Phys. 115, 3840 (2001): ∂P/∂s = ½ ∂²P/∂σ² with the variance s of full contact's stress, and
P(−σ_a(s), s) = 0. With x = σ + σ_a(s) the masses of cells follow a Markov chain between neighbouring centres whose mean
displacement is σ_a' exactly: it conserves area and stress to rounding. L-stable two-stage SDIRK in s.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy.interpolate import PchipInterpolator
from scipy.special import ndtr

from theory.numerics.tridiagonal import solve

_GAMMA = 1 - 1 / np.sqrt(2)  # Alexander's stiffly accurate SDIRK method of order two


@dataclass(frozen=True)
class DiffusionOptions:
    """Constants of the cells, in standard deviations of the last stress unless stated otherwise."""

    reach: float = 7.0  # deviations outside which 1e-12 of a Gaussian lies
    safe_distance: float = 10.0  # deviations from detaching at which a contact loses no more than 1e-23
    # Bounds of the stress up to which cells are nearly equal, and that stress over the boundary's first distance.
    coarsest: float = 0.3
    finest: float = 1e-5
    share_of_start: float = 3.0
    # Its lower bound, too, in deviations at the first node: in narrower cells SDIRK2 leaves negative masses.
    first_deviations: float = 250.0
    first_distance: float = 3.0  # distance at the start, over that stress, beyond which the boundary is moved closer


@dataclass(frozen=True)
class StressDistribution:
    """P(σ) of the contact at the end of the diffusion, and its history."""

    contact: np.ndarray  # relative area ∫ P dσ at each node of the variance
    edges: np.ndarray  # of the cells of stress, from −σ_a upward, compression positive, shape (m + 1,)
    density: np.ndarray  # P in each cell, per unit of stress, shape (m,)
    edge_stress: float  # −∫ σ_a g ds, g the absorbed flux: the mean stress that left with the detached area, tension

    @property
    def contact_stress(self) -> float:
        """∫ σ P dσ; together with :attr:`edge_stress` it balances the applied pressure."""
        return float(np.sum(self.density * 0.5 * np.diff(self.edges**2)))

    def bin_averages(self, edges: np.ndarray) -> np.ndarray:
        """Mean density in each bin; exact masses of whole cells, monotone interpolation inside them."""
        mass = np.concatenate([[0.0], np.cumsum(self.density * np.diff(self.edges))])
        cumulative = PchipInterpolator(self.edges, mass)(np.clip(edges, self.edges[0], self.edges[-1]))
        return np.diff(cumulative) / np.diff(edges)


def diffuse(
    pressure: float,
    variance: np.ndarray,
    detachment_stress: np.ndarray,
    cells: int,
    options: DiffusionOptions = DiffusionOptions(),
) -> StressDistribution:
    """Stress distribution of a contact under a pressure, in units where the last variance is about one.

    P starts as δ(σ − p) at a variance of zero; σ_a >= 0 is linear between the rising nodes of the variance.
    """
    if np.min(pressure + detachment_stress - options.safe_distance * np.sqrt(variance)) > 0:  # full contact
        deviations = np.linspace(-options.reach, options.reach, cells + 1)
        mass = np.diff(ndtr(deviations))
        mass /= mass.sum()
        edges = pressure + np.sqrt(variance[-1]) * deviations
        return StressDistribution(np.ones(variance.size), edges, mass / np.diff(edges), 0.0)
    finest = max(options.finest, options.first_deviations * np.sqrt(variance[1]))
    scale = float(np.clip(options.share_of_start * (pressure + detachment_stress[0]), finest, options.coarsest))
    # A boundary farther away than the deviations reach is moved closer, and the cells stay narrow: a billionth is lost.
    distance = options.reach * np.sqrt(variance + (options.first_distance * scale / options.reach) ** 2)
    boundary = np.minimum(detachment_stress, np.maximum(distance - pressure, 0.0))
    start = pressure + boundary[0]
    # Cells are nearly equal up to the scale, wider in proportion to the distance beyond.
    reach = max(pressure + boundary.max(), 0.0) + options.reach * np.sqrt(variance[-1])
    faces = scale * np.sinh(np.linspace(0, np.arcsinh(reach / scale), cells + 1))
    mass, contact = np.zeros(cells), np.zeros(variance.size)
    edge_stress = min(pressure, 0.0)
    if start > 0:
        # The two cells around the start share its mass so that the first moment is exact; nearer to the boundary than
        # the first centre as much is absorbed.
        centres = 0.5 * (faces[1:] + faces[:-1])
        right = int(np.searchsorted(centres, start))
        mass[right] = start / centres[0]
        if right:
            mass[right] = (start - centres[right - 1]) / (centres[right] - centres[right - 1])
            mass[right - 1] = 1 - mass[right]
        edge_stress = _march(variance, boundary, faces, mass, contact)
    return StressDistribution(contact, faces - boundary[-1], mass / np.diff(faces), edge_stress)


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _march(variance, detachment_stress, faces, mass, contact):
    """Advance the cell masses through all nodes in place; fills the contact area, returns the edge stress."""
    gamma = _GAMMA
    n = mass.size
    width = faces[1:] - faces[:-1]
    distance = np.empty(n)  # between neighbouring centres; from the boundary for the first
    distance[0] = 0.5 * width[0]
    for i in range(1, n):
        distance[i] = 0.5 * (width[i] + width[i - 1])
    forward, backward = np.empty(n + 1), np.empty(n + 1)  # rate of mass through face i into cell i, and back
    inverse, inward, outward, first = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    ratio = (1.0 - gamma) / gamma
    total = mass.sum()
    contact[0] = 1.0
    edge_stress = 0.0
    for k in range(variance.size - 1):
        step = variance[k + 1] - variance[k]
        rise = detachment_stress[k + 1] - detachment_stress[k]
        speed = rise / step
        forward[0] = forward[n] = backward[n] = 0.0
        # Rates of a mean displacement ``speed`` and the mean square one, or as much more as keeps them positive.
        for i in range(n - 1):
            below, above = distance[i], distance[i + 1]
            both = below + above
            square = max(0.5 * both / width[i], speed * above, -speed * below)
            backward[i] = (square - speed * above) / (below * both)
            forward[i + 1] = (square + speed * below) / (above * both)
        backward[n - 1] = 0.5 / (distance[n - 1] * width[n - 1])
        weight = gamma * step
        # Stage one: (1 − γ Δs L) m₁ = m₀.
        _factorise(weight, forward, backward, inverse, inward, outward)
        first[:] = mass
        solve(inverse, inward, outward, first)
        # Stage two: (1 − γ Δs L) m₂ = m₀ + (1 − γ) Δs L m₁ with Δs L m₁ = (m₁ − m₀) / γ.
        early = backward[0] * first[0] * (1.0 - gamma) * step
        for i in range(n):
            mass[i] += ratio * (first[i] - mass[i])
        solve(inverse, inward, outward, mass)
        late = backward[0] * mass[0] * weight
        # Weights of the stages with which the stress that leaves is what the contact loses.
        edge_stress -= early * (detachment_stress[k] + (1.0 - 2.0 * gamma) * rise)
        edge_stress -= late * (detachment_stress[k] + (1.0 - gamma) * rise)
        total -= early + late
        contact[k + 1] = total
    return edge_stress


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp", "nsz"})
def _factorise(weight, forward, backward, inverse, inward, outward):
    """Eliminate the cells of 1 − weight L as :func:`tridiagonal.factorise` does a constant matrix."""
    n = inverse.size
    middle = n // 2
    low = 1.0 + weight * (backward[0] + forward[1])
    high = 1.0 + weight * (backward[n - 1] + forward[n])
    inverse[0] = 1.0 / low
    inverse[n - 1] = 1.0 / high
    for i in range(1, n - middle):
        above = n - 1 - i
        high = (
            1.0
            + weight * (backward[above] + forward[above + 1])
            - (weight * forward[above + 1] * weight * backward[above + 1] / high)
        )
        inverse[above] = 1.0 / high
        if i < middle:
            low = 1.0 + weight * (backward[i] + forward[i + 1]) - weight * forward[i] * weight * backward[i] / low
            inverse[i] = 1.0 / low
    for i in range(middle):
        outward[i] = weight * backward[i + 1] * inverse[i]
        inward[i] = weight * forward[i + 1] * inverse[i]
    for i in range(middle, n):
        outward[i] = weight * forward[i] * inverse[i]
        inward[i] = weight * backward[i] * inverse[i]
