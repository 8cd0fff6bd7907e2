"""Rough surfaces for the tests of the continuum solvers, SI units."""

import numpy as np

from bem_adhesion.hard_wall.contact import HardWallContact
from contact_study.numerics.grid import Grid
from contact_study.study.case import realise
from contact_study.study.study import make_study
from tests.bem_adhesion.paper_system import SIZE, study_table

CONTACT_MODULUS = 93.7348e9


def self_affine(points, cutoff_mode=12, seed=1):
    """The paper's surface, realised with h_rms = 10 Å, and its grid."""
    surface = realise(make_study(study_table(points, seed, SIZE, surface={"cutoff_mode": cutoff_mode})).cases[0])
    return surface.heights((points, points)), Grid((points, points), (SIZE, SIZE))


def random_heights(shape, exponent, seed):
    """Gaussian heights of unit variance with amplitudes |q|^−exponent up to the grid's shortest wave, and the grid."""
    grid = Grid(shape, (1.0 * shape[0] / shape[1], 1.0))
    coefficients = np.fft.rfft2(np.random.default_rng(seed).standard_normal(shape))
    coefficients[0, 0] = 0
    coefficients *= np.where(grid.wavenumber > 0, grid.wavenumber, 1) ** -exponent
    heights = np.fft.irfft2(coefficients, shape)
    return heights / heights.std(), grid


def solve(height, grid, elasticity, mean_pressure, **options):
    """Contact with a hard wall under a mean pressure, from separation."""
    return at(HardWallContact(height, grid, elasticity, **options), mean_pressure)


def at(contact, target, state=None):
    """The contact at a load, from separation unless a state is given."""
    return contact.step(contact.separated() if state is None else state, target)


def stepped(contact, targets):
    """The solutions along a path from separation."""
    state, found = contact.separated(), []
    for target in targets:
        found.append(contact.step(state, target))
        state = found[-1].state
    return found
