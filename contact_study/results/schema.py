"""Schema of all datasets: names, dimensions, units and meanings; here those of the campaign and of the theories.

Distributions are on ``gap_bin`` and ``pressure_bin``, as a dataset cannot hold a field and a dimension of one name.
A model labels a quantity by its key: ``"gap_flow/mean_gap"`` is on the dimension ``theory``, and
``"gap_flow/loading/mean_gap"`` in the group ``metastable`` also on ``metastable_branch``.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np

from contact_study.numerics.grid import Grid
from contact_study.physics.roughness.statistics import Roughness
from contact_study.results.observables import AVERAGED, ENTRIES, OBSERVABLES
from contact_study.results.path_results import PATH_RESULTS
from contact_study.results.state import FLAG, Observable, Value, Variable

SCHEMA_VERSION = "2.2"
CONVENTIONS = "CF-1.11"

SPECTRUM_MARK = "@"  # between the names of a theory and of its spectrum, if not its study's first: "edge_flow@surface"

LABELS = ("theory", "metastable_branch")  # dimensions of the labels in a quantity's key
LABELLED_GROUPS = ("", "", "metastable")  # group by their number
TRAJECTORY, FRAME = "trajectory", "frame"  # group of the time series, also the label of such a quantity; its dimension

# Suffixes of quantities that belong to a mean over thermal states.
STANDARD_ERROR = "_standard_error"
AUTOCORRELATION_TIME = "_autocorrelation_time"
AUTOCORRELATION_STATES = "_autocorrelation_states"
# Unit (None: that of the mean) and meaning of each suffix.
OF_A_MEAN: dict[str, tuple[str | None, str]] = {
    STANDARD_ERROR: (None, "standard error of the mean"),
    AUTOCORRELATION_TIME: ("s", "integrated autocorrelation time (NaN: too few states)"),
    AUTOCORRELATION_STATES: ("1", "integrated autocorrelation time in states (NaN: too few)"),
}

# Suffix of the difference between a theory's quantity and that at half the resolution, without sign, and prefix of a
# constant whose key is swept: the plain name is that of the dimension, with the prescribed values.
RESOLUTION_ERROR = "_resolution_error"
REALISED = "realised_"

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

BY_ATOM = (*ATOMS, *SURROUNDINGS)

SITES: dict[str, Variable] = {
    "site_y": Variable("m", "position of a site of the substrate along y", ("site_y",)),
    "site_x": Variable("m", "position of a site of the substrate along x", ("site_x",)),
}

# Quantities of a case that do not change along its path: interface, surface and grid, alike for every model.
CONSTANTS: dict[str, Variable] = {
    "contact_modulus": Variable("Pa", "contact modulus", ()),
    "counter_contact_modulus": Variable("Pa", "modulus E* of the second body, combined in contact_modulus", ()),
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
    "work_of_adhesion_map": Variable("J m-2", "local work of adhesion", ("y", "x")),
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
_AT = ("step", "wavevector")

VARIABLES: dict[str, Variable] = {
    **ENTRIES,
    "wall_time": Variable("s", "wall-clock time of the step"),
    "predictor_field": Variable(
        "1", "SHA-256 of the predictor's gap field at the start of the step; empty: no field", kind="text"
    ),
    "gap": Variable("m", "local gap: height of the block's surface over the rigid one", ("step", "y", "x")),
    "pressure": Variable("Pa", "local pressure, compression positive", ("step", "y", "x")),
    "plastic_indentation": Variable(
        "m", "plastic indentation, to be subtracted from the heights of the surface", ("step", "y", "x")
    ),
    "relative_contact_area_at": Variable(
        "1", "apparent relative contact area at a magnification, Persson's theory", _AT
    ),
    "detachment_stress": Variable("Pa", "largest tensile stress at a magnification, Persson's theory", _AT),
    "effective_work_of_adhesion": Variable("J m-2", "work of adhesion at a magnification, Persson's theory", _AT),
    "pressure_pdf_at": Variable(
        "Pa-1",
        "probability density of the interfacial pressure at a magnification, Persson's theory",
        ("step", "magnification", "pressure_bin"),
    ),
    "contact_stress": Variable("Pa", "mean stress inside the contact, compression positive, Persson's theory"),
    "edge_stress": Variable("Pa", "mean stress at detached edges, compression positive, Persson's theory"),
    "local_mean_pressure": Variable(
        "Pa",
        "mean of the local pressures, compression positive, gap flow and edge flow",
        attrs={"comment": "minus mean pressure: error of the edge flow, resolution of the gap flow"},
    ),
    "stress_balance": Variable("1", "carried stress over applied pressure"),
    "resolved": Variable(
        "1", "whether the estimated errors of the resolution are within theory.accuracy", kind="flag", attrs=FLAG
    ),
    "energy_defect": Variable(
        "m", "derivative of the interfacial energy by pressure at zero pressure, Persson's theory", ()
    ),
    "finest_tabor_number": Variable("1", "Tabor parameter of the whole roughness, of radius 2 / rms Laplacian", ()),
    "local_tabor_number": Variable("1", "Tabor parameter of the roughness up to a wavevector", ("wavevector",)),
    "persson_tosatti_ratio": Variable(
        "1", "work of adhesion on the true area over elastic energy of full contact (Persson, Tosatti)", ()
    ),
    "pastewka_robbins_ratio": Variable(
        "1", "work of adhesion over that of sticking light contact (Pastewka, Robbins), experimental", ()
    ),
    "apparent_adhesion_ratio": Variable(
        "1", "apparent work of adhesion on unloading over that on loading, by the edge flow", ()
    ),
    "area_error_in_atlas": Variable(
        "1", "mean size of the relative error of the contact area in the contact atlas", ()
    ),
    "dmt_tension_ratio": Variable(
        "1", "tension within the range over the pressure of light contact, adhesion DMT-like", ()
    ),
    "bearing_area_ratio": Variable(
        "1", "work of adhesion over that of a sticking bearing-area model (Ciavarella), experimental", ()
    ),
    "bearing_area_pull_off": Variable(
        "Pa", "lowest pressure of a bearing-area model (after Ciavarella), experimental", ()
    ),
    "contact_modulus_at": Variable("Pa", "contact modulus of a wave of the surface", ("wavevector",)),
    **ATOMS,
    **PATH_RESULTS,
    **CONSTANTS,
    **SURROUNDINGS,
    **ROUGHNESS,
}

COORDINATES: dict[str, Variable] = {
    "pressure_bin": Variable("Pa", "interfacial pressure, compression positive (bin centre)", ("pressure_bin",)),
    "gap_bin": Variable("m", "local gap (bin centre)", ("gap_bin",)),
    "relative_distance": Variable(
        "1", "distance over the shorter side of the cell (middle of a ring)", ("relative_distance",)
    ),
    "relative_patch_area": Variable(
        "1", "area of a contact cluster over that of the cell (middle of an octave)", ("relative_patch_area",)
    ),
    "wavevector": Variable("m-1", "roughness wavevector", ("wavevector",)),
    "magnification": Variable(
        "1", "magnification: wavevector up to which roughness counts over the smallest one", ("magnification",)
    ),
    "spectrum_wavevector": Variable(
        "m-1", "roughness wavevector of the surface's own spectrum", ("spectrum_wavevector",)
    ),
    "y": Variable("m", "position along y", ("y",)),
    "x": Variable("m", "position along x", ("x",)),
    **SITES,
    "step": Variable("1", "point of the loading path", ("step",), kind="count"),
    "theory": Variable("1", "theory", ("theory",), kind="text"),
    "metastable_branch": Variable(
        "1", "metastable branch on either side of the equilibrium", ("metastable_branch",), kind="text"
    ),
    "applied_pressure": Variable("Pa", "prescribed mean pressure"),
    "applied_approach": Variable("m", "prescribed approach beyond first touch at the law's equilibrium distance"),
    "applied_gap": Variable("m", "prescribed distance minus equilibrium distance: mean gap (atoms: mean separation)"),
    "branch": Variable(
        "1",
        "branch of the loading path",
        kind="flag",
        attrs={"flag_values": np.array([-1, 0, 1], np.int8), "flag_meanings": "absent loading unloading"},
    ),
}


def register_observable(observable: Observable) -> None:
    """Make an observable from outside the package a part of every dataset of the simulations.

    Parameters
    ----------
    observable : Observable
        Its variables, and the function that reads them off a state.

    Returns
    -------
    None

    Raises
    ------
    ValueError
        If a dataset has a variable of one of its names.

    Examples
    --------
    >>> import contact_study
    >>> from contact_study.results.state import Observable, Variable
    >>> largest = Variable("m", "largest local gap")
    >>> read = lambda state, bins: {"largest_gap": float(state.gap.max())}
    >>> contact_study.register_observable(Observable({"largest_gap": largest}, read))  # doctest: +SKIP
    """
    if observable in OBSERVABLES:
        return
    if taken := sorted(observable.variables.keys() & VARIABLES.keys()):
        raise ValueError(f"observable: {taken[0]} is a variable already; give another name")
    OBSERVABLES.append(observable)
    VARIABLES.update(observable.variables)
    if observable.averaged:
        AVERAGED.update(observable.variables)


def variable_of(name: str) -> Variable:
    """Return the entry of a quantity or coordinate."""
    if name.startswith(REALISED):
        known = VARIABLES[name.removeprefix(REALISED)]
        return replace(known, long_name=f"{known.long_name}, as realised by the model")
    for suffix, (units, words) in OF_A_MEAN.items():
        if name.endswith(suffix):
            known = VARIABLES[name.removesuffix(suffix)]
            named = f"{words}: {known.long_name}"
            return replace(known, units=units or known.units, long_name=named, kind="float", attrs={})
    if name.endswith(RESOLUTION_ERROR):
        known = VARIABLES[name.removesuffix(RESOLUTION_ERROR)]
        return replace(known, long_name=f"resolution error: {known.long_name}")
    return COORDINATES[name] if name in COORDINATES else VARIABLES[name]


@cache
def quantity_of(key: str) -> tuple[tuple[str, ...], str]:
    """Split a quantity's key, ``"gap_flow/loading/mean_gap"``, into labels and name."""
    *labels, name = key.split("/")
    return tuple(labels), name


def heights_on(grid: Grid, heights: np.ndarray, *names: str) -> Mapping[str, Value]:
    """Positions along y and x and heights of the surface (m), by their names in a dataset or those given."""
    return dict(zip(names or ("y", "x", "height"), (*grid.coordinates, heights), strict=True))


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
