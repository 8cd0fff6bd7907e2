"""A Newton step atom by atom: the curvature of the interface, and limits while atoms jump into contact.

An attracted atom has negative curvature, and that of an atom at the repulsive wall grows a hundredfold within a tenth
of r0. Each atom's step is therefore taken in the variable in which its force is nearly linear: distance where it is
attracted, force where it is repelled. Symmetric 3×3 matrices are six numbers: xx, yy, zz, xy, xz, yz.
"""

import numpy as np

from contact_study.numerics.kernel import kernel

# Relative change at which Newton's iteration for a root ends; its error is about six times the square.
_NEAR, _MOST_STEPS = 1e-8, 10
# Distance to contact below which the spring of an attracted atom keeps its stiffness (r0), see raise_curvature.
_SMALLEST_DISTANCE = 0.03
# Largest relative change of an attracted atom's distance, and of a repelled atom's that leaves contact.
_LARGEST_CHANGE = 0.4
# Force on an atom that enters repulsion, over a flat layer's prefactor: a third of the largest attraction. Enough to
# keep it there, while its overshoot does not decide the line search.
_LANDING_FORCE = 0.126


@kernel
def deviator(xx, yy, zz, xy, xz, yz):
    """Return mean m of the diagonal, size p and entries of (A − m)/p, and its angle; p is zero for A = m.

    The eigenvalues are m + 2p cos(angle + 2πk/3), the largest for k = 0, the lowest for k = 1.
    """
    mean = (xx + yy + zz) / 3.0
    spread = (xx - mean) ** 2 + (yy - mean) ** 2 + (zz - mean) ** 2 + 2.0 * (xy * xy + xz * xz + yz * yz)
    if spread == 0.0:
        return mean, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    p = np.sqrt(spread / 6.0)
    a, b, c = (xx - mean) / p, (yy - mean) / p, (zz - mean) / p
    d, e, f = xy / p, xz / p, yz / p
    r = 0.5 * (a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e))
    return mean, p, a, b, c, d, e, f, np.arccos(min(1.0, max(-1.0, r))) / 3.0


@kernel
def stiffest(xx, yy, zz, xy, xz, yz):
    """Return the largest eigenvalue and its unit eigenvector; z where no direction is unique."""
    mean, p, a, b, c, d, e, f, angle = deviator(xx, yy, zz, xy, xz, yz)
    if not 6.0 * p * p > 1e-20 * mean * mean:
        return mean, 0.0, 0.0, 1.0
    top = 2.0 * np.cos(angle)
    # Rows of the shifted matrix are normal to the eigenvector: the largest of their products points along it.
    a, b, c = a - top, b - top, c - top
    x1, y1, z1 = d * f - e * b, e * d - a * f, a * b - d * d
    x2, y2, z2 = d * c - e * f, e * e - a * c, a * f - d * e
    x3, y3, z3 = b * c - f * f, f * e - d * c, d * f - b * e
    n1 = x1 * x1 + y1 * y1 + z1 * z1
    n2 = x2 * x2 + y2 * y2 + z2 * z2
    n3 = x3 * x3 + y3 * y3 + z3 * z3
    if n2 > n1 and n2 >= n3:
        x1, y1, z1, n1 = x2, y2, z2, n2
    elif n3 > n1:
        x1, y1, z1, n1 = x3, y3, z3, n3
    if not n1 > 1e-24:
        return mean + p * top, 0.0, 0.0, 1.0
    size = np.sqrt(n1)
    return mean + p * top, x1 / size, y1 / size, z1 / size


