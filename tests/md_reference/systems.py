"""Small atomistic systems that the tests share."""

import numpy as np

from contact_study.numerics.fourier import synthesise
from contact_study.study.study import make_study
from md_reference.block.condensed import isotropic_element, surface_stiffness
from md_reference.interface.pairs import LennardJonesInterface
from md_reference.interface.substrate import Substrate

LATTICE_CONSTANT = 2.6e-10
LENGTH = 3.28e-10
WELL_DEPTH = 18.6e-3 * 1.602176634e-19
YOUNGS_MODULUS = 77.2e9
POISSONS_RATIO = 0.42
CONTACT_MODULUS = YOUNGS_MODULUS / (1 - POISSONS_RATIO**2)
ELEMENT = isotropic_element(LATTICE_CONSTANT, YOUNGS_MODULUS, POISSONS_RATIO)


def rough_coefficients(modes=3, rms=2e-10, seed=0):
    """Coefficients h_q, on 2·modes + 1 points a side, of a smooth random surface."""
    side = 2 * modes + 1
    heights = np.random.default_rng(seed).standard_normal((side, side))
    heights -= heights.mean()
    return np.fft.rfft2(heights * rms / heights.std()) / side**2


def sample(coefficients, shape):
    """Heights of that surface on a larger grid."""
    side = coefficients.shape[0]
    modes = side // 2
    out = np.zeros((shape[0], shape[1] // 2 + 1), complex)
    out[: modes + 1, : modes + 1] = coefficients[: modes + 1]
    out[-modes:, : modes + 1] = coefficients[-modes:]
    return synthesise(out, shape)


def substrate_of(atoms, coefficients=None):
    """Substrate under ``atoms`` (y, x), rough or flat."""
    sites = tuple(round(1.618033988749895 * n) for n in atoms)
    spacing = tuple(n * LATTICE_CONSTANT / m for n, m in zip(atoms, sites, strict=True))
    heights = np.zeros(sites) if coefficients is None else sample(coefficients, sites)
    return Substrate(heights, spacing)


def interface_of(atoms, coefficients=None, well_depth=WELL_DEPTH, cutoff=4.0):
    """Lennard-Jones interface of a small system."""
    spacing = (LATTICE_CONSTANT, LATTICE_CONSTANT)
    return LennardJonesInterface(substrate_of(atoms, coefficients), atoms, spacing, well_depth, LENGTH, cutoff)


def touching(interface):
    """A flat layer of atoms just above the highest point of the surface, within reach of its attraction."""
    displacement = np.zeros((3, *interface.shape))
    displacement[2] = interface.rest_heights().max() + 1.1 * LENGTH
    return displacement


def stiffness_of(atoms, layers=None):
    """Block of a small system."""
    return surface_stiffness(ELEMENT, atoms, LATTICE_CONSTANT, layers or max(atoms))


def case_of(atoms=(48, 48), ratio=1.0, path=("0.5 GPa",), control="pressure", scale=1.0, energy_scale=1.0, **sections):
    """A study of one case; ``scale`` and ``energy_scale`` multiply every length and energy."""
    angstrom = 1e-10 * scale
    table = {
        "surface": {
            "kind": "self_affine",
            "size": [2.6 * angstrom * n for n in atoms],
            "shape": list(atoms),
            "rms_height": 2.0 * angstrom,
            "cutoff_mode": 4,
            "seed": 1,
        },
        "material": {
            "youngs_modulus": YOUNGS_MODULUS * energy_scale / scale**3,
            "poissons_ratio": POISSONS_RATIO,
            "lattice_constant": 2.6 * angstrom,
        },
        "interaction": {
            "law": "lennard_jones_10_4",
            "well_depth": WELL_DEPTH * energy_scale,
            "well_depth_ratio": ratio,
            "length": 3.28 * angstrom,
            "contact_distance": 3.68 * angstrom,
        },
        "loading": {"control": control, "path": list(path)},
        "output": {"fields": True},
    }
    for section, content in sections.items():
        table.setdefault(section, {}).update(content)
    return make_study(table).cases[0]
