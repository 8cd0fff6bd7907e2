"""What a Newton step takes from the interface while atoms snap in: curvature to model it by, and where atoms land.

An attracted atom has negative curvature, and an atom that meets the repulsive wall has one that grows a hundredfold
within a tenth of r0: a quadratic model holds for neither. So the curvature of an attracted atom out of balance is
raised by a spring that ends at its goal, and a step is taken atom by atom in the variable in which the force is nearly
linear: distance where the atom is attracted, force where it is repelled. No single atom then shortens the step of all.
"""

from numba import njit

# Largest relative change of an attracted atom's distance in one step, and of a repelled one that comes free.
_LARGEST_CHANGE = 0.4
# Force at which an atom lands that enters repulsion in one step, over that of a flat layer's prefactor: about a third
# of the largest attraction. Enough to hold it there, and its overshoot does not decide the line search.
_LANDING = 0.126

# Newton's last change of a root of force and distance, relative; its error is about six times the square.
_NEAR, _MOST_STEPS = 1e-8, 10

_OPTIONS = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "reassoc", "arcp", "nsz"}}


@njit(**_OPTIONS)
def land(gap, cosine, force, length, prefactor, trial_gap, trial_cosine, height):
    """Correct the heights that a Newton step leads to, atom by atom, see the module.

    The force on an atom at the distance d from the layer of sites below it is taken as that of smeared layers,
    ``prefactor`` (s¹¹ − s⁵) with s = r0/d, and its part normal to the mean plane as cos²θ times that over a layer
    tilted by θ. Only where a long step ends follows from it: to first order it is the step.

    Parameters
    ----------
    gap, cosine : numpy.ndarray, shape (ny, nx)
        Before the step, as in :func:`raised_curvature`.
    force : numpy.ndarray, shape (ny, nx)
        Force of the interface before the step, normal to the mean plane (N).
    length, prefactor : float
        r0 (m) and the force (N).
    trial_gap, trial_cosine : numpy.ndarray, shape (ny, nx)
        After the step; the gap is corrected in place.
    height : numpy.ndarray, shape (ny, nx)
        Height of the atoms after the step, corrected in place (m).
    """
    for j in range(gap.shape[0]):
        for i in range(gap.shape[1]):
            before = gap[j, i] * cosine[j, i]
            moved = trial_gap[j, i] * trial_cosine[j, i] - before
            f = force[j, i]
            if f > 0.0:
                f /= prefactor * cosine[j, i] ** 2
                s = repulsive_root(f, length / before)
                s6 = s**6
                f -= s6 * (11.0 * s6 - 5.0) * moved / length
                after = length / repulsive_root(f, s) if f > 0.0 else length * (1.0 + min(-f / 6.0, _LARGEST_CHANGE))
                after += before - length / s
            else:
                after = before + min(max(moved, -_LARGEST_CHANGE * before), _LARGEST_CHANGE * before)
                edge = min(before, length)
                if after < edge:
                    after = edge / repulsive_root(min(6.0 * (edge - after) / edge, _LANDING), 1.0)
            corrected = after / trial_cosine[j, i]
            height[j, i] += corrected - trial_gap[j, i]
            trial_gap[j, i] = corrected


@njit(**_OPTIONS)
def repulsive_root(force, guess):
    """s >= 1 with s¹¹ − s⁵ = force >= 0, to rounding; a guess saves time."""
    # The root is a concave function of the force, so that its tangents (at s = 1, 1.1, 1.25, 1.6 and 2.5) bound it
    # from above; Newton descends from there, or steps over the root first.
    most = min(1.0 + force / 6.0, 1.1 + (force - 1.2426067) / 21.210667)
    most = min(most, min(1.25 + (force - 8.5897744) / 90.238452, 1.6 + (force - 165.4361) / 1176.6948))
    most = min(most, 2.5 + (force - 23744.2) / 104709.0)
    s = min(most, max(guess, 1.0))
    for _ in range(_MOST_STEPS):
        s5 = s**5
        s10 = s5 * s5
        change = (s10 * s - s5 - force) / (11.0 * s10 - 5.0 * s5 / s)
        s = min(s - change, most)
        if abs(change) < _NEAR * s:
            break
    return s
