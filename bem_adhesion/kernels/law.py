"""Kernels of laws for a Newton solver: energy and derivatives, gradient, and where a step ends.

A wall's gap >= 0 is kept by projection: a point that is pressed against the wall is held, it leaves the linear solve;
all others move, and stop at the wall (D. P. Bertsekas, SIAM J. Control Optim. 20, 221 (1982)).
"""

from collections.abc import Callable, Iterator
from functools import cache

import numpy as np

from contact_study.numerics.kernel import kernel
from contact_study.physics.laws import Dugdale, Exponential, LennardJones, TractionLaw

# Pressure, over the law's peak, at which a point ends that enters repulsion in one step (research/notes).
LANDING = 0.35
# An attracted point out of balance by a stress g gains the curvature CAUTION |g| / distance, so that it steps about to
# equilibrium and not beyond. The term vanishes with g: Newton's quadratic convergence stays.
CAUTION = 1.0
BLOCK = 32768  # points at a time: arrays between two loops over so many stay in the cache
# Stiffness of a held point over the largest of the solid: infinite to the accuracy of a linear solve in a descent, and
# far from the rounding of single precision; and, larger, where a contact stiffness is computed.
HELD, PINNED = 1e3, 1e6
LEAST_EXPONENT = -700.0  # smaller ones are raised to it: an exponential that rounds to zero takes 14 times as long
SMALL = 1e-8  # its square is negligible beside one in double precision
# s^(m+6) at which tangents bound the root of s^(m+6) − s^m = y from above.
_TANGENTS = (1.0, 1.1**11, 1.25**11, 1.6**11)


