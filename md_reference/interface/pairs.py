"""Lennard-Jones forces of the rigid substrate on the block's bottom atoms, and adhesion of flat layers.

The pair potential is V(r) = 4ε[(r0/r)¹² − (r0/r)⁶], taken smoothly to zero between 0.9 r_c and the cutoff r_c by the
quintic in r² with two continuous derivatives: a bare cut has steps in the force above the solver's tolerance, a
shifted potential loses 3.6 % of the work of adhesion at r_c = 4 r0.
"""

import math
from collections.abc import Callable
from functools import partial

import numpy as np
from numba import njit
from scipy import ndimage, optimize

from contact_study.physics.lattice import Lattice
from md_reference.interface.substrate import Substrate, sample_substrate
from md_reference.parallel_rows import share_rows

# Below this height over the nearest site (r0) an atom counts as inside the substrate: no block exerts such a repulsion.
INSIDE = 0.3

_SWITCH_START = 0.9  # of the cutoff, to which the switch acts
_HEIGHT_TOLERANCE = 1e-4  # error allowed to the interpolated height of the surface (r0)
_TASK_ROWS = 8  # per task of a thread: some tenths of a millisecond and more

# Positions of a flat layer's atom over the substrate's cell, along each axis. The corrugation is periodic, its
# harmonics fall by exp(−2π·3.28/1.607) each, and the mean over n shifts is exact but for the n-th: 8 leave 1e-40.
_SHIFTS = (8, 8)

_kernel = njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})


