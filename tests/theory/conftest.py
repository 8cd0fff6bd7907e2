"""The system of Yang et al. 2008 for the tests of the theories."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from contact_study.numerics.grid import Grid
from contact_study.physics.laws import LennardJones104
from contact_study.physics.roughness.spectrum import SelfAffineSpectrum, radial_spectrum
from theory.persson.theory import PerssonTheory


@dataclass(frozen=True)
class PaperSystem:
    rms_height: float = 1e-9
    contact_modulus: float = 77.2e9 / (1 - 0.42**2)
    contact_distance: float = 3.68e-10

    @property
    def spectrum(self):
        q = 2 * np.pi / 1040e-10
        return SelfAffineSpectrum(0.8, self.rms_height, q, 3 * q, 12 * q)

    def theory(self, work_of_adhesion, **choices):
        return PerssonTheory(self.spectrum, self.contact_modulus, work_of_adhesion, **choices)

    def law(self, well_depth_ratio, work_of_adhesion=0.6924):
        return LennardJones104(work_of_adhesion * well_depth_ratio, 3.28e-10)


@pytest.fixture(scope="session")
def paper():
    return PaperSystem()


@pytest.fixture(scope="session")
def filtered_spectrum():
    """White noise under a Gaussian filter, as measured maps are: shells down to the rounding of their sum."""
    heights = gaussian_filter(np.random.default_rng(0).standard_normal((64, 64)), 3, mode="wrap")
    return radial_spectrum(1e-9 * heights / heights.std(), Grid((64, 64), (416e-10, 416e-10)))
