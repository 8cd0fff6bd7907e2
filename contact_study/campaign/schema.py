"""The one schema of all datasets: names, dimensions, units and meanings.

``gap`` and ``pressure`` are the fields; a dataset cannot hold a field and a dimension of one name, so the
distributions stand on ``gap_bin`` and ``pressure_bin``.

One dataset may hold several theories side by side: what they share stands on the dimension ``theory``, and the
metastable branches that enclose them in the group ``metastable``, on the dimension ``metastable_branch``, too. A model
says so by the name it gives a quantity: ``"gap_flow/mean_gap"``, ``"gap_flow/loading/mean_gap"``.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

SCHEMA_VERSION = "2.0"
CONVENTIONS = "CF-1.11"

# Dimensions of the labels before a quantity's name, and the group for so many of them.
LABELS = ("theory", "metastable_branch")
LABELLED_GROUPS = ("", "", "metastable")


@dataclass(frozen=True)
class Variable:
    """How one quantity stands in a dataset.

    Parameters
    ----------
    units : str
        UDUNITS.
    long_name : str
        What it is, in words.
    dims : tuple of str
        Dimensions beyond those of the sweep.
    kind : str
        ``"float"``, ``"count"``, ``"flag"`` or ``"text"``.
    attrs : dict
        Further attributes.
    """

    units: str
    long_name: str
    dims: tuple[str, ...] = ("step",)
    kind: str = "float"
    attrs: dict[str, Any] = field(default_factory=dict)

    @property
    def empty(self) -> Any:
        """What stands where a case has no such point."""
        return {"float": np.nan, "count": np.int32(-1), "flag": np.int8(-1), "text": ""}[self.kind]

    @property
    def dtype(self) -> Any:
        """Type in memory."""
        return {"float": np.float64, "count": np.int32, "flag": np.int8, "text": object}[self.kind]

    @property
    def encoding(self) -> dict[str, Any]:
        """How it is written."""
        if self.kind == "text":
            return {}
        if self.kind == "flag":  # integers for the reader too; "absent" is one of the flag's values
            return {"_FillValue": None}
        fill = np.nan if self.kind == "float" else self.empty
        compressed = {"zlib": True, "complevel": 1, "shuffle": True} if len(self.dims) > 1 else {}
        return {"_FillValue": fill, **compressed}


_FLAG = {"flag_values": np.array([-1, 0, 1], np.int8), "flag_meanings": "absent no yes"}

VARIABLES: dict[str, Variable] = {
    "mean_pressure": Variable("Pa", "mean normal pressure at the interface, compression positive"),
    "mean_gap": Variable("m", "mean of the local gap, less the law's equilibrium distance"),
    "mean_separation": Variable(
        "m",
        "distance of the mean planes of block and surface, less the equilibrium distance; conjugate to the pressure. "
        "Of a layer the plane of its undeformed surface, which moves with its base",
    ),
    "relative_contact_area": Variable("1", "contact area over nominal area"),
    "relative_repulsive_area": Variable("1", "area under positive pressure over nominal area"),
    "elastic_energy": Variable("J m-2", "elastic energy per nominal area"),
    "interaction_energy": Variable("J m-2", "interaction energy per nominal area"),
    "pressure_pdf": Variable("Pa-1", "probability density of the interfacial pressure", ("step", "pressure_bin")),
    "gap_pdf": Variable("m-1", "probability density of the local gap", ("step", "gap_bin")),
    "converged": Variable("1", "whether the step met the tolerance", kind="flag", attrs=_FLAG),
    "detached": Variable("1", "whether no contact survives at this point", kind="flag", attrs=_FLAG),
    "residual": Variable(
        "1",
        "error left in the equations of the model, in units of their own scales; see comment",
        attrs={
            "comment": "adhesive simulations: largest unbalanced stress over contact modulus; hard wall: largest gap "
            "inside or penetration outside the contact over rms height; Persson's theory: last change of the "
            "detachment stress over contact modulus; gap-flow theory: mean traction less pressure over contact "
            "modulus, an error of its grid"
        },
    ),
    "iterations": Variable("1", "iterations of the solver", kind="count"),
    "wall_time": Variable("s", "wall-clock time of the step"),
    "message": Variable("1", "what the solver has to say of the step", kind="text"),
    "predictor_field": Variable(
        "1", "SHA-256 of the predictor's gap field that the step started from; empty: from the step before", kind="text"
    ),
    "fft_pairs": Variable("1", "pairs of Fourier transforms, in equivalents of the finest grid in double precision"),
    "force_evaluations": Variable("1", "evaluations of the interface forces", kind="count"),
    "height": Variable("m", "height of the rigid surface, toward the block", ("y", "x")),
    "gap": Variable("m", "local gap: height of the block's surface over the rigid one", ("step", "y", "x")),
    "pressure": Variable("Pa", "local pressure, compression positive", ("step", "y", "x")),
    "relative_contact_area_at": Variable(
        "1", "apparent relative contact area at a magnification, Persson's theory", ("step", "wavevector")
    ),
    "detachment_stress": Variable(
        "Pa", "largest tensile stress at a magnification, Persson's theory", ("step", "wavevector")
    ),
    "effective_work_of_adhesion": Variable(
        "J m-2", "work of adhesion at a magnification, Persson's theory", ("step", "wavevector")
    ),
    "contact_stress": Variable("Pa", "mean stress carried inside the contact, compression positive, Persson's theory"),
    "edge_stress": Variable("Pa", "mean stress carried at detached edges, compression positive, Persson's theory"),
    "energy_defect": Variable(
        "m", "derivative of the interfacial energy by pressure at zero pressure, Persson's theory", ()
    ),
    "pull_off_pressure": Variable("Pa", "lowest pressure that an adhered state carries", ()),
    "contact_modulus": Variable("Pa", "contact modulus", ()),
    "contact_modulus_at": Variable("Pa", "contact modulus of a wave of the surface", ("wavevector",)),
    "work_of_adhesion": Variable("J m-2", "work of adhesion", ()),
    "equilibrium_distance": Variable("m", "distance of flat surfaces without load", ()),
    "peak_tensile_stress": Variable("Pa", "largest tensile stress of flat surfaces", ()),
    "peak_distance": Variable("m", "distance of flat surfaces at the largest tensile stress", ()),
    "rms_height": Variable("m", "root-mean-square height of the surface", ()),
    "rms_slope": Variable("1", "root-mean-square slope of the surface", ()),
    "contact_distance": Variable("m", "gaps below it count as contact", ()),
    "pixel": Variable("m", "largest grid spacing", ()),
    "process_zone": Variable("m", "length over which the law bridges the edge of a contact", ()),
}

COORDINATES: dict[str, Variable] = {
    "pressure_bin": Variable("Pa", "interfacial pressure, compression positive (bin centre)", ("pressure_bin",)),
    "gap_bin": Variable("m", "local gap (bin centre)", ("gap_bin",)),
    "wavevector": Variable("m-1", "roughness wavevector", ("wavevector",)),
    "y": Variable("m", "position along y", ("y",)),
    "x": Variable("m", "position along x", ("x",)),
    "step": Variable("1", "point of the loading path", ("step",), kind="count"),
    "theory": Variable("1", "theory", ("theory",), kind="text"),
    "metastable_branch": Variable(
        "1", "metastable branch on either side of the equilibrium", ("metastable_branch",), kind="text"
    ),
    "applied_pressure": Variable("Pa", "prescribed mean pressure"),
    "applied_gap": Variable(
        "m", "prescribed distance less the equilibrium distance: mean gap (atoms: mean separation)"
    ),
    "branch": Variable(
        "1",
        "branch of the loading path",
        kind="flag",
        attrs={"flag_values": np.array([-1, 0, 1], np.int8), "flag_meanings": "absent loading unloading"},
    ),
}


def variable_of(name: str) -> Variable:
    """The entry of a quantity or coordinate."""
    return COORDINATES[name] if name in COORDINATES else VARIABLES[name]


def quantity_of(key: str) -> tuple[tuple[str, ...], str]:
    """Labels and name of a quantity as a model names it: ``"gap_flow/loading/mean_gap"``."""
    *labels, name = key.split("/")
    return tuple(labels), name
