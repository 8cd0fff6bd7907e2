"""Flow of a fluid through the gap by Reynolds' equation ∇·(u³ ∇p) = 0; nothing flows where surfaces touch.

A seal leaks the volume G w Δp / (η l) per time; G = u³/12 between planes a distance u apart (W. B. Dapp, A. Lücke,
B. N. J. Persson & M. H. Müser, Phys. Rev. Lett. 108, 244301 (2012)).
"""

from collections.abc import Sequence

import numpy as np


def flow_conductance(gap: np.ndarray, spacing: Sequence[float], axis: int, periodic: bool = True) -> float:
    """Conductance G of a gap, shape (ny, nx), along an axis; lengths in m, G in m³.

    A periodic gap has a mean pressure gradient; another one lies between two reservoirs, and is tight at its sides.
    Finite volumes of the points: of second order in the spacing, exact for strips along or across the flow.
    """
    from scipy.sparse import coo_array, csgraph, diags_array  # slow to import
    from scipy.sparse.linalg import spsolve

    if axis == 1:
        gap, spacing = gap.T, spacing[::-1]
    (rows, columns), (step, width) = gap.shape, spacing
    permeability = np.maximum(gap, 0.0) ** 3 / 12
    if not periodic:  # the reservoirs, of no resistance
        permeability = np.pad(permeability, ((1, 1), (0, 0)), constant_values=np.inf)
    number = np.arange(permeability.size).reshape(permeability.shape)
    along, across = (number, np.roll(number, -1, 0)), (number, np.roll(number, -1, 1))
    if not periodic:
        along, across = (number[:-1], number[1:]), (number[1:-1, :-1], number[1:-1, 1:])
    permeability = permeability.ravel()
    faces = []
    for (one, other), distance in ((along, step), (across, width)):
        open_ = (permeability[one] > 0) & (permeability[other] > 0)
        tail, head = one[open_], other[open_]
        faces.append((tail, head, 2 / (1 / permeability[tail] + 1 / permeability[head]) / distance**2))
    tail, head, weight = (np.concatenate(parts) for parts in zip(*faces, strict=True))
    matrix = coo_array((weight, (tail, head)), (number.size, number.size)).tocsr()
    matrix = matrix + matrix.T
    fixed, pressure = np.zeros(number.size, bool), np.zeros(number.size)
    if not periodic:
        fixed[number[[0, -1]]], pressure[number[-1]] = True, rows * step
    count, part = csgraph.connected_components(matrix, directed=False)
    free_parts = np.setdiff1d(np.arange(count), part[fixed])  # known up to a constant
    fixed[np.unique(part, return_index=True)[1][free_parts]] = True
    # The mean gradient is one: a periodic pressure has it beside its own differences.
    drop = np.zeros(tail.size)
    drop[: faces[0][0].size] = step if periodic else 0.0
    source = np.bincount(tail, weight * drop, number.size) - np.bincount(head, weight * drop, number.size)
    laplacian = (diags_array(matrix.sum(axis=0)) - matrix).tocsc()
    source = (source - laplacian @ pressure)[~fixed]
    if source.size:
        pressure[~fixed] = spsolve(laplacian[~fixed][:, ~fixed], source, permc_spec="MMD_AT_PLUS_A")
    flux = (weight * step * (drop + pressure[head] - pressure[tail]))[: faces[0][0].size]
    return float(flux.sum() / (columns * (rows if periodic else rows + 1)))
