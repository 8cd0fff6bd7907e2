"""Quantities of a case that do not change along its path: interface, surface and grid, alike for every model."""

from collections.abc import Mapping

import numpy as np

from contact_study.numerics.grid import Grid
from contact_study.physics.roughness.statistics import Roughness
from contact_study.results.state import Value, Variable

CONSTANTS: dict[str, Variable] = {
    "contact_modulus": Variable("Pa", "contact modulus", ()),
    "work_of_adhesion": Variable("J m-2", "work of adhesion", ()),
    "equilibrium_distance": Variable("m", "distance of flat surfaces without load", ()),
    "peak_tensile_stress": Variable("Pa", "largest tensile stress of flat surfaces (cohesive strength)", ()),
    "peak_distance": Variable("m", "distance of flat surfaces at the largest tensile stress", ()),
    "rms_height": Variable("m", "root-mean-square height of the surface", ()),
    "rms_slope": Variable("1", "root-mean-square slope of the surface", ()),
    "interaction_length": Variable("m", "length of the adhesive law: zero stress, or range of a wall's", ()),
    "contact_distance": Variable("m", "gaps below it count as contact", ()),
    "pixel": Variable("m", "largest grid spacing", ()),
    "process_zone": Variable("m", "length of the process zone at the edge of a contact", ()),
    "height": Variable("m", "height of the rigid surface, toward the block", ("y", "x")),
}
ROUGHNESS: dict[str, Variable] = {
    "surface_points_y": Variable("1", "points of the surface along y: of a measured map its own", (), kind="count"),
    "surface_points_x": Variable("1", "points of the surface along x: of a measured map its own", (), kind="count"),
    "surface_size_y": Variable("m", "period of the surface along y", ()),
    "surface_size_x": Variable("m", "period of the surface along x", ()),
    "rms_curvature": Variable("m-1", "root-mean-square mean curvature of the surface, half of its rms Laplacian", ()),
    "edge_jump": Variable("m", "root-mean-square difference of heights across the worse edge of the cell", ()),
    "edge_jump_ratio": Variable("1", "rms difference of heights across an edge over that of neighbouring lines", ()),
    "filled_fraction": Variable("1", "fraction of the points of a measured map that were missing and filled", ()),
    "fitted_hurst_exponent": Variable("1", "Hurst exponent of the self-affine fit to the spectrum", ()),
    "fitted_hurst_exponent_error": Variable("1", "standard deviation of the fitted Hurst exponent", ()),
    "fitted_roll_off": Variable("m-1", "roll-off wavevector of the self-affine fit", ()),
    "fitted_cutoff": Variable("m-1", "cut-off wavevector of the self-affine fit", ()),
    "power_spectrum": Variable(
        "m4", "radial power spectrum C(q) of the surface, h_rms² = 2π ∫ q C dq", ("spectrum_wavevector",)
    ),
}
SPECTRUM_WAVEVECTOR = Variable("m-1", "roughness wavevector of the surface's own spectrum", ("spectrum_wavevector",))


def heights_on(grid: Grid, heights: np.ndarray) -> Mapping[str, Value]:
    """Heights of the surface and their positions (m), by their names in a dataset."""
    y, x = grid.coordinates
    return {"y": y, "x": x, "height": heights}


def roughness_values(roughness: Roughness) -> Mapping[str, Value]:
    """Statistics of a periodic surface, and of a map's sample alone, by their names in a dataset."""
    grid, fit, spectrum = roughness.grid, roughness.sample.fit, roughness.spectrum
    values: dict[str, Value] = {
        "surface_points_y": grid.shape[0],
        "surface_points_x": grid.shape[1],
        "surface_size_y": grid.size[0],
        "surface_size_x": grid.size[1],
        "rms_curvature": roughness.rms_curvature,
        "edge_jump": roughness.edge_jump,
        "edge_jump_ratio": roughness.edge_ratio,
        "filled_fraction": roughness.filled,
        "spectrum_wavevector": spectrum.wavevectors,
        "power_spectrum": spectrum.density,
    }
    if fit is not None:
        values["fitted_hurst_exponent"], values["fitted_hurst_exponent_error"] = fit.hurst_exponent, fit.uncertainty
        values["fitted_roll_off"], values["fitted_cutoff"] = fit.roll_off, fit.cutoff
    return values