class LennardJonesInterface:
    """Block atoms over a substrate layer, with the pair potential above.

    Displacements have shape (3, ny, nx): moves along x and y from the atoms' rest positions, and the height over the
    substrate's mean plane (m). ``shape`` and ``spacing`` (m) are those of the block's atoms, ``cutoff`` in ``length``.
    """

    def __init__(
        self,
        substrate: Substrate,
        shape: tuple[int, int],
        spacing: tuple[float, float],
        well_depth: float,
        length: float,
        cutoff: float,
        threads: int = 1,
    ):
        self.substrate = substrate
        self.shape = shape
        self.spacing = spacing
        self.well_depth = well_depth
        self.length = length
        self.cutoff = float(cutoff)
        # Force on an atom over a flat layer of sites, over s¹¹ − s⁵ with s = r0/distance (N).
        self.force_prefactor = 8 * math.pi * well_depth * length / math.prod(substrate.spacing)
        reach_y, reach_x = (math.ceil(cutoff * length / b) + 1 for b in substrate.spacing)
        highest = ndimage.maximum_filter(substrate.heights, (2 * reach_y + 1, 2 * reach_x + 1), mode="wrap")
        self._geometry = (
            1 / length,
            (spacing[0] / length, spacing[1] / length),
            (substrate.spacing[0] / length, substrate.spacing[1] / length),
            np.pad(substrate.heights, [(reach_y, reach_y), (reach_x, reach_x)], mode="wrap") / length,
            (reach_y, reach_x),
            highest / length,
            4 * well_depth,
            self.cutoff,
        )
        self._no_hessian = np.empty((6, 0, 0))
        self._threads = threads
        self._all = np.ones(shape, dtype=np.bool_)
        self._energy = np.empty(shape)
        self._row_inside = np.empty(shape[0], dtype=np.int64)

    def evaluate(self, displacement: np.ndarray, force: np.ndarray, hessian: np.ndarray | None = None) -> float:
        """Write forces (N) and second derivatives (N/m: xx, yy, zz, xy, xz, yz); return the energy of all pairs (J).

        Infinite, with undefined results, if an atom is less than 0.3 r0 above the site below it, or is not finite.
        """
        derivatives = self._no_hessian if hessian is None else hessian
        if not self.evaluate_some(displacement, self._all, force, derivatives, self._energy):
            return math.inf
        return float(np.sum(self._energy))

    def evaluate_some(
        self, displacement: np.ndarray, due: np.ndarray, force: np.ndarray, hessian: np.ndarray, energy: np.ndarray
    ) -> bool:
        """Write forces, second derivatives and energies of the atoms that are ``due``, and of no other.

        ``due`` and ``energy`` have shape (ny, nx). False, with undefined results, if one of them is inside.
        """
        written = force, hessian is not self._no_hessian, hessian, energy, self._row_inside
        kernel = partial(_lennard_jones, displacement, due, self._geometry, *written)
        share_rows(kernel, self.shape[0], _TASK_ROWS, self._threads)
        return not self._row_inside.any()

    def gap(self, displacement: np.ndarray) -> np.ndarray:
        """Return the first of :meth:`gap_and_cosine`."""
        return self.gap_and_cosine(displacement)[0]

    def gap_and_cosine(self, displacement: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return each atom's height above the surface (m) and the cosine of the surface's tilt, shape (ny, nx)."""
        height, cosine = self.substrate.height_and_cosine(*self._lateral_positions(displacement))
        return displacement[2] - height, cosine

    def floor(self, displacement: np.ndarray) -> np.ndarray:
        """Return the higher of the surface below each atom and of the nearest site (m), shape (ny, nx)."""
        positions, substrate = self._lateral_positions(displacement), self.substrate
        rows, columns = (
            # Midway between two sites rounding decides which one is nearest: both count.
            [np.floor(at / b + half).astype(int) % n for half in (0.5 - 1e-9, 0.5 + 1e-9)]
            for at, b, n in zip(positions, substrate.spacing, substrate.shape, strict=True)
        )
        nearest = np.max([substrate.heights[row, column] for row in rows for column in columns], axis=0)
        return np.maximum(substrate.height_and_cosine(*positions)[0], nearest)

    def rest_heights(self) -> np.ndarray:
        """Return the height of the surface under the atoms' rest positions (m), shape (ny, nx)."""
        return -self.gap(np.zeros((3, *self.shape)))

    def _lateral_positions(self, displacement: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        y = np.arange(self.shape[0])[:, None] * self.spacing[0] + displacement[1]
        return y, np.arange(self.shape[1])[None, :] * self.spacing[1] + displacement[0]


def interface_of(
    heights: Callable[[tuple[int, int]], np.ndarray],
    lattice: Lattice,
    well_depth: float,
    length: float,
    cutoff: float,
    threads: int = 1,
) -> LennardJonesInterface:
    """Return Lennard-Jones atoms over the substrate's sites; ``heights`` is the surface on a grid of any shape (m)."""
    substrate = sample_substrate(heights, lattice.size, lattice.substrate_sites, _HEIGHT_TOLERANCE * length)
    spacing = (lattice.size[0] / lattice.atoms[0], lattice.size[1] / lattice.atoms[1])
    return LennardJonesInterface(substrate, lattice.atoms, spacing, well_depth, length, cutoff, threads)


def flat_adhesion(
    spacing: tuple[float, float], area_per_atom: float, well_depth: float, length: float, cutoff: float
) -> dict[str, float]:
    """Measure a flat layer of block atoms on flat substrate sites ``spacing`` apart, averaged over the registry.

    Work of adhesion (J/m²), peak tension (Pa) and distances (m), by their names in a dataset, without any law.
    """
    steps = (spacing[0] / _SHIFTS[0], spacing[1] / _SHIFTS[1])
    interface = LennardJonesInterface(Substrate(np.zeros((2, 2)), spacing), _SHIFTS, steps, well_depth, length, cutoff)
    displacement, force = np.zeros((3, *_SHIFTS)), np.empty((3, *_SHIFTS))
    area = area_per_atom * math.prod(_SHIFTS)

    def energy(distance: float) -> float:
        displacement[2] = distance
        return interface.evaluate(displacement, force) / area

    def tension(distance: float) -> float:
        energy(distance)
        return -float(np.sum(force[2])) / area

    # The 10-4 law has its zero at 1 and its peak at 1.14 lengths; the lattice and the cutoff move both slightly.
    equilibrium = optimize.brentq(tension, 0.8 * length, 1.1 * length, xtol=1e-12 * length)
    peak = optimize.minimize_scalar(
        lambda distance: -tension(distance * length), bounds=(1.02, 1.4), method="bounded", options={"xatol": 1e-8}
    )
    return {
        "work_of_adhesion": -energy(equilibrium),
        "equilibrium_distance": equilibrium,
        "peak_tensile_stress": -float(peak.fun),
        "peak_distance": float(peak.x) * length,
    }


@njit(inline="always")
def _pair(dx, dy, dz, start, slope):
    """Return potential, dV/ds and d²V/ds² of a pair over 4ε, s = r²/r0², with the switch from ``start`` on."""
    s = dx * dx + dy * dy + dz * dz
    inverse = 1.0 / s
    t = inverse * inverse * inverse
    u = min(max((s - start) * slope, 0.0), 1.0)
    v = 1.0 - u
    uv = u * v
    switch = v * v * v * (1.0 + u * (3.0 + 6.0 * u))
    switch_1 = -30.0 * slope * uv * uv
    switch_2 = -60.0 * slope * slope * uv * (v - u)
    potential = t * (t - 1.0)
    potential_1 = inverse * t * (3.0 - 6.0 * t)
    potential_2 = inverse * inverse * t * (42.0 * t - 12.0)
    g = potential_1 * switch + potential * switch_1
    q = potential_2 * switch + 2.0 * potential_1 * switch_1 + potential * switch_2
    return potential * switch, g, q


@_kernel
def _lennard_jones(displacement, due, geometry, force, with_hessian, hessian, energy, row_inside, first_row, end_row):
    """Sum over pairs of due atoms in rows ``first_row`` to before ``end_row``, with lengths in units of r0.

    Writes each atom's energy, force −2V'Δ and Hessian 2V' 1 + 4V'' ΔΔᵀ with V(s) as in :func:`_pair`, and the number
    of a row's atoms inside the substrate.
    """
    scale, atom_spacing, spacing, padded, margin, highest, strength, cutoff = geometry
    columns = displacement.shape[2]
    site_rows, site_columns = highest.shape
    b_y, b_x = spacing
    per_y, per_x = 1.0 / b_y, 1.0 / b_x
    cutoff2 = cutoff * cutoff
    start = _SWITCH_START**2 * cutoff2
    slope = 1.0 / (cutoff2 - start)
    heights = padded.ravel()
    most_rows = 2 * int(cutoff * per_y) + 3
    longest_row = 2 * int(cutoff * per_x) + 10
    capacity = most_rows * longest_row + 16
    ladder = b_x * np.arange(longest_row)
    row_y, row_first, row_end = np.empty(most_rows), np.empty(most_rows), np.empty(most_rows)
    delta_x, delta_y, delta_z = np.empty(capacity), np.empty(capacity), np.empty(capacity)
    to_force = strength * scale
    to_hessian = to_force * scale
    far = 1e9 * (site_rows + site_columns)
    for iy in range(first_row, end_row):
        inside = 0
        for ix in range(columns):
            if not due[iy, ix]:
                continue
            x = ix * atom_spacing[1] + scale * displacement[0, iy, ix]
            y = iy * atom_spacing[0] + scale * displacement[1, iy, ix]
            z = scale * displacement[2, iy, ix]
            if not (abs(x) + abs(y) < far and z == z):
                inside += 1
                continue
            jx, jy = math.floor(x * per_x + 0.5), math.floor(y * per_y + 0.5)
            hx, hy = jx % site_columns, jy % site_rows
            clearance = z - highest[hy, hx]
            if clearance >= cutoff:
                energy[iy, ix] = 0.0
                force[:, iy, ix] = 0.0
                if with_hessian:
                    hessian[:, iy, ix] = 0.0
                continue
            if z - padded[hy + margin[0], hx + margin[1]] < INSIDE:
                inside += 1
                continue
            x -= (jx - hx) * b_x
            y -= (jy - hy) * b_y
            # Every site in reach lies at least ``clearance`` below the atom, which narrows the circle of neighbours.
            lateral2 = cutoff2 - max(clearance, 0.0) ** 2
            lateral = math.sqrt(lateral2)
            low = math.ceil((y - lateral) * per_y)
            rows = np.uint64(max(math.floor((y + lateral) * per_y) + 1 - low, 0))
            for r in range(rows):
                dy = y - (low + np.float64(r)) * b_y
                half = math.sqrt(max(lateral2 - dy * dy, 0.0))
                row_y[r] = dy
                row_first[r] = math.ceil((x - half) * per_x)
                row_end[r] = math.floor((x + half) * per_x) + 1.0
            # One length for all rows, that of the longest and a site for rounding: one that changes is not foreseen by
            # the processor. A multiple of four, known only at run time, becomes vector stores; a constant four would
            # be unrolled into scalars. What a row writes beyond its end the next one overwrites.
            length = np.uint64(math.floor(2.0 * lateral * per_x) + 5) // np.uint64(4) * np.uint64(4)
            count = np.uint64(0)
            for r in range(rows):
                first = int(row_first[r])
                base = np.uint64((low + int(r) + margin[0]) * padded.shape[1] + first + margin[1])
                dx = x - first * b_x
                dy = row_y[r]
                for n in range(length):
                    delta_x[count + n] = dx - ladder[n]
                    delta_y[count + n] = dy
                    delta_z[count + n] = z - heights[base + n]
                count += np.uint64(max(int(row_end[r]) - first, 0))
            for k in range(np.uint64(8)):  # fills the last block of eight with pairs beyond the cutoff
                delta_x[count + k], delta_y[count + k], delta_z[count + k] = 2.0 * cutoff, 0.0, 0.0
            count = (count + np.uint64(7)) // np.uint64(8) * np.uint64(8)
            f_x = f_y = f_z = e = 0.0
            if not with_hessian:
                for k in range(count):
                    potential, g, _ = _pair(delta_x[k], delta_y[k], delta_z[k], start, slope)
                    f_x += g * delta_x[k]
                    f_y += g * delta_y[k]
                    f_z += g * delta_z[k]
                    e += potential
            else:
                h_xx = h_yy = h_zz = h_xy = h_xz = h_yz = trace = 0.0
                for k in range(count):
                    dx, dy, dz = delta_x[k], delta_y[k], delta_z[k]
                    potential, g, q = _pair(dx, dy, dz, start, slope)
                    f_x += g * dx
                    f_y += g * dy
                    f_z += g * dz
                    e += potential
                    trace += g
                    h_xx += q * dx * dx
                    h_yy += q * dy * dy
                    h_zz += q * dz * dz
                    h_xy += q * dx * dy
                    h_xz += q * dx * dz
                    h_yz += q * dy * dz
                hessian[0, iy, ix] = to_hessian * (2.0 * trace + 4.0 * h_xx)
                hessian[1, iy, ix] = to_hessian * (2.0 * trace + 4.0 * h_yy)
                hessian[2, iy, ix] = to_hessian * (2.0 * trace + 4.0 * h_zz)
                hessian[3, iy, ix] = to_hessian * 4.0 * h_xy
                hessian[4, iy, ix] = to_hessian * 4.0 * h_xz
                hessian[5, iy, ix] = to_hessian * 4.0 * h_yz
            force[0, iy, ix] = -2.0 * to_force * f_x
            force[1, iy, ix] = -2.0 * to_force * f_y
            force[2, iy, ix] = -2.0 * to_force * f_z
            energy[iy, ix] = strength * e
        row_inside[iy] = inside
