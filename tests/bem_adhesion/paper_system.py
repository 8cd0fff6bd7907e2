"""The paper's system in small: material, law and surfaces for the tests of this package."""

import numpy as np

from bem_adhesion.adhesive.contact import AdhesiveContact
from contact_study.physics.laws.lennard_jones import LennardJones104
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
    table: dict = {
        "surface": {
            "kind": "self_affine",
            "size": size,
            "shape": [points, points],
            "hurst_exponent": 0.8,
            "rms_height": 10e-10,
            "low_mode": 1,
            "roll_off_mode": 3,
            "cutoff_mode": 12,
            "seed": seed,
            "normalisation": "realised",
        },
        "material": {"youngs_modulus": 77.2e9, "poissons_ratio": 0.42},
        "interaction": {
            "law": "lennard_jones_10_4",
            "work_of_adhesion": 0.69,
            "length": R0,
            "contact_distance": CONTACT_DISTANCE,
        },
        "loading": {"path": [1e9]},
    }
    for name, keys in sections.items():
        merged = {**table.get(name, {}), **keys}
        table[name] = {key: value for key, value in merged.items() if value is not None}
    return table


def surface(points: int, seed: int = 1, size: float = SIZE) -> Surface:
    """The paper's rough surface, root-mean-square height 10 Å."""
    return realise(make_study(study_table(points, seed, size)).cases[0])


def touching(contact: AdhesiveContact) -> np.ndarray:
    """Displacement of the flat block whose lowest gap is the law's equilibrium distance: a start within its reach."""
    return np.full(contact.height.shape, contact.height.max() + contact.law.equilibrium_distance)


def relative_contact_area(gap: np.ndarray) -> float:
    """Fraction of points closer than the contact distance."""
    return float(np.mean(gap < CONTACT_DISTANCE))