@kernel
def raise_curvature(hessian, gradient, gap, cosine, damping, length, diagonal):
    """Write each atom's Hessian into ``diagonal`` (N/m), raised by a multiple of 1 where the normal force softens.

    A raised atom has at least the curvature |g|/distance of a spring that ends at contact where the unbalanced force g
    pulls it toward contact, and at twice its gap where g pulls it away: it vanishes with g, for Newton's convergence.
    ``gradient`` is −g (N), ``damping`` the share of the remaining negative curvature to remove, ``length`` r0 (m).
    """
    for j in range(gap.shape[0]):
        for i in range(gap.shape[1]):
            xx, yy, zz = hessian[0, j, i], hessian[1, j, i], hessian[2, j, i]
            xy, xz, yz = hessian[3, j, i], hessian[4, j, i], hessian[5, j, i]
            lift = 0.0
            if zz < 0.0:
                g, height = gradient[2, j, i], gap[j, i]
                above = max(height - length / cosine[j, i], _SMALLEST_DISTANCE * length)
                lift = abs(g) / (above if g > 0.0 else height)
            if damping > 0.0:
                six = float(xx), float(yy), float(zz), float(xy), float(xz), float(yz)
                mean, p, _, _, _, _, _, _, angle = deviator(*six)
                lift -= damping * min(mean + 2.0 * p * np.cos(angle + 2.0 * np.pi / 3.0) + lift, 0.0)
            for n in range(3):
                diagonal[n, j, i] = hessian[n, j, i] + lift
                diagonal[3 + n, j, i] = hessian[3 + n, j, i]


@kernel
def split(diagonal, shift, half_grid, negligible, known, normal, removed, core):
    """Write n of each atom, 1 − β in ``removed`` and (1 − β²)/(k + ½ S_max) in ``core``, zero where k is negligible.

    See :mod:`md_reference.statics.linear`: D is ``diagonal``, c ``shift``, ½ S_max ``half_grid`` (N/m). Where D is the
    ``known`` one of the last call (NaN at first), results remain valid.
    """
    for j in range(removed.shape[0]):
        for i in range(removed.shape[1]):
            same = True
            for n in range(6):
                same &= diagonal[n, j, i] == known[n, j, i]
                known[n, j, i] = diagonal[n, j, i]
            if same:
                continue
            xx, yy, zz = float(diagonal[0, j, i]), float(diagonal[1, j, i]), float(diagonal[2, j, i])
            xy, xz, yz = float(diagonal[3, j, i]), float(diagonal[4, j, i]), float(diagonal[5, j, i])
            # Largest sums of rows, the eigenvalues' bound.
            bound = max(xx + abs(xy) + abs(xz), yy + abs(xy) + abs(yz), zz + abs(xz) + abs(yz))
            if bound <= negligible:
                removed[j, i] = core[j, i] = 0.0
                continue
            stiffness, x, y, z = stiffest(xx, yy, zz, xy, xz, yz)
            normal[0, j, i], normal[1, j, i], normal[2, j, i] = x, y, z
            stiffness = max(stiffness, 0.0)
            squared = shift / (stiffness + shift)
            removed[j, i] = 1.0 - np.sqrt(squared)
            core[j, i] = (1.0 - squared) / (stiffness + half_grid)


@kernel
def limit_step(gap, cosine, force, length, prefactor, trial_gap, trial_cosine, height):
    """Correct the heights at the end of a Newton step, atom by atom, see the module.

    The model force at distance d from the layer of sites is that of smeared layers, ``prefactor`` (s¹¹ − s⁵) with
    s = r0/d; over a layer tilted by θ its part normal to the mean plane is cos²θ times that. Before the step the
    interface's ``force`` acted (N); after it ``trial_gap`` and ``height`` are corrected (m), to first order by nothing.
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
                    after = edge / repulsive_root(min(6.0 * (edge - after) / edge, _LANDING_FORCE), 1.0)
            corrected = after / trial_cosine[j, i]
            height[j, i] += corrected - trial_gap[j, i]
            trial_gap[j, i] = corrected


@kernel
def repulsive_root(force, guess):
    """Return s >= 1 with s¹¹ − s⁵ = force >= 0, to rounding; a good guess saves time."""
    # The root is a concave function of the force: its tangents at s = 1, 1.1, 1.25, 1.6 and 2.5 bound it from above.
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