def blocks(field: np.ndarray) -> Iterator[slice]:
    """Yield slices of rows with about :data:`BLOCK` points each."""
    rows = max(1, BLOCK // field[0].size)
    return (slice(first, first + rows) for first in range(0, len(field), rows))


@kernel
def law_gradient(pressing, gap, traction, pressure, right_side, curvature, equilibrium, peak):
    """Write −(pressing + φ' + pressure); raise the curvature of points beyond the peak that are out of balance."""
    energy = largest = square = total = 0.0
    for i in range(gap.shape[0]):
        for j in range(gap.shape[1]):
            d = gap[i, j]
            gradient = pressing[i, j] + traction[i, j] + pressure
            right_side[i, j] = -gradient
            if d > peak:
                curvature[i, j] += CAUTION * abs(gradient) / (d - equilibrium if gradient > 0.0 else d)
            energy += (0.5 * pressing[i, j] + pressure) * d
            largest = max(largest, abs(gradient))
            square += gradient * gradient
            total += gradient
    return energy, largest, square, total


class LawKernels:
    """Kernels of any law with a repulsive core; ``margin`` is added to a gap whose relative change is limited (m)."""

    margin = 0.0
    held: np.float32 | None = None  # the curvature of a point that a wall holds

    def __init__(self, law: TractionLaw):
        self.law = law

    def evaluate(
        self, gap: np.ndarray, traction: np.ndarray, stiffness: np.ndarray, strength: np.ndarray | None = None
    ) -> float:
        """Write φ' and φ'' of ``gap`` into the two arrays; return Σ φ over all points (J/m²).

        ``strength`` multiplies the law at each point; the gaps of a step do not depend on it.
        """
        total = 0.0
        for here in blocks(gap):
            traction[here] = self.law.traction(gap[here])
            stiffness[here] = self.law.stiffness(gap[here])
            potential = self.law.potential(gap[here])
            if strength is not None:
                traction[here] *= strength[here]
                stiffness[here] *= strength[here]
                potential = strength[here] * potential
            total += float(np.sum(potential))
        return total

    def gradient(self, pressing, gap, traction, pressure, right_side, curvature):
        """Write −gradient, raise ``curvature``; return Σ (½ pressing + pressure)·d, max|gradient|, Σ of squares, Σ."""
        law = self.law
        # Repulsion alone is convex: it needs no caution, and its peak is not beyond its equilibrium.
        peak = law.peak_distance if law.attracts else np.inf
        return law_gradient(pressing, gap, traction, pressure, right_side, curvature, law.equilibrium_distance, peak)

    def advance(self, gap: np.ndarray, step: np.ndarray, limit: float, out: np.ndarray) -> None:
        """Write the gap after a Newton step, moving each point in the variable in which it is nearly linear.

        A point in repulsion moves in its linearised traction φ' + φ''·step; another in its gap, into repulsion along
        the tangent at equilibrium, down to LANDING: otherwise one point deep in repulsion would shorten all steps.
        """
        law = self.law
        equilibrium, tangent = law.equilibrium_distance, law.equilibrium_stiffness
        # Without a peak there is nothing to overshoot: points end on the tangent.
        largest = LANDING * law.peak_tensile_stress or np.inf
        for here in blocks(gap):
            was, by = gap[here], step[here]
            np.add(was, np.clip(by, -limit * was, limit * was), out=out[here])
            # The law's functions are called for these few points alone.
            near = np.minimum(was, out[here]) < equilibrium
            was, by, moved = was[near], by[near], out[here][near]
            repelled = was < equilibrium
            traction = np.maximum(tangent * (moved - equilibrium), -largest)
            traction[repelled] = law.traction(was[repelled]) + law.stiffness(was[repelled]) * by[repelled]
            moved[repelled] = equilibrium + np.minimum(traction[repelled] / tangent, limit * equilibrium)
            pressed = traction < 0
            moved[pressed] = law.repulsive_gap(traction[pressed])
            out[here][near] = moved


@kernel
def _wall_gradient(pressing, gap, traction, pressure, margin, held, right_side, curvature):
    """Form the gradient outside a wall; held points are balanced and have the curvature ``held``."""
    energy = largest = square = total = 0.0
    for i in range(gap.shape[0]):
        for j in range(gap.shape[1]):
            d = gap[i, j]
            gradient = pressing[i, j] + traction[i, j] + pressure
            energy += (0.5 * pressing[i, j] + pressure) * d
            if d == 0.0 and gradient > 0.0:
                right_side[i, j] = 0.0
                curvature[i, j] = held
            else:
                right_side[i, j] = -gradient
                curvature[i, j] += CAUTION * abs(gradient) / (d + margin)
                largest = max(largest, abs(gradient))
                square += gradient * gradient
                total += gradient
    return energy, largest, square, total


@kernel
def _wall_advance(gap, step, limit, margin, out):
    """Add each step, limited to the fraction ``limit`` of gap and margin, and stop at the wall."""
    for i in range(gap.size):
        d = gap[i]
        most = limit * (d + margin)
        out[i] = max(d + min(max(step[i], -most), most), 0.0)


class WallKernels(LawKernels):
    """Kernels of any law outside a wall."""

    def __init__(self, law: TractionLaw, largest: float):
        super().__init__(law)
        self.margin = law.length
        self.held = np.float32(HELD * largest)

    def gradient(self, pressing, gap, traction, pressure, right_side, curvature):
        return _wall_gradient(pressing, gap, traction, pressure, self.margin, self.held, right_side, curvature)

    def advance(self, gap, step, limit, out):
        _wall_advance(gap.reshape(-1), step.reshape(-1), limit, self.margin, out.reshape(-1))


class ExponentialKernels(WallKernels):
    """Kernels of the exponential law, by one exponential a point: NumPy's is vectorised, unlike a compiled loop's."""

    def evaluate(self, gap, traction, stiffness, strength=None):
        law, total = self.law, 0.0
        for here in blocks(gap):
            tension = np.multiply(gap[here], -1 / law.length, out=traction[here])
            np.maximum(tension, LEAST_EXPONENT, out=tension)
            np.exp(tension, out=tension)
            tension *= law.work_of_adhesion / law.length
            if strength is not None:
                tension *= strength[here]
            np.multiply(tension, -1 / law.length, out=stiffness[here], casting="same_kind")
            total -= law.length * float(tension.sum())
        return total


@kernel
def _dugdale(past, fading, strength, traction, stiffness, mapped, plateau, width):
    """Evaluate Dugdale's law, over ``fading`` = exp(−|past|); sum the energy over −plateau·width."""
    total = 0.0
    for i in range(past.size):
        x, f = past[i], fading[i]
        factor = strength[i] if mapped else 1.0
        share = 1.0 / (1.0 + f)
        traction[i] = factor * plateau * (share * f if x > 0.0 else share)
        stiffness[i] = -factor * plateau / width * share * share * f
        # Off the ramp, where most points are, two terms are the logarithm in double precision.
        logarithm = np.log1p(f) if f > SMALL else f - 0.5 * f * f
        total += factor * (logarithm - min(x, 0.0))
    return total


class DugdaleKernels(WallKernels):
    """Kernels of Dugdale's law, compiled but for the exponential."""

    law: Dugdale

    def evaluate(self, gap, traction, stiffness, strength=None):
        law, total = self.law, 0.0
        mapped = strength is not None
        for here in blocks(gap):
            past = (gap[here] - law.length) / law.width
            fading = np.exp(np.maximum(-np.abs(past), LEAST_EXPONENT))
            fields = (past, fading, fading if strength is None else strength[here], traction[here], stiffness[here])
            total += float(_dugdale(*(field.reshape(-1) for field in fields), mapped, law.plateau, law.width))
        return -law.plateau * law.width * total


@cache
def _evaluation(exponent: int, mapped: bool) -> Callable[..., float]:
    """Compile :meth:`LawKernels.evaluate`, over the prefactor: an exponent as argument keeps loops from vectorising.

    ``mapped`` says whether the strength counts; without, any array stands for it.
    """
    low, high = float(exponent), exponent + 6.0
    attraction, repulsion = 1 / (exponent - 1), 1 / (exponent + 5)

    @kernel
    def evaluate(gap, length, prefactor, strength, traction, stiffness):
        total = 0.0
        for i in range(gap.size):
            s = length / gap[i]
            power, s6 = s**exponent, s**6
            if mapped:
                power *= strength[i]
            traction[i] = prefactor * power * (1.0 - s6)
            stiffness[i] = prefactor / length * power * s * (high * s6 - low)
            total += power * gap[i] * (repulsion * s6 - attraction)
        return total

    return evaluate


@cache
def _advance(exponent: int) -> Callable[..., None]:
    """Compile :meth:`LawKernels.advance` for one exponent."""
    low, high = float(exponent), exponent + 6.0
    touching = [each ** (1 / high) for each in _TANGENTS]
    (s0, y0, k0), (s1, y1, k1), (s2, y2, k2), (s3, y3, k3) = (
        (s, s**high - s**low, high * s ** (high - 1) - low * s ** (low - 1)) for s in touching
    )

    @kernel
    def advance(gap, step, limit, length, landing, out):
        tangent = 6.0 / length
        for i in range(gap.size):
            d = gap[i]
            x = step[i]
            s = length / d
            power, s6 = s**exponent, s**6
            moved = min(max(x, -limit * d), limit * d) + d
            if d < length:
                y = power * (s6 - 1.0) - power * s * (high * s6 - low) * x / length
                moved = length + min(-y / tangent, limit * length)
            else:
                y = min(tangent * (length - moved), landing)
            # s^(m+6) − s^m = y for s >= 1. The root is a concave function of y, so its tangents bound it from above,
            # as does the linear step; Newton descends from there.
            y_root = max(y, 0.0)
            root = min(s0 + (y_root - y0) / k0, s1 + (y_root - y1) / k1)
            root = min(root, min(s2 + (y_root - y2) / k2, s3 + (y_root - y3) / k3))
            if d < length:
                root = min(root, max(s - s * x / d, s))
            for _ in range(3):
                power, s6 = root**exponent, root**6
                root -= (power * (s6 - 1.0) - y_root) * root / (power * (high * s6 - low))
            out[i] = length / root if y > 0.0 else moved

    return advance


class LennardJonesKernels(LawKernels):
    """Kernels of a Lennard-Jones law, compiled."""

    law: LennardJones

    def evaluate(self, gap, traction, stiffness, strength=None):
        law = self.law
        evaluate = _evaluation(law.exponent, strength is not None)
        flat = (field.reshape(-1) for field in (gap if strength is None else strength, traction, stiffness))
        return law.prefactor * float(evaluate(gap.reshape(-1), law.length, law.prefactor, *flat))

    def advance(self, gap, step, limit, out):
        law, advance = self.law, _advance(self.law.exponent)
        landing = LANDING * law.peak_tensile_stress / law.prefactor
        advance(gap.reshape(-1), step.reshape(-1), limit, law.length, landing, out.reshape(-1))


def kernels_of(law: TractionLaw, largest: float = 1.0) -> LawKernels:
    """Return the kernels of a law, compiled ones where they exist; ``largest`` is the solid's stiffness (Pa/m)."""
    if isinstance(law, LennardJones):
        return LennardJonesKernels(law)
    if isinstance(law, Exponential):
        return ExponentialKernels(law, largest)
    if isinstance(law, Dugdale):
        return DugdaleKernels(law, largest)
    return WallKernels(law, largest) if law.has_wall else LawKernels(law)
