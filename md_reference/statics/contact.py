"""Atoms under load, by the same face as the continuum: a state and a target in, a solution out."""

from collections.abc import Sequence
from threading import RLock

import numpy as np
from scipy import optimize

from contact_study.errors import InputError
from contact_study.numerics import fourier
from contact_study.numerics.arguments import check_control, field, finite, grid_of, positive, step_arguments
from contact_study.numerics.exclusive import in_turn
from contact_study.physics.lattice import lattice_of
from md_reference.block.condensed import SurfaceStiffness, element_matrix, surface_stiffness
from md_reference.interface.pairs import LennardJonesInterface, interface_of
from md_reference.solution import Equilibrium, Outcome, Solution
from md_reference.statics.energy import Landscape
from md_reference.statics.newton import EquilibriumSolver

# In units of r0: as atomistic.cutoff of a study.
_SHORTEST_CUTOFF = 2.0


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
        What a step prescribes.
    tolerance, max_iterations, threads : optional
        As :class:`EquilibriumSolver`; the threads share the rows of atoms, too.

    Raises
    ------
    ValueError
        If ``control`` is unknown or a limit is not positive.
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
        self._solver = EquilibriumSolver(
            stiffness, interface, contact_modulus, control, tolerance, max_iterations, threads
        )
        self._heights = interface.rest_heights()
        self._mean_height = float(np.mean(self._heights))
        self._apart = separated(interface)

    def separated(self) -> np.ndarray:
        """Displacement of the flat block just beyond the cutoff, shape (3, ny, nx) (m)."""
        return self._apart.copy()

    @property
    def landscape(self) -> Landscape:
        """Energy and forces of block and interface."""
        return self._solver.landscape

    def is_separated(self, state: np.ndarray) -> bool:
        """Whether a state is :meth:`separated`."""
        return bool(np.array_equal(state, self._apart))

    def predicted(self, gap: np.ndarray) -> np.ndarray:
        """A state to start from that has nearly this gap field, of any grid over the same rectangle (m)."""
        start = predicted(self._heights, gap, self.interface.length)
        start[2] = np.maximum(start[2], self.interface.floor(start) + 0.5 * self.interface.length)
        return start

    @in_turn
    def step(self, state: np.ndarray | Solution, target: float) -> Solution:
        """The equilibrium that a state falls into under a new load.

        Parameters
        ----------
        state : numpy.ndarray, shape (3, ny, nx), or Solution
            The solution of an earlier step, its ``state``, :meth:`separated` or :meth:`predicted` (m).
        target : float
            Mean pressure (Pa) or mean separation above r0 (m), as ``control`` says. From separation only a positive
            pressure, or a gap, leads to contact.

        Raises
        ------
        ValueError
            If the target is not finite, or the state has another shape or atoms inside the substrate.
        InputError
            If a mean separation is so small that all atoms would be inside the substrate.
        """
        state, target = step_arguments(self.control, target, state, self._apart.shape)
        if self.control == "gap":
            found = self._solver.solve(at_mean_gap(self.interface, state, target + self._mean_height))
        else:
            found = self._solver.solve(state, target)
        return self.solution(found)

    def solution(self, found: Equilibrium) -> Solution:
        """What a state of the atoms is as one of the contact."""
        nominal_area = self.block.area_per_atom * self._heights.size
        detached = found.outcome is Outcome.DETACHED
        # Atoms that slide to other heights change their mean gap, not the distance that the load works on.
        separation = float(np.mean(found.displacement[2])) - self._mean_height - self.interface.length
        gap = np.full(self.interface.shape, np.inf) if detached else self.interface.gap(found.displacement)
        return Solution(
            # Once torn off the block is nowhere in particular: the next step starts from separation again.
            state=self.separated() if detached else found.displacement,
            displacement=found.displacement,
            gap=gap,
            pressure=found.force[2] / self.block.area_per_atom,
            shear_stress=found.force[:2] / self.block.area_per_atom,
            mean_separation=np.inf if detached else separation,
            elastic_energy=0.0 if detached else found.elastic_energy / nominal_area,
            interaction_energy=found.interaction_energy / nominal_area,
            residual=0.0 if detached else found.residual,
            iterations=found.iterations,
            force_evaluations=found.evaluations,
            fft_pairs=found.fft_pairs,
            outcome=found.outcome,
            length=self.interface.length,
        )


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
    """A block of atoms over a rough substrate of Lennard-Jones sites.

    The block's atoms stand a lattice constant apart, the substrate's sites closer by the golden mean, so that the two
    lattices nowhere match; their pairs interact by V(r) = 4ε[(r0/r)¹² − (r0/r)⁶].

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
        What a step prescribes: mean pressure (Pa), or mean separation above r0 (m).
    cutoff : float, optional
        Of the pairs, in units of r0.
    layers : int, optional
        Thickness of the block in layers of atoms; as thick as wide by default.
    tolerance, max_iterations, threads : optional
        As :class:`EquilibriumSolver`.

    Raises
    ------
    ValueError
        If an argument is not what it should be; the message names it.

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
    element = element_matrix("isotropic", lattice_constant, youngs_modulus, poissons_ratio)
    stiffness = surface_stiffness(element, lattice.atoms, lattice_constant, layers or max(lattice.atoms))
    interface = interface_of(
        lambda shape: fourier.interpolate(heights, shape), lattice, well_depth, length, cutoff, threads
    )
    contact_modulus = youngs_modulus / (1 - poissons_ratio**2)
    return AtomisticContact(stiffness, interface, contact_modulus, control, tolerance, max_iterations, threads)


def separated(interface: LennardJonesInterface) -> np.ndarray:
    """A flat layer of atoms just beyond the cutoff from the highest site of the substrate, shape (3, ny, nx) (m)."""
    displacement = np.zeros((3, *interface.shape))
    displacement[2] = np.max(interface.substrate.heights) + (1 + 1e-6) * interface.cutoff * interface.length
    return displacement


def predicted(heights: np.ndarray, gap: np.ndarray, length: float) -> np.ndarray:
    """Atoms at their lateral rest positions on a gap field of any grid, shape (3, ny, nx) (m).

    Parameters
    ----------
    heights : numpy.ndarray, shape (ny, nx)
        Surface under the rest positions (m).
    gap : numpy.ndarray
        Gap of a continuum solution over the same rectangle (m); interpolated trigonometrically.
    length : float
        r0; interpolation is kept from undershooting half of it (m).
    """
    displacement = np.zeros((3, *heights.shape))
    displacement[2] = heights + np.maximum(fourier.interpolate(gap, heights.shape), 0.5 * length)
    return displacement


def at_mean_gap(interface: LennardJonesInterface, displacement: np.ndarray, mean_gap: float) -> np.ndarray:
    """A state moved to a mean height of ``mean_gap`` + r0, with no atom below the surface (m).

    Atoms that a rigid approach would push closer to the surface, or to the height of the site next to them, than
    0.85 r0 stay at that distance: on steep flanks that site stands above the surface below the atom.

    Raises
    ------
    InputError
        If the mean gap is so small that all atoms would be closer.
    """
    length = interface.length
    floor = interface.floor(displacement) + 0.85 * length
    target = mean_gap + length
    if np.mean(floor) >= target:
        raise InputError(f"loading.path: a mean gap of {mean_gap:g} m needs atoms closer than 0.85 r0 everywhere")

    def excess(shift: float) -> float:
        return float(np.mean(np.maximum(displacement[2] + shift, floor))) - target

    rigid = target - float(np.mean(displacement[2]))
    lowest = float(np.min(floor - displacement[2]))  # so far down that all atoms stand on the floor
    shift = optimize.brentq(excess, lowest, rigid, xtol=1e-15 * length) if excess(rigid) > 0 else rigid
    moved = displacement.copy()
    moved[2] = np.maximum(displacement[2] + shift, floor)
    return moved
