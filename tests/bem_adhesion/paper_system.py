"""The paper's system in small: material, law and surfaces for the tests of this package, SI units."""

import numpy as np

from contact_study.numerics.grid import Grid
from contact_study.physics.laws import HardWall, LennardJones104
from contact_study.physics.surfaces.surface import Surface
from contact_study.study.case import realise
from contact_study.study.study import make_study

E_STAR = 77.2e9 / (1 - 0.42**2)
R0 = 3.28e-10
SIZE = 1040e-10
CONTACT_DISTANCE = 3.68e-10


def law(ratio: float = 1.0) -> LennardJones104:
    """The 10-4 law of the paper's work of adhesion, times ``ratio``."""
    return LennardJones104(0.69 * ratio, R0)


def study_table(points: int, seed: int = 1, size: float = SIZE, **sections: dict) -> dict:
    """A study of the paper's surface on ``points``² points; ``sections`` adds keys, or drops them if None."""
    rough = {"kind": "self_affine", "size": size, "shape": [points, points], "rms_height": 10e-10, "seed": seed}
    waves = {"hurst_exponent": 0.8, "low_mode": 1, "roll_off_mode": 3, "cutoff_mode": 12, "normalisation": "realised"}
    interaction = {"work_of_adhesion": 0.69, "length": R0, "contact_distance": CONTACT_DISTANCE}
    table: dict = {
        "surface": {**rough, **waves},
        "material": {"youngs_modulus": 77.2e9, "poissons_ratio": 0.42},
        "interaction": {"law": "lennard_jones_10_4", **interaction},
        "loading": {"path": [1e9]},
    }
    for name, keys in sections.items():
        merged = {**table.get(name, {}), **keys}
        table[name] = {key: value for key, value in merged.items() if value is not None}
    return table


def surface(points: int, seed: int = 1, size: float = SIZE, cutoff_mode: int = 12) -> Surface:
    """The paper's rough surface, root-mean-square height 10 Å."""
    return realise(make_study(study_table(points, seed, size, surface={"cutoff_mode": cutoff_mode})).cases[0])


def self_affine(points, cutoff_mode=12, seed=1):
    """Heights of the paper's surface, and their grid."""
    rough = surface(points, seed, cutoff_mode=cutoff_mode)
    return rough.heights((points, points)), rough.grid


def random_heights(shape, exponent, seed):
    """Gaussian heights of unit variance with amplitudes |q|^−exponent up to the grid's shortest wave, and the grid."""
    grid = Grid(shape, (1.0 * shape[0] / shape[1], 1.0))
    coefficients = np.fft.rfft2(np.random.default_rng(seed).standard_normal(shape))
    coefficients[0, 0] = 0
    coefficients *= np.where(grid.wavenumber > 0, grid.wavenumber, 1) ** -exponent
    heights = np.fft.irfft2(coefficients, shape)
    return heights / heights.std(), grid


def stepped(contact, targets):
    """The solutions along a path from separation."""
    state, found = contact.separated(), []
    for target in targets:
        found.append(contact.step(state, target))
        state = found[-1].state
    return found


def approach_of(found, height, solid, the_law=HardWall()):  # noqa: B008
    """Of the undeformed surface beyond first touch of a surface that had not yielded."""
    plane = found.plane
    if plane is None:
        plane = float(np.mean(found.displacement)) - solid.mean_compliance * float(found.pressure.mean())
    return height.max() + the_law.equilibrium_distance - plane


def relative_contact_area(gap: np.ndarray) -> float:
    """Fraction of points closer than the contact distance."""
    return float(np.mean(gap < CONTACT_DISTANCE))
