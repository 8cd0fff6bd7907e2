"""Derivatives of one number of a state along its branch, and of the load at which a branch ends.

With the adjoint state (μ, ν, η) the derivative is dJ/dθ = J_θ − μᵀR_θ − ν c_θ, and η more by heights of held points;
no derivative of the state itself is formed.
"""

import warnings
from dataclasses import dataclass, replace

import numpy as np

from bem_adhesion.contacts.rough_contact import Contact
from bem_adhesion.gradients.linearised import Adjoint, LinearisedState
from bem_adhesion.gradients.numbers import Number, number_of
from bem_adhesion.solution import Solution
from contact_study.numerics import fourier
from contact_study.numerics.kernel import inner_product
from contact_study.results.path_results import UNACCOUNTED, unaccounted

NEAR_FOLD = 0.01  # distance to a fold, over the mean of |pressure| or the law's length


@dataclass(frozen=True, eq=False)
class Gradient:
    """Derivatives of one number of a state along the branch of the state.

    Parameters
    ----------
    value : float
        The number.
    heights : numpy.ndarray, shape (y, x)
        By the height of each point (per m). The highest point also moves the origin of an approach.
    work_of_adhesion : numpy.ndarray, shape (y, x), or None
        By the local work of adhesion (per J/m²); its sum is that by a uniform one. None if the law does not attract.
    length_scale : float
        By a common factor on all lengths of the law, range and equilibrium distance, at one.
    contact_modulus : float
        By the contact modulus of the solid, all of whose stiffnesses follow (per Pa).
    stiffness : numpy.ndarray or None
        By K of each wavevector in the layout of ``rfft2`` (per Pa/m); an entry that stands for q and −q has both. The
        stiffness of the mean is not among them. None with free boundaries.
    load : float
        By the target of :meth:`~bem_adhesion.Contact.step`, the pressure (per Pa) or length (per m).
    at_fold : bool
        Whether the branch ends within a hundredth of the load, where derivatives grow without bound; never on the
        gradient of a fold itself.
    fold_distance : float
        Estimated change of the target to the end of the branch, with its sign (Pa or m); infinite where none is near.
    iterations : int
        Iterations of all linear solves, a pair of transforms each for K and the preconditioner.
    solves : int
        Linear solves.

    Examples
    --------
    >>> import numpy as np
    >>> from bem_adhesion import HardWall, gradient, rough_contact
    >>> height = 1e-9 * np.cos(np.linspace(0, 2 * np.pi, 32, endpoint=False)) * np.ones((32, 1))
    >>> contact = rough_contact(height, 1e-7, 1e11, HardWall())
    >>> by = gradient(contact, contact.step(contact.separated(), 1e9), "mean_gap")
    >>> bool(by.contact_modulus > 0), by.work_of_adhesion
    (True, None)
    """

    value: float
    heights: np.ndarray
    work_of_adhesion: np.ndarray | None
    length_scale: float
    contact_modulus: float
    stiffness: np.ndarray | None
    load: float
    at_fold: bool
    fold_distance: float
    iterations: int
    solves: int


def gradient(
    contact: Contact,
    solution: Solution,
    of: str | np.ndarray,
    width: float | None = None,
    before: Solution | None = None,
) -> Gradient:
    """Compute the derivatives of one number of a state, along the branch of the state.

    Parameters
    ----------
    contact : Contact
        What :func:`rough_contact` returned, without a hardness.
    solution : Solution
        A converged state of it in contact. Errors of derivatives are about the solution's residual over the smallest
        curvature: ask the contact for a small ``tolerance``.
    of : str or array_like, shape (y, x)
        ``"pressure"`` (mean, Pa), ``"total_force"`` (N), ``"approach"`` (of the undeformed surface, or of the machine,
        from first touch at the equilibrium distance; of a half-space without bound the negative of its mean, m),
        ``"mean_gap"`` (minus the equilibrium distance, m), ``"elastic_energy"``, ``"interaction_energy"``, ``"energy"``
        (their sum; J/m²), ``"contact_area"`` (relative, smoothed), or dJ/dgap of any number J of the gaps, whose value
        is then not known (NaN).
    width : float, optional
        Of the smoothed contact area (m): a point counts 1/(1 + exp((gap − contact distance)/width)). A twentieth of the
        law's length by default; a hard wall has no such area.
    before : Solution, optional
        The state before on the path: a jump since then is named.

    Returns
    -------
    Gradient
        The derivatives. On a path with jumps they are those of the branch that the state is on.

    Raises
    ------
    ValueError
        If the state is not converged or separated, the contact has a hardness, ``of`` is unknown or of another shape.

    Warns
    -----
    UserWarning
        If the branch ends near the load, at a fold; if energy was lost since the state ``before``.

    Examples
    --------
    >>> import numpy as np
    >>> from bem_adhesion import LennardJones104, gradient, rough_contact
    >>> height = 1e-10 * np.random.default_rng(0).standard_normal((32, 32))
    >>> contact = rough_contact(height, 10e-9, 93.7e9, LennardJones104(0.1, 3.28e-10), tolerance=1e-12)
    >>> pressed = contact.step(contact.separated(), 1e9)
    >>> by = gradient(contact, pressed, "mean_gap")
    >>> bool(by.load < 0), by.heights.shape, by.solves
    (True, (32, 32), 1)
    """
    state = LinearisedState(contact, solution)
    wanted = number_of(state, of, width)
    if before is not None and (lost := _lost(LinearisedState(contact, before), state)):
        warnings.warn(
            f"gradient: {lost:.3g} J/m² were lost since the state before, in a jump; derivatives are those of the "
            "branch after it",
            stacklevel=2,
        )
    adjoint = state.adjoint(wanted.by_displacement, wanted.by_pressure)
    found = _contracted(state, wanted, adjoint)
    limit = NEAR_FOLD * (float(np.mean(np.abs(solution.pressure))) if state.control == "pressure" else state.law.length)
    if abs(state.fold_distance(adjoint.points)) > limit:
        return found
    distance = state.fold_distance(state.mode().points)
    if abs(distance) > limit:
        return found
    unit = "Pa" if state.control == "pressure" else "m"
    warnings.warn(
        f"gradient: the branch ends about {distance:.2g} {unit} from this load, where derivatives grow without bound; "
        "fold_gradient gives those of the load at its end",
        stacklevel=2,
    )
    return replace(found, at_fold=True, fold_distance=distance)


