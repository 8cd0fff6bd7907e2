"""The contact of a block of atoms under load: a state and a target in, a solution out."""

from collections.abc import Sequence
from threading import RLock

import numpy as np
from scipy import optimize

from contact_study.inputs.errors import InputError
from contact_study.numerics import fourier
from contact_study.numerics.arguments import check_control, field, finite, grid_of, positive, step_arguments
from contact_study.numerics.memory import in_turn
from contact_study.physics.lattice import lattice_of
from md_reference.block.condensed import SurfaceStiffness, isotropic_element, surface_stiffness
from md_reference.interface.pairs import LennardJonesInterface, interface_of
from md_reference.solution import Solution
from md_reference.statics.energy import BlockEnergy, separated
from md_reference.statics.newton import solve

_SHORTEST_CUTOFF = 2.0  # in units of r0, as atomistic.cutoff of a study
_CLOSEST = 0.85  # distance to surface and nearest site that a start keeps, in units of r0


class AtomisticContact:
    """A block of atoms over a rigid rough substrate, to be solved at any number of loads.

    Parameters
    ----------
    stiffness : SurfaceStiffness
        The condensed block.
    interface : LennardJonesInterface
        Its bottom layer's atoms over the substrate's sites.
    contact_modulus : float
        E*, the scale of the residual (Pa).
    control : {"pressure", "gap"}
        Quantity that a step prescribes.
    tolerance : float, optional
        Largest unbalanced force component on an atom, over a² E*.
    max_iterations : int, optional
        Newton steps of a load step, at most.
    threads : int, optional
        Threads of the Fourier transforms.

    Raises
    ------
    ValueError
        If ``control`` is unknown or a limit is not positive.

    Examples
    --------
    :func:`rough_contact` builds one from a height array.

    >>> import numpy as np
    >>> from md_reference import rough_contact
    >>> contact = rough_contact(np.zeros((8, 8)), 12 * 2.6e-10, 2.6e-10, 77.2e9, 0.42, 2.98e-21, 3.28e-10, "gap")
    >>> contact.step(contact.separated(), 1e-10).converged
    True
    """

    def __init__(
        self,
        stiffness: SurfaceStiffness,
        interface: LennardJonesInterface,
        contact_modulus: float,
        control: str = "pressure",
        tolerance: float = 1e-8,
        max_iterations: int = 2000,
        threads: int = 1,
    ):
        self.turn = RLock()
        check_control(control, tolerance, max_iterations)
        positive("contact_modulus", contact_modulus, "Pa")
        self.block = stiffness
        self.interface = interface
        self.control = control
        self.energy = BlockEnergy(stiffness, interface, contact_modulus, control == "gap", threads)
        self._limits = tolerance, max_iterations
        self._apart = separated(interface)

    def separated(self) -> np.ndarray:
        """Return the displacement of the flat block just beyond the cutoff, shape (3, ny, nx) (m)."""
        return self._apart.copy()

    def is_separated(self, state: np.ndarray) -> bool:
        """Return whether a state is :meth:`separated`."""
        return bool(np.array_equal(state, self._apart))

    def predicted(self, gap: np.ndarray) -> np.ndarray:
        """Return a start at rest laterally, with nearly this gap field, of any grid over the same rectangle (m)."""
        start, lowest = np.zeros((3, *self.interface.shape)), 0.5 * self.interface.length
        start[2] = self.interface.rest_heights() + np.maximum(fourier.interpolate(gap, self.interface.shape), lowest)
        start[2] = np.maximum(start[2], self.interface.floor(start) + lowest)
        return start

    @in_turn
    def step(self, state: np.ndarray | Solution, target: float) -> Solution:
        """Find the equilibrium that a state reaches under a new load.

        Parameters
        ----------
        state : numpy.ndarray, shape (3, ny, nx), or Solution
            The solution of an earlier step, its ``state``, :meth:`separated` or :meth:`predicted` (m).
        target : float
            Mean pressure (Pa) or mean separation above r0 (m), according to ``control``. From separation only a
            positive pressure, or a gap, leads to contact.

        Returns
        -------
        Solution
            The state at this load.

        Raises
        ------
        ValueError
            If the target is not finite, or the state has another shape or atoms inside the substrate.
        InputError
            If a mean separation is so small that all atoms would be inside the substrate.
        """
        state, target = step_arguments(self.control, target, state, self._apart.shape)
        if self.control == "gap":
            state = at_mean_gap(self.interface, state, target + self.energy.mean_height)
        return solve(self.energy, state, target, *self._limits)


