"""Small datasets of the three models with known numbers, assembled as a campaign assembles its own."""

import functools
import tempfile
import tomllib
from pathlib import Path

import numpy as np

from contact_study.campaign.dataset.assembly import assemble
from contact_study.campaign.dataset.file import write_dataset
from contact_study.report.read.datasets import read_inputs
from contact_study.results.observables import FIXED_COORDINATES
from contact_study.results.schema import SCHEMA_VERSION
from contact_study.study.case import realise
from contact_study.study.study import make_study

STUDY = """
[study]
title = "synthetic"
[surface]
kind = "self_affine"
size = "416 angstrom"
shape = [24, 24]
rms_height = "7 angstrom"
roll_off_mode = 2
cutoff_mode = 6
normalisation = "realised"
[material]
youngs_modulus = "77.2 GPa"
poissons_ratio = 0.42
lattice_constant = "2.6 angstrom"
[interaction]
well_depth = "18.6 meV"
length = "3.28 angstrom"
contact_distance = "3.68 angstrom"
[loading]
path = ["0.1 GPa", "0.7799 GPa", "5.8725 GPa"]
[output]
fields = true
pressure_bins = 40
gap_bins = 30
[theory]
spectrum = "analytic"
[sweep]
"interaction.well_depth_ratio" = [1, 8]
[[override]]
when = { "interaction.well_depth_ratio" = 8 }
"loading.path" = ["0.1 GPa", "-0.4987 GPa", "0.7799 GPa", "5.8725 GPa"]
"""

# The same contact at prescribed gaps, down to compression.
GAP_STUDY = (
    STUDY[: STUDY.index("[[override]]")]
    .replace("[loading]", '[loading]\ncontrol = "gap"')
    .replace('"0.1 GPa", "0.7799 GPa", "5.8725 GPa"', '"1 nm", "0.7 nm", "0.3 nm", "0.2 nm"')
)

SINGLE = STUDY[: STUDY.index("[sweep]")]
LOOP = SINGLE.replace("[output]", "unload = true\n[output]")
HARD = SINGLE.replace('well_depth = "18.6 meV"', 'law = "hard_wall"')
HARD = HARD.replace('length = "3.28 angstrom"\ncontact_distance = "3.68 angstrom"\n', "")
SEEDS = np.array([1, 2, 3])
SEEDED = STUDY.replace("[sweep]\n", '[sweep]\n"surface.seed" = [1, 2, 3]\n')
HEIGHTS = STUDY.replace("[sweep]\n", '[sweep]\n"surface.rms_height" = ["9 angstrom", "10 angstrom", "12 angstrom"]\n')
MODULUS, H_RMS = 77.2e9 / (1 - 0.42**2), 7e-10  # no power of ten: tells units of h_rms from others
PRESSURES = {1: [0.1e9, 0.7799e9, 5.8725e9], 8: [0.1e9, -0.4987e9, 0.7799e9, 5.8725e9]}

# Contact areas are the continuum's times these, mean gaps the continuum's plus these (m).
AREA_FACTOR = {"continuum": 1.0, "atomistic": 0.9, "persson": 0.5, "gap_flow": 1.25}
GAP_SHIFT = {"continuum": 0.0, "atomistic": 0.5e-10, "persson": -1e-10, "gap_flow": 0.2e-10}
# The gap-flow theory's branches: areas times these, mean gaps divided by them.
BRANCH_FACTOR = {"loading": 0.8, "unloading": 1.1}


def area(ratio, pressure, seed=1, model="continuum"):
    """Made-up contact areas."""
    return AREA_FACTOR[model] * (1 - np.exp(-(0.05 * ratio + pressure / 8e9) * (1 + 0.01 * seed) - 0.02))


def gap(ratio, pressure, seed=1, model="continuum"):
    """Made-up mean gaps (m)."""
    return 1e-9 * (0.3 + 0.01 * seed) * np.exp(-pressure / 2e9) / ratio + GAP_SHIFT[model]


def pressure_at(applied_gap):
    """The made-up mean pressure at a prescribed gap: tension beyond half a nanometre."""
    return 1e9 * (0.5 - applied_gap / 1e-9)


def of_seeds(made, ratio):
    """Made-up values of the continuum on the path, a seed a row."""
    return made(ratio, np.array([PRESSURES[ratio]]), SEEDS[:, None])


def standard_error(values):
    return np.std(values, axis=0, ddof=1) / np.sqrt(len(values))


def study(text=STUDY):
    return make_study(tomllib.loads(text))


@functools.cache
def _written(*made):
    with tempfile.TemporaryDirectory() as folder:
        _assemble(path := Path(folder, "made.nc"), *made)
        return path.read_bytes()


def write(path, kind, text=STUDY, unconverged=(), detached=(), **attrs):
    """Write the dataset of one model; ``unconverged`` and ``detached`` are pairs (case number, step)."""
    path.write_bytes(_written(kind, text, frozenset(unconverged), frozenset(detached), frozenset(attrs.items())))
    return path


