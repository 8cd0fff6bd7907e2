"""Quantities that are read off the state of a simulation, with formula and dataset entry.

Means, distributions and energies, what only its model has, the work of the solver, and the map of contact: its area and
edge, its clusters and percolation, its autocorrelation.
"""

import math
from dataclasses import asdict, replace
from functools import lru_cache

import numpy as np

from contact_study.numerics.distributions import Bins, probability_density
from contact_study.results.state import FLAG, PASSED, InterfaceState, Observable, Step, Value, Variable

# A point in contact counts with its whole cell. V. A. Yastrebov, G. Anciaux & J.-F. Molinari, Tribol. Int. 114, 161
# (2017), arXiv:1701.02727, correct that by A' = A − (π − 1 + ln 2)/24 · S Δx, where S is the length of the edge along
# the sides of the cells, 4/π of the edge's own if that has no preferred direction; a free rim is no such side.
OVERCOUNT = (np.pi - 1 + np.log(2)) / 24
# Half octaves down from half of the shorter side: a 700th of it is at least a point on the usual grids.
RINGS = 17
RING_EDGES = 0.5 * 2.0 ** (-0.5 * np.arange(RINGS, -1, -1))
RELATIVE_DISTANCE = np.sqrt(RING_EDGES[1:] * RING_EDGES[:-1])
_AROUND = "around the periodic cell, or between opposite rims of a free one"
_PASSED = ("step", "passed")


def _noted(units: str, long_name: str, comment: str) -> Variable:
    return Variable(units, long_name, attrs={"comment": comment})


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
    if state.passed is not None:
        values |= {f"passed_{name}": column for name, column in zip(PASSED, state.passed.T, strict=True)}
    if state.plastic_indentation is not None:
        values["relative_plastic_area"] = float(np.mean(state.plastic_indentation > 0))
        values["mean_plastic_indentation"] = float(np.mean(state.plastic_indentation))
    return values