def rough_contact(
    height: np.ndarray,
    size: float | Sequence[float],
    lattice_constant: float,
    youngs_modulus: float,
    poissons_ratio: float,
    well_depth: float,
    length: float,
    control: str = "pressure",
    *,
    cutoff: float = 4.0,
    layers: int | None = None,
    tolerance: float = 1e-8,
    max_iterations: int = 2000,
    threads: int = 1,
) -> AtomisticContact:
    """Build a block of atoms over a rough substrate of Lennard-Jones sites.

    The spacing of the substrate's sites is the lattice constant over the golden mean, so that the two lattices nowhere
    match; pairs interact by V(r) = 4ε[(r0/r)¹² − (r0/r)⁶].

    Parameters
    ----------
    height : array_like, shape (y, x)
        Heights of the rigid surface on any grid, toward the block (m), continued periodically; interpolated
        trigonometrically to the sites.
    size : float or pair of float
        Periods along y and x, whole numbers of lattice constants; one number is both (m).
    lattice_constant : float
        a of the block (m).
    youngs_modulus, poissons_ratio : float
        E (Pa) and ν of the block.
    well_depth, length : float
        ε (J) and r0 (m).
    control : {"pressure", "gap"}
        Quantity that a step prescribes: mean pressure (Pa), or mean separation above r0 (m).
    cutoff : float, optional
        Of the pairs, in units of r0.
    layers : int, optional
        Thickness of the block in layers of atoms; equal to its width by default.
    tolerance, max_iterations : optional
        As :class:`AtomisticContact`.
    threads : int, optional
        Threads of the Fourier transforms and of the interface.

    Returns
    -------
    AtomisticContact
        The contact, to be loaded.

    Raises
    ------
    ValueError
        If an argument is invalid; the message names it.

    Examples
    --------
    >>> import numpy as np
    >>> from md_reference import rough_contact
    >>> height = 2e-10 * np.sin(2 * np.pi * np.arange(32) / 32)[:, None] * np.ones(32)
    >>> block = rough_contact(height, 32 * 2.6e-10, 2.6e-10, 77.2e9, 0.42, 2.98e-21, 3.28e-10)
    >>> pressed = block.step(block.separated(), 1e9)
    >>> bool(pressed.converged and 0 < np.mean(pressed.gap < 3.68e-10) < 1)
    True
    """
    for name, value, unit in (
        ("lattice_constant", lattice_constant, "m"),
        ("youngs_modulus", youngs_modulus, "Pa"),
        ("well_depth", well_depth, "J"),
        ("length", length, "m"),
        ("cutoff", cutoff, "units of length"),
    ):
        positive(name, value, unit)
    if cutoff < _SHORTEST_CUTOFF:
        raise ValueError(
            f"cutoff = {cutoff:g}: must be at least {_SHORTEST_CUTOFF:g} lengths; attraction is largest at 1.14, "
            "and the switch to zero must lie well beyond"
        )
    if not -1 < finite("poissons_ratio", poissons_ratio, "1") < 0.5:
        raise ValueError(f"poissons_ratio = {poissons_ratio!r}: must be above -1 and below 0.5, which springs are not")
    heights = field("height", height)
    lattice = lattice_of(grid_of(heights, size).size, lattice_constant)
    element = isotropic_element(lattice_constant, youngs_modulus, poissons_ratio)
    stiffness = surface_stiffness(element, lattice.atoms, lattice_constant, layers or max(lattice.atoms))
    interface = interface_of(
        lambda shape: fourier.interpolate(heights, shape), lattice, well_depth, length, cutoff, threads
    )
    contact_modulus = youngs_modulus / (1 - poissons_ratio**2)
    return AtomisticContact(stiffness, interface, contact_modulus, control, tolerance, max_iterations, threads)


def at_mean_gap(interface: LennardJonesInterface, displacement: np.ndarray, mean_gap: float) -> np.ndarray:
    """Move a state to a mean height of ``mean_gap`` + r0, with no atom closer than 0.85 r0 to surface and site (m)."""
    length, target = interface.length, mean_gap + interface.length
    floor = interface.floor(displacement) + _CLOSEST * length
    if np.mean(floor) >= target:
        raise InputError(f"loading.path: a mean gap of {mean_gap:g} m needs atoms closer than 0.85 r0 everywhere")

    def excess(shift: float) -> float:
        return float(np.mean(np.maximum(displacement[2] + shift, floor))) - target

    rigid = target - float(np.mean(displacement[2]))
    lowest = float(np.min(floor - displacement[2]))  # moves all atoms to the floor
    shift = optimize.brentq(excess, lowest, rigid, xtol=1e-15 * length) if excess(rigid) > 0 else rigid
    moved = displacement.copy()
    moved[2] = np.maximum(displacement[2] + shift, floor)
    return moved
