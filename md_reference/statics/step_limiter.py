"""Limits of a Newton step, atom by atom, while atoms jump into contact.

An attracted atom has negative curvature, and the curvature of an atom that reaches the repulsive wall grows a
hundredfold within a tenth of r0: a quadratic model is valid for neither. Each atom's step is therefore taken in the
variable in which its force is nearly linear: distance where it is attracted, force where it is repelled. No single atom
then shortens the step of all.
"""

from typing import NamedTuple

from contact_study.numerics.kernel import kernel

# Relative change at which Newton's iteration for a root ends; its error is about six times the square.
_NEAR, _MOST_STEPS = 1e-8, 10


class StepLimiterOptions(NamedTuple):
    """Limits of one step."""

    # Distance to contact below which the spring of an attracted atom keeps its stiffness (r0), see raise_curvature.
    smallest_distance: float = 0.03
    # Largest relative change of an attracted atom's distance, and of a repelled atom's that leaves contact.
    largest_change: float = 0.4
    # Force on an atom that enters repulsion, over a flat layer's prefactor: a third of the largest attraction. Enough
    # to keep it there, while its overshoot does not decide the line search.
    landing_force: float = 0.126


DEFAULTS = StepLimiterOptions()


@kernel
def limit_step(gap, cosine, force, length, prefactor, options, trial_gap, trial_cosine, height):
    """Correct the heights at the end of a Newton step, atom by atom, see the module.

    The model force at distance d from the layer of sites is that of smeared layers, ``prefactor`` (s¹¹ − s⁵) with
    s = r0/d; over a layer tilted by θ its part normal to the mean plane is cos²θ times that. To first order the
    correction vanishes.

    Before the step ``gap`` is the height over the surface (m), ``cosine`` that of the surface's tilt, ``force`` the
    interface's normal force (N). After it, ``trial_gap`` and the atoms' ``height`` are corrected in place (m).
    """
    change = options.largest_change
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
                after = length / repulsive_root(f, s) if f > 0.0 else length * (1.0 + min(-f / 6.0, change))
                after += before - length / s
            else:
                after = before + min(max(moved, -change * before), change * before)
                edge = min(before, length)
                if after < edge:
                    after = edge / repulsive_root(min(6.0 * (edge - after) / edge, options.landing_force), 1.0)
            corrected = after / trial_cosine[j, i]
            height[j, i] += corrected - trial_gap[j, i]
            trial_gap[j, i] = corrected


@kernel
def repulsive_root(force, guess):
    """Return s >= 1 with s¹¹ − s⁵ = force >= 0, to rounding; a good guess saves time."""
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
