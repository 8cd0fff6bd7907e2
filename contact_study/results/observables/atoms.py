"""Atoms of a state by their names in a dataset: positions, velocities, and stresses of the substrate."""

from collections.abc import Mapping

import numpy as np

from contact_study.numerics.grid import Grid
from contact_study.results.state import Value, Variable

_PLANE = ("step", "y", "x")
_NODES = ("step", "node")

ATOMS: dict[str, Variable] = {
    "lateral_displacement_x": Variable("m", "displacement of a surface atom along x from its rest position", _PLANE),
    "lateral_displacement_y": Variable("m", "displacement of a surface atom along y from its rest position", _PLANE),
    "atom_height": Variable("m", "height of a surface atom over the mean plane of the substrate", _PLANE),
    "shear_stress_x": Variable("Pa", "force of the substrate on a surface atom along x over its area", _PLANE),
    "shear_stress_y": Variable("Pa", "force of the substrate on a surface atom along y over its area", _PLANE),
    "normal_stress": Variable("Pa", "stress of the substrate on a surface atom, compression positive", _PLANE),
    **{f"velocity_{axis}": Variable("m s-1", f"velocity of a surface atom along {axis}", _PLANE) for axis in "xyz"},
    "node_x": Variable("m", "position of a node of the block along x", _NODES),
    "node_y": Variable("m", "position of a node of the block along y", _NODES),
    "node_z": Variable("m", "height of a node of the block over the mean plane of the substrate", _NODES),
    **{f"node_velocity_{i}": Variable("m s-1", f"velocity of a node of the block along {i}", _NODES) for i in "xyz"},
}

# Quantities that do not change along the path.
SURROUNDINGS: dict[str, Variable] = {
    "substrate_height": Variable("m", "height of a site of the substrate", ("site_y", "site_x")),
    "atom_mass": Variable("kg", "mass of an atom of the block", ()),
    "node_mass": Variable("kg", "mass of a node of the block; the rigid plane's is shared by its nodes", ("node",)),
    "node_level": Variable("1", "level of a node of the block: cells of 2^level lattice constants", ("node",), "count"),
}

SITES: dict[str, Variable] = {
    "site_y": Variable("m", "position of a site of the substrate along y", ("site_y",)),
    "site_x": Variable("m", "position of a site of the substrate along x", ("site_x",)),
}


def surface_atoms(
    displacement: np.ndarray, stress: np.ndarray, velocity: np.ndarray | None = None
) -> dict[str, np.ndarray]:
    """Return the bottom layer's positions (m), stresses (Pa) and velocities (m/s), shape (3, ny, nx) each, by name."""
    given = [*displacement, *stress, *(() if velocity is None else velocity)]
    return {name: np.array(field) for name, field in zip(ATOMS, given, strict=False)}


def block_nodes(position: np.ndarray, velocity: np.ndarray) -> dict[str, np.ndarray]:
    """Return positions (m) and velocities (m/s) of an explicit block, shape (3, nodes) each, by name."""
    names = [name for name in ATOMS if name.startswith("node_")]
    return {name: np.array(field) for name, field in zip(names, [*position, *velocity], strict=True)}


def substrate_sites(heights: np.ndarray, size: tuple[float, float]) -> Mapping[str, Value]:
    """Return heights, shape (site_y, site_x), and positions of the substrate's sites (m) by name, the first at zero."""
    y, x = Grid((heights.shape[0], heights.shape[1]), size).coordinates
    return {"site_y": y, "site_x": x, "substrate_height": heights}
