"""Small atomistic systems that the tests share."""

import copy

import numpy as np
import xarray as xr

from contact_study.numerics.fourier import interpolate
from contact_study.study.study import make_study
from md_reference.block.condensed import isotropic_element, lame_constants, surface_stiffness
from md_reference.interface.pairs import LennardJonesInterface
from md_reference.interface.substrate import Substrate

SPACING = 2.6e-10
R0 = 3.28e-10
WELL_DEPTH = 18.6e-3 * 1.602176634e-19
YOUNGS = 77.2e9
POISSON = 0.42
E_STAR = YOUNGS / (1 - POISSON**2)
AREA = SPACING**2
MASS = 3.27e-25
LAME = lame_constants(YOUNGS, POISSON)
ELEMENT = isotropic_element(SPACING, YOUNGS, POISSON)


def rough_heights(modes=3, rms=2e-10):
    heights = np.random.default_rng(0).standard_normal((2 * modes + 1, 2 * modes + 1))
    heights -= heights.mean()
    return heights * rms / heights.std()


def interface_of(atoms, heights=None, ratio=1.0, threads=1):
    sites = tuple(round(1.618033988749895 * n) for n in atoms)
    heights = np.zeros(sites) if heights is None else interpolate(heights, sites)
    substrate = Substrate(heights, tuple(n * SPACING / m for n, m in zip(atoms, sites, strict=True)))
    spacing = (SPACING, SPACING)
    return LennardJonesInterface(substrate, atoms, spacing, ratio * WELL_DEPTH, R0, 4.0, threads)


def touching(interface):
    displacement = np.zeros((3, *interface.shape))
    displacement[2] = interface.rest_heights().max() + 1.1 * R0
    return displacement


def stiffness_of(atoms, layers=None):
    return surface_stiffness(ELEMENT, atoms, SPACING, layers or max(atoms))


def apply(stiffness, displacement, free=False):
    u = np.fft.rfft2(displacement)
    u[2] *= 1j
    out = times_matrices(stiffness.coefficients, u)
    if free:
        out[2, 0, 0] = 0
    out[2] *= -1j
    return np.fft.irfft2(out, s=displacement.shape[1:])


def times_matrices(six, u):
    return np.einsum("yxcd,dyx->cyx", matrices_of(six), u)


def matrices_of(six):
    xx, yy, zz, xy, xz, yz = six
    return np.moveaxis(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), (0, 1), (-2, -1))


class Quartic:
    length = R0

    def __init__(self, strength=0.0):
        self.strength = strength

    def evaluate(self, displacement, force, hessian=None):
        z = displacement[2]
        force[...] = 0
        force[2] = -self.strength * z**3
        if hessian is not None:
            hessian[...] = 0
            hessian[2] = 3 * self.strength * z**2
        return 0.25 * self.strength * float(np.sum(z**4))


SAMPLED = {
    "surface": {
        "kind": "self_affine",
        "size": "62.4 angstrom",
        "shape": [24, 24],
        "rms_height": "1 angstrom",
        "cutoff_mode": 3,
    },
    "material": {"youngs_modulus": YOUNGS, "poissons_ratio": POISSON, "lattice_constant": "2.6 angstrom"},
    "interaction": {
        "law": "lennard_jones_10_4",
        "well_depth": WELL_DEPTH,
        "length": R0,
        "contact_distance": "3.68 angstrom",
    },
    "loading": {"path": ["1 GPa", "3 GPa"]},
    "atomistic": {"method": "sampling", "temperature": "300 K"},
    "sampling": {"trajectories": 60, "equilibration": 20},
    "output": {"fields": True, "pressure_range": ["-10 GPa", "30 GPa"], "gap_range": ["0 nm", "1 nm"]},
}

FLOW = {
    "surface": {"rms_height": "2 angstrom", "cutoff_mode": 4},
    "interaction": {"well_depth_ratio": 4},
    "atomistic": {"method": "overdamped", "temperature": 0},
    "loading": {"path": ["1 GPa", "-1 GPa", "-10 GPa", "-1 GPa", "0.5 GPa"]},
}

SMALL = {"size": "20.8 angstrom", "shape": [8, 8]}
MOVING = {
    "surface": {"size": "41.6 angstrom", "shape": [16, 16]},
    "material": {"atom_mass": "197 u"},
    "atomistic": {"method": "dynamics", "temperature": 0.0},
    "dynamics": {"duration": "80 ps", "damping": "0.3 ps^-1", "approach_speed": "300 m/s", "frames": 20},
    "loading": {"path": ["1 GPa"]},
}


def case_of(atoms=(48, 48), ratio=1.0, path=("0.5 GPa",), control="pressure", **sections):
    table = copy.deepcopy({name: SAMPLED[name] for name in ("surface", "material", "interaction")})
    given = {
        "surface": {
            "size": [2.6e-10 * n for n in atoms],
            "shape": list(atoms),
            "rms_height": 2.0e-10,
            "cutoff_mode": 4,
            "seed": 1,
        },
        "interaction": {"well_depth_ratio": ratio},
        "loading": {"control": control, "path": list(path)},
        "output": {"fields": True},
    }
    for section, content in (*given.items(), *sections.items()):
        table.setdefault(section, {}).update(content)
    return make_study(table).cases[0]


def changed(**sections):
    table = copy.deepcopy(SAMPLED)
    for section, keys in sections.items():
        table.setdefault(section, {}).update(keys)
    for way in {"sampling", "overdamped", "dynamics"} - {table["atomistic"]["method"]}:  # nothing would read it
        table.pop(way, None)
    return table


def moving(**sections):
    names = {**MOVING, **sections}
    return changed(**{name: {**MOVING.get(name, {}), **sections.get(name, {})} for name in names})


def groups_of(path):
    with xr.open_datatree(path) as tree:
        return {node.path: node.to_dataset(inherit=False).load() for node in tree.subtree}


def assert_equal_groups(one, other):
    assert one.keys() == other.keys()
    for name, dataset in one.items():
        again = other[name].drop_vars("wall_time", errors="ignore")
        xr.testing.assert_equal(dataset.drop_vars("wall_time", errors="ignore"), again)