def fold_gradient(contact: Contact, solution: Solution) -> Gradient:
    """Compute the derivatives of the load at which the branch of a state ends: pull-off or jump-in.

    Under a prescribed pressure it is the pull-off or jump-in pressure, under a gap or approach that gap or approach.

    Parameters
    ----------
    contact : Contact
        What :func:`rough_contact` returned, without a hardness.
    solution : Solution
        A converged state close to the end, such as the last before a jump. Errors grow as the square root of the
        distance of its load from the end, which ``fold_distance`` estimates.

    Returns
    -------
    Gradient
        The derivatives; ``value`` is the estimated load at the end, ``load`` is zero.

    Raises
    ------
    ValueError
        If the state is not converged, separated or far from a fold, or the contact has a hardness.

    Examples
    --------
    >>> import numpy as np
    >>> from bem_adhesion import LennardJones104, fold_gradient, rough_contact
    >>> flat = np.zeros((8, 8))
    >>> contact = rough_contact(flat, 0.4e-9, 1e9, LennardJones104(0.1, 3e-10), tolerance=1e-12)
    >>> pulled = contact.step(contact.step(contact.separated(), 1e7), -0.9999 * 1.8850 * 0.1 / 3e-10)
    >>> by = fold_gradient(contact, pulled)
    >>> round(float(-by.work_of_adhesion.sum()) * 3e-10, 2)  # the largest tension over Δγ/r0
    1.88
    """
    state = LinearisedState(contact, solution)
    mode = state.mode()
    distance = state.fold_distance(mode.points)
    if not np.isfinite(distance):
        raise ValueError("solution: its branch has no end; take the last state before a jump")
    along = _contracted(state, Number(0.0), mode)
    per = -1 / along.load
    return replace(
        along,
        value=number_of(state, "target").value + distance,
        heights=along.heights * per,
        work_of_adhesion=None if along.work_of_adhesion is None else along.work_of_adhesion * per,
        length_scale=along.length_scale * per,
        contact_modulus=along.contact_modulus * per,
        stiffness=None if along.stiffness is None else along.stiffness * per,
        load=0.0,
        fold_distance=distance,
    )


def _lost(before: LinearisedState, after: LinearisedState) -> float:
    """Return the energy lost between two states of a path (J/m²), zero where the trapezoidal rule accounts for it."""
    ledgers = []
    for state in (before, after):
        machine = state.compliance - state.solid_compliance
        energy = number_of(state, "energy").value + 0.5 * machine * state.pressure**2 / state.share
        ledgers.append(np.array([state.pressure / state.share, -number_of(state, "approach").value, energy]))
    lost, exchanged = unaccounted(*ledgers)
    return float(lost) if lost > UNACCOUNTED * exchanged else 0.0


def _contracted(state: LinearisedState, wanted: Number, adjoint: Adjoint) -> Gradient:
    """Return the derivatives that an adjoint state gives."""
    own, law, points = adjoint.points[state.inside], state.law, state.height.size
    held = np.broadcast_to(adjoint.held, state.grid.shape)[state.inside]
    heights = wanted.heights + own * state.curvature[state.inside] + held
    work = None
    scale = wanted.scale
    if not law.bare_wall:
        scale += float(np.sum(own * (state.traction + state.gap * state.curvature[state.inside])))
    if law.attracts:
        work = wanted.work - own * law.traction(state.gap) / law.work_of_adhesion
    modulus = wanted.modulus - inner_product(adjoint.points, state.flexure)
    modulus += wanted.bending * state.bending_energy
    if state.control == "pressure":
        load = adjoint.control * state.share
    elif state.control == "gap":
        heights, load = heights + adjoint.control / points, adjoint.control
        scale += adjoint.control * law.equilibrium_distance
    else:
        heights = heights.copy()
        heights.reshape(-1)[int(np.argmax(state.height))] += adjoint.control
        scale += adjoint.control * law.equilibrium_distance
        modulus -= adjoint.control * state.pressure * state.solid_compliance
        load = -adjoint.control
    return Gradient(
        wanted.value,
        heights,
        work,
        scale,
        modulus / state.solid.contact_modulus,
        _by_stiffness(state, adjoint.points, wanted.bending),
        load,
        False,
        np.inf,
        state.iterations,
        state.solves,
    )


def _by_stiffness(state: LinearisedState, points: np.ndarray, bending: float) -> np.ndarray | None:
    if state.free_boundary:
        return None
    displacement = fourier.transform(state.solution.displacement)
    by = -state.grid.points * (np.conj(fourier.transform(points)) * displacement).real
    by += 0.5 * bending * np.abs(displacement) ** 2
    by *= state.grid.multiplicity
    by[0, 0] = 0.0
    return by
