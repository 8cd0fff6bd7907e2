"""What the surface of a case is like, beside its constants, the same names for every model."""

from collections.abc import Mapping

from contact_study.physics.roughness.statistics import Roughness
from contact_study.results.state import Value, Variable

ROUGHNESS: dict[str, Variable] = {
    "surface_points_y": Variable("1", "points of the surface along y: of a measured map its own", (), kind="count"),
    "surface_points_x": Variable("1", "points of the surface along x: of a measured map its own", (), kind="count"),
    "surface_size_y": Variable("m", "period of the surface along y", ()),
    "surface_size_x": Variable("m", "period of the surface along x", ()),
    "rms_curvature": Variable("m-1", "root-mean-square mean curvature of the surface, half of its rms Laplacian", ()),
    "edge_jump": Variable("m", "root-mean-square difference of heights across the worse edge of the cell", ()),
    "edge_jump_ratio": Variable(
        "1", "root-mean-square difference of heights across an edge of the cell over that of neighbouring lines", ()
    ),
    "filled_fraction": Variable("1", "fraction of the points of a measured map that were missing and filled", ()),
    "fitted_hurst_exponent": Variable("1", "Hurst exponent of the self-affine law that fits the spectrum best", ()),
    "fitted_hurst_exponent_error": Variable("1", "standard deviation of that exponent", ()),
    "fitted_roll_off": Variable("m-1", "wavevector below which that law is flat", ()),
    "fitted_cutoff": Variable("m-1", "wavevector up to which that law holds", ()),
    "power_spectrum": Variable(
        "m4", "radial power spectrum C(q) of the surface, h_rms² = 2π ∫ q C dq", ("spectrum_wavevector",)
    ),
}
SPECTRUM_WAVEVECTOR = Variable("m-1", "roughness wavevector of the surface's own spectrum", ("spectrum_wavevector",))


def roughness_values(roughness: Roughness, sample: Roughness, filled: float) -> Mapping[str, Value]:
    """A surface's numbers by their names in a dataset.

    Parameters
    ----------
    roughness, sample : Roughness
        What it is like repeated, and by itself; see :attr:`contact_study.physics.surfaces.surface.Surface.sample`.
    filled : float
        Fraction of the points of a measured map that were missing.
    """
    grid, fit, spectrum = roughness.grid, sample.fit, roughness.spectrum
    law = (
        {}
        if fit is None
        else {
            "fitted_hurst_exponent": fit.hurst_exponent,
            "fitted_hurst_exponent_error": fit.uncertainty,
            "fitted_roll_off": fit.roll_off,
            "fitted_cutoff": fit.cutoff,
        }
    )
    return {
        "surface_points_y": grid.shape[0],
        "surface_points_x": grid.shape[1],
        "surface_size_y": grid.size[0],
        "surface_size_x": grid.size[1],
        "rms_curvature": roughness.rms_curvature,
        "edge_jump": roughness.edge_jump,
        "edge_jump_ratio": roughness.edge_ratio,
        "filled_fraction": filled,
        **law,
        "spectrum_wavevector": spectrum.wavevectors,
        "power_spectrum": spectrum.density,
    }