def _assemble(path, kind, text, unconverged, detached, attrs):
    asked = study(text)
    bins, cases = asked.bins, []
    for number, case in enumerate(asked.cases):
        steps = [
            {
                **_values(case, bins, kind, prescribed),
                "branch": branch == "unloading",
                "converged": (number, step) not in unconverged,
                "detached": (number, step) in detached,
            }
            for step, (prescribed, branch) in enumerate(case.path)
        ]
        cases.append((case.index, _constants(case, kind), steps))
    longest = max(len(steps) for _, _, steps in cases)
    along = {"pressure_bin": bins.pressure, "gap_bin": bins.gap, **FIXED_COORDINATES}
    groups = assemble(asked.sweep, longest, cases, along)
    own = {"title": asked.title, "source": f"synthetic {kind}", "model": kind, "study_toml": asked.toml}
    own |= {"history": "2026-01-01T00:00:00+00:00: made up", "references": "none", "warnings": ""}
    own |= {"schema_version": SCHEMA_VERSION, "version": "0.1.0", "git_commit": "0" * 40, "Conventions": "CF-1.11"}
    groups[""].attrs.update(own | dict(attrs))
    write_dataset(path, groups)


def write_all(folder, text=STUDY, kinds=("continuum", "atomistic", "theory"), **options):
    return [write(folder / f"{kind}.nc", kind, text, **options) for kind in kinds]


def read(folder, text=STUDY, kinds=("continuum", "atomistic"), average=None, **options):
    """Write datasets of some kinds and read them as a comparison does."""
    return read_inputs(write_all(folder, text, kinds, **options), average)


def _constants(case, kind):
    surface = realise(case)
    constants = {
        "contact_modulus": case.material.contact_modulus,
        "work_of_adhesion": case.work_of_adhesion,
        "equilibrium_distance": case.law.equilibrium_distance,
        "peak_tensile_stress": getattr(case.law, "peak_tensile_stress", 0.0),
        "contact_distance": case.contact_distance,
        **dict(zip(("surface_size_y", "surface_size_x"), surface.size, strict=True)),
        **{name: getattr(surface, name) for name in ("rms_height", "rms_slope")},
    }
    if kind != "theory":
        y, x = surface.grid.coordinates
        constants |= {"y": y, "x": x, "height": surface.heights(surface.shape), "pixel": max(surface.grid.spacing)}
    return constants


def _values(case, bins, kind, prescribed):
    control = case.loading.control
    pressure = prescribed if control == "pressure" else pressure_at(prescribed)
    ratio, seed = case.interaction.well_depth_ratio, case.surface.realisation or 1
    values = {f"applied_{control}": prescribed, "residual": 1e-9, "iterations": 7, "wall_time": 0.5, "message": ""}
    for model in ("persson", "gap_flow") if kind == "theory" else (kind,):
        prefix = f"{model}/" if kind == "theory" else ""
        contact, shifted = min(1.0, area(ratio, pressure, seed, model)), gap(ratio, pressure, seed, model)
        values |= {
            f"{prefix}mean_pressure": pressure,
            f"{prefix}relative_contact_area": contact,
            f"{prefix}mean_gap": np.nan if model == "persson" and pressure < 0 else shifted,
            f"{prefix}elastic_energy": 0.1 * contact,
            f"{prefix}pressure_pdf": contact * _bell(bins.pressure_edges, pressure, 6e9 * ratio**0.3),
        }
        if model != "persson":
            values[f"{prefix}gap_pdf"] = _bell(bins.gap_edges, shifted + 3.28e-10, 4e-10)
    if kind == "theory":
        for side, factor in BRANCH_FACTOR.items():
            # Under a prescribed gap it is the pressure that differs.
            values[f"gap_flow/{side}/mean_pressure"] = pressure * (1 if control == "pressure" else factor)
            values[f"gap_flow/{side}/relative_contact_area"] = factor * values["gap_flow/relative_contact_area"]
            values[f"gap_flow/{side}/mean_gap"] = values["gap_flow/mean_gap"] / factor
    else:
        field = realise(case).heights(case.surface.shape)
        values["gap"] = field - field.min() + (0 if case.interaction.law == "hard_wall" else 3e-10)
        pressed = values["gap"] < np.quantile(values["gap"], 0.1)
        values["pressure"] = np.where(pressed, 10 * abs(pressure), 0.0)
        if case.interaction.law == "hard_wall":
            values["gap"][pressed] = 0.0
    return values


def _bell(edges, centre, width):
    """A density on bins whose integral is one."""
    middle = 0.5 * (edges[1:] + edges[:-1])
    shape = np.exp(-0.5 * ((middle - centre) / max(width, edges[1] - edges[0])) ** 2)
    return shape / np.sum(shape * np.diff(edges))