MECHANICS = Observable(
    {
        "mean_pressure": Variable("Pa", "mean normal pressure at the interface, compression positive"),
        "total_force": Variable("N", "mean pressure times the area of the cell, compression positive"),
        "mean_gap": Variable("m", "mean local gap minus the law's equilibrium distance"),
        "mean_separation": _noted(
            "m",
            "distance of the mean planes of block and surface minus the equilibrium distance",
            "conjugate to the pressure; layer: plane of its undeformed surface",
        ),
        "passed_pressure": Variable(
            "Pa", "mean pressure of each state passed since the last point; detached: the load", _PASSED
        ),
        "passed_separation": Variable(
            "m", "mean separation of each state passed since the last point; detached: infinite", _PASSED
        ),
        "passed_energy": Variable(
            "J m-2", "elastic and interaction energy per nominal area of each state passed", _PASSED
        ),
        "elastic_energy": _noted(
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
        "contact_stiffness": _noted(
            "Pa m-1",
            "contact stiffness -dp/du of the linearised problem",
            "u: mean gap; free boundaries: position of the undeformed surface",
        ),
        "dissipated_energy": Variable("J m-2", "energy dissipated in jumps so far per nominal area, without pull-off"),
        "dissipated_energy_resolution_error": Variable(
            "J m-2", "uncertainty of dissipated_energy: position of a jump within its step"
        ),
        "plastic_work": Variable("J m-2", "plastic work so far per nominal area"),
        "viscous_dissipation": Variable("J m-2", "energy dissipated by the viscoelastic solid so far per nominal area"),
        "temperature": _noted(
            "K",
            "kinetic temperature of the nodes, driven plane: in its frame",
            "by velocities in the middle of time steps",
        ),
        "kinetic_energy": _noted(
            "J m-2",
            "kinetic energy of nodes and rigid plane per nominal area",
            "by velocities at the end of time steps",
        ),
        "mechanical_energy": _noted(
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

SOLVER_REPORT = Observable(
    {
        "time": Variable("s", "time since the motion, or a path in time, began; of a point that of its last state"),
        "converged": Variable("1", "whether the step met the tolerance", kind="flag", attrs=FLAG),
        "detached": Variable(
            "1",
            "whether the surfaces are detached",
            kind="flag",
            attrs={
                **FLAG,
                "comment": "no contact carries the load, or no atom is in reach of a driven block; a continuum at a "
                "prescribed gap or approach does not detach",
            },
        ),
        "residual": _noted(
            "1",
            "error left in the equations of the model, in units of their own scales; see comment",
            "adhesive simulations: largest unbalanced stress over contact modulus, where surfaces touch "
            "a wall only what it would have to pull; hard wall without adhesion: largest gap inside or penetration "
            "outside the contact over rms height; Persson's theory: last change of the detachment stress over "
            "contact modulus; gap-flow theory: mean traction minus pressure over contact modulus, an error of its "
            "grid; edge flow: last change of a scale's mean response; atoms at a temperature: mean pressure minus "
            "the applied one over contact modulus, NaN where sampled at a prescribed gap; atoms in motion without "
            "one: largest unbalanced stress or missing load over contact modulus; driven block, which is not in "
            "balance: largest unbalanced stress, including thermal forces",
        ),
        "complementarity_residual": _noted(
            "1",
            "violation of the conditions of a wall or a hardness, over the contact modulus",
            "largest pull on the wall where surfaces touch, or pressure beyond a hardness",
        ),
        "iterations": Variable("1", "iterations of the solver", kind="count"),
        "fft_pairs": Variable("1", "pairs of Fourier transforms, in double-precision pairs of the finest grid"),
        "force_evaluations": Variable("1", "evaluations of the interface forces", kind="count"),
        "acceptance_rate": Variable("1", "accepted fraction of the proposals of thermal sampling"),
        "message": Variable("1", "message of the solver on the step", kind="text"),
    },
    lambda state, _: {name: value for name, value in asdict(state.report).items() if value is not None},
    averaged=False,
)


def edge_sides(contact: np.ndarray, periodic: bool = True) -> tuple[int, int]:
    """Sides along x and along y between cells in contact and others, across the edges of a periodic map too."""
    first = 0 if periodic else 1
    along_x = int(np.count_nonzero((contact != np.roll(contact, 1, axis=0))[first:]))
    along_y = int(np.count_nonzero((contact != np.roll(contact, 1, axis=1))[:, first:]))
    return along_x, along_y


def _area(state: InterfaceState, _: Bins) -> dict[str, Value]:
    areas = {"contact": state.contact, "repulsive": state.pressure > 0}
    sides = {kind: edge_sides(area, state.periodic) for kind, area in areas.items()}
    values: dict[str, Value] = {f"relative_{kind}_area": float(np.mean(area)) for kind, area in areas.items()}
    for kind, area in areas.items():
        values[f"corrected_{kind}_area"] = max(float(np.mean(area)) - OVERCOUNT * sum(sides[kind]) / area.size, 0.0)
    if state.spacing is not None:
        dy, dx = state.spacing
        along_x, along_y = sides["contact"]
        values["contact_perimeter"] = np.pi / 4 * (along_x * dx + along_y * dy) / (state.contact.size * dy * dx)
    return values


_CORRECTED = "over nominal area, corrected for the grid at its edge"
AREA = Observable(
    {
        "relative_contact_area": Variable("1", "contact area over nominal area"),
        "relative_repulsive_area": Variable("1", "area under positive pressure over nominal area"),
        "corrected_contact_area": Variable("1", f"contact area {_CORRECTED}"),
        "corrected_repulsive_area": Variable("1", f"area under positive pressure {_CORRECTED}"),
        "contact_perimeter": Variable("m-1", "length of the contact's edge, assumed isotropic, over nominal area"),
    },
    _area,
)


def cluster_map(contact: np.ndarray, periodic: bool = True) -> np.ndarray:
    """Number the clusters of a map, chains of neighbours along y or x, by size: 0 without contact, 1 in the largest."""
    from scipy import ndimage  # slow to import
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    labels, count = ndimage.label(contact)
    if not count:
        return labels
    one = np.concatenate([labels[0], labels[:, 0]])
    other = np.concatenate([labels[-1], labels[:, -1]])
    meet = (one > 0) & (other > 0) & periodic
    joined = coo_array((np.ones(np.count_nonzero(meet)), (one[meet] - 1, other[meet] - 1)), shape=(count, count))
    clusters, cluster_of = connected_components(joined, directed=False)
    points = np.bincount(labels.ravel(), minlength=count + 1)[1:]
    sizes = np.bincount(cluster_of, weights=points, minlength=clusters)
    rank = np.empty(clusters, int)
    rank[np.argsort(-sizes, kind="stable")] = np.arange(1, clusters + 1)
    return np.concatenate([[0], rank[cluster_of]])[labels]


def percolates(points: np.ndarray, periodic: bool = True) -> bool:
    """Whether a cluster of a map goes around the periodic cell, or joins two opposite rims of a free one.

    A simple way around crosses the edges of one axis an odd number of times: a cell of twice the periods tells all.
    """
    from scipy import ndimage
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    labels, count = ndimage.label(points)
    edges = ((labels[0], labels[-1], 1), (labels[:, 0], labels[:, -1], 2))
    if not periodic or not count:
        return any(bool(np.intersect1d(first[first > 0], last).size) for first, last, _ in edges)
    # Four copies of the map, numbered by the parity of the periods along both axes, 1 and 2.
    joins = []
    for first, last, axis in edges:
        meet = (first > 0) & (last > 0)
        joins += [(last[meet] - 1 + count * copy, first[meet] - 1 + count * (copy ^ axis)) for copy in range(4)]
    one, other = np.concatenate(joins, axis=1)
    joined = coo_array((np.ones(one.size), (one, other)), shape=(4 * count, 4 * count))
    clusters = connected_components(joined, directed=False)[1].reshape(4, count)
    return bool((clusters[1:] == clusters[0]).any())


def _clusters(state: InterfaceState, _: Bins) -> dict[str, Value]:
    sizes = np.bincount(cluster_map(state.contact, state.periodic).ravel())[1:]
    return {
        "cluster_count": sizes.size,
        "largest_cluster_area": float(sizes.max(initial=0) / state.contact.size),
        "contact_percolates": percolates(state.contact, state.periodic),
        "gap_percolates": percolates(~state.contact, state.periodic),
    }


CLUSTERS = Observable(
    {
        "cluster_count": Variable("1", "number of contact clusters", kind="count"),
        "largest_cluster_area": Variable("1", "area of the largest contact cluster over nominal area"),
        "contact_percolates": Variable("1", f"connected contact {_AROUND}", kind="flag", attrs=FLAG),
        "gap_percolates": Variable("1", f"connected gap {_AROUND}", kind="flag", attrs=FLAG),
    },
    _clusters,
)


@lru_cache(maxsize=2)
def _rings(
    shape: tuple[int, int], spacing: tuple[float, float], periodic: bool
) -> tuple[tuple[int, ...], np.ndarray, np.ndarray]:
    """Shape of the transforms, ring of each lag on it (RINGS beyond the largest), and pairs of each ring."""
    from scipy import fft  # slow to import

    # With free boundaries a map twice as large: no lag reaches across the edge.
    padded = shape if periodic else tuple(fft.next_fast_len(2 * n - 1, True) for n in shape)
    steps = [np.minimum(np.arange(n), n - np.arange(n)) for n in padded]
    down, across = (step * d for step, d in zip(steps, spacing, strict=True))
    side = min(n * d for n, d in zip(shape, spacing, strict=True))
    distance = np.hypot(down[:, None], across[None, :]) / side
    # The slack keeps a lag on a ring's edge inside, whatever its rounding.
    ring = np.searchsorted(RING_EDGES * (1 + 1e-12), distance.ravel(), side="left") - 1
    ring[(ring < 0) | (ring >= RINGS)] = RINGS
    inside = [np.full(n, n) if periodic else np.maximum(n - step, 0) for n, step in zip(shape, steps, strict=True)]
    pairs = np.outer(*inside).ravel()
    return padded, ring, np.bincount(ring, weights=pairs, minlength=RINGS + 1)[:RINGS]


def contact_autocorrelation(contact: np.ndarray, spacing: tuple[float, float], periodic: bool = True) -> np.ndarray:
    """Average χ(x) χ(x + r), χ = 1 in contact, over the pairs of points of each ring of lags r; NaN without a lag.

    −c'(0) is the length of the edge per area over π (P. Debye, H. R. Anderson & H. Brumberger, J. Appl. Phys. 28, 679
    (1957), for volumes). Rings are in units of the shorter side, ``spacing`` that of points along y and x (m).
    """
    from scipy import fft

    shape, ring, pairs = _rings((contact.shape[0], contact.shape[1]), spacing, periodic)
    spectrum = fft.rfft2(contact.astype(float), shape)
    touching = fft.irfft2(spectrum.real**2 + spectrum.imag**2, shape)
    sums = np.bincount(ring, weights=touching.ravel(), minlength=RINGS + 1)[:RINGS]
    return np.divide(sums, pairs, out=np.full(RINGS, np.nan), where=pairs > 0)


_PAIRS = "share of the pairs of points a distance apart that are both in contact"
AUTOCORRELATION = Observable(
    {"contact_autocorrelation": Variable("1", _PAIRS, ("step", "relative_distance"))},
    lambda state, _: (
        {}
        if state.spacing is None
        else {"contact_autocorrelation": contact_autocorrelation(state.contact, state.spacing, state.periodic)}
    ),
    averaged=False,  # rings without a lag have no mean
)

OBSERVABLES: list[Observable] = [MECHANICS, FURTHER, AREA, CLUSTERS, AUTOCORRELATION, SOLVER_REPORT]

ENTRIES: dict[str, Variable] = {
    name: variable for observable in OBSERVABLES for name, variable in observable.variables.items()
}

# Those whose value for an ensemble is the mean over its states.
AVERAGED: set[str] = {name for observable in OBSERVABLES if observable.averaged for name in observable.variables}


def observed(state: InterfaceState, bins: Bins) -> dict[str, Value]:
    """Read every observable off a state, distributions on the given bins; returns values by name."""
    return {name: value for observable in OBSERVABLES for name, value in observable.read(state, bins).items()}


def recorded(point: InterfaceState | Step, bins: Bins, fields: bool = False) -> Step:
    """The step of a state, with its fields if asked, or of quantities of theories, every distribution on the bins."""
    if isinstance(point, InterfaceState):
        kept = {"gap": point.gap, "pressure": point.pressure} if fields else {}
        if fields and point.plastic_indentation is not None:
            kept["plastic_indentation"] = point.plastic_indentation
        return Step(observed(point, bins), {**kept, **point.atoms}, point.restart, bins)
    edges = bins.edges_of
    functions = {key: value for key, value in point.values.items() if callable(value)}
    densities = {key: function(edges[key.rpartition("/")[2]]) for key, function in functions.items()}
    return replace(point, values={**point.values, **densities}, bins=bins)
