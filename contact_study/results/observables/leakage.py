"""Leakage: Reynolds flow of a thin film through the gap.

The film obeys ∇·(u³ ∇P) = 0, u³ / 12 η being its mobility; contact is closed. The flow is that of a unit drop of P over
one period, or between opposite rims without flow through the others (as A. Wang & M. H. Müser, Tribol. Lett. (2021),
doi:10.1007/s11249-020-01378-7, arXiv:2010.13470).
"""

import numpy as np

from contact_study.numerics.distributions import Bins
from contact_study.results.observables.clusters import channels
from contact_study.results.state import InterfaceState, Observable, Value, Variable, noted


def hydraulic_gaps(film: np.ndarray, spacing: tuple[float, float], periodic: bool = True) -> tuple[float, float]:
    """Compute the gaps of parallel plates through which as much flows along y, and along x, as through a film.

    Finite volumes with the harmonic mean of the mobilities of two cells at their common side, solved directly.

    Parameters
    ----------
    film : ndarray, shape (ny, nx)
        Thickness of the film (m), zero where it is closed.
    spacing : pair of float
        Of points along y and x (m).
    periodic : bool, optional
        Whether the map continues at its opposite edges; if not, P is prescribed at two rims.

    Returns
    -------
    along_y, along_x : float
        h such that the flow is h³ / 12 η times width and drop of P over length (m). Zero where no connected film
        leads through the cell, infinite of separated surfaces.

    Examples
    --------
    >>> import numpy as np
    >>> film = np.full((4, 6), 2e-9)
    >>> film[:, 3] = 0.0  # a ridge along y
    >>> along_y, along_x = hydraulic_gaps(film, (1e-9, 1e-9))
    >>> round(along_y / 2e-9, 3), along_x  # (5 / 6)^(1/3)
    (0.941, 0.0)
    """
    highest = float(film.max())
    if not 0 < highest < np.inf:
        return highest, highest
    mobility = (film / highest) ** 3
    through = channels(mobility > 0, periodic)
    if periodic:
        found = _conductances(np.where(through[0] | through[1], mobility, 0.0), spacing, (0, 1), True)
    else:
        found = [_conductances(np.where(through[axis], mobility, 0.0), spacing, (axis,), False)[0] for axis in (0, 1)]
    # A cluster that goes around one axis only has no flow along the other, but what rounding leaves of it.
    along_y, along_x = (highest * flow ** (1 / 3) if t.any() else 0.0 for flow, t in zip(found, through, strict=True))
    return along_y, along_x


def _conductances(
    mobility: np.ndarray, spacing: tuple[float, float], driven: tuple[int, ...], periodic: bool
) -> list[float]:
    """Mean mobilities of the flows along the ``driven`` axes; of a free map along one, all of its film in channels."""
    from scipy.sparse import coo_array  # slow to import
    from scipy.sparse.csgraph import connected_components
    from scipy.sparse.linalg import splu

    cells, open_ = int(np.count_nonzero(mobility)), mobility > 0
    if not cells:
        return [0.0] * len(driven)
    node = np.full(mobility.shape, cells)  # cells come before the one reservoir of a free map
    node[open_] = np.arange(cells)
    starts, ends, conductances = [], [], []
    drops: list[list[np.ndarray]] = [[] for _ in driven]
    for axis in (0, 1):
        m, n = (np.moveaxis(array, axis, 0) for array in (mobility, node))
        here, there, one, other = (m, np.roll(m, -1, 0), n, np.roll(n, -1, 0))
        with np.errstate(invalid="ignore"):
            side = 2 * here * there / (here + there)
        if not periodic:  # half of a cell from the last line to the reservoir, and from there to the first one
            side[-1] = 0.0
            if axis in driven:
                closed = np.full_like(n[:1], cells)
                side = np.concatenate([side, 2 * m[-1:], 2 * m[:1]])
                one, other = np.concatenate([one, n[-1:], closed]), np.concatenate([other, closed, n[:1]])
        kept = side > 0
        starts.append(one[kept])
        ends.append(other[kept])
        conductances.append(side[kept] * spacing[1 - axis] / spacing[axis])
        jump = np.zeros(side.shape)
        jump[-1] = 1.0  # over the edge, or from the reservoir
        for drop, along in zip(drops, driven, strict=True):
            drop.append(jump[kept] * (axis == along))
    start, end, conductance = map(np.concatenate, (starts, ends, conductances))
    jumps = np.stack([np.concatenate(drop) for drop in drops], axis=1)
    faces = np.arange(start.size)
    entries = np.concatenate([np.ones(start.size), -np.ones(start.size)])
    shape = start.size, cells + (not periodic)
    fall = coo_array((entries, (np.tile(faces, 2), np.concatenate([start, end]))), shape=shape).tocsr()
    matrix = (fall.T.multiply(conductance) @ fall).tocsr()
    # P is known but for a number in each connected part: zero where most flows, so that its pivot is no rounding.
    part = connected_components(matrix, directed=False)[1]
    strongest = np.argsort(-matrix.diagonal(), kind="stable")
    free = np.ones(shape[1], bool)
    free[strongest[np.unique(part[strongest], return_index=True)[1]]] = False
    pressure = np.zeros((shape[1], len(driven)))
    if free.any():
        # Minimum degree: a hundred times faster on a grid than the default ordering.
        options = {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
        solver = splu(matrix[free][:, free].tocsc(), **options)
        pressure[free] = solver.solve(-(fall.T @ (conductance[:, None] * jumps))[free])
    # The dissipation errs by the square of the error of P; a flow through one section would by the error itself.
    flows = conductance @ (fall @ pressure + jumps) ** 2
    lengths = [n * step for n, step in zip(mobility.shape, spacing, strict=True)]
    return [float(flow) * lengths[axis] / lengths[1 - axis] for flow, axis in zip(flows, driven, strict=True)]


def _leakage(state: InterfaceState, _: Bins) -> dict[str, Value]:
    if state.spacing is None:
        return {}
    film = np.where(state.contact, 0.0, np.maximum(state.gap - state.equilibrium_distance, 0.0))
    along_y, along_x = hydraulic_gaps(film, state.spacing, state.periodic)
    return {"hydraulic_gap_y": along_y, "hydraulic_gap_x": along_x}


def _entry(axis: str) -> Variable:
    return noted(
        "m",
        f"gap of parallel plates with the same Reynolds flow along {axis} (hydraulic aperture)",
        "the film is as thick as the gap minus the equilibrium distance, contact is closed; zero: no flow",
    )


LEAKAGE = Observable({f"hydraulic_gap_{axis}": _entry(axis) for axis in "xy"}, _leakage, option="leakage")
