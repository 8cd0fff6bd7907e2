"""Kernels of Lennard-Jones laws, compiled for each exponent.

The exponent is a constant of the compiled loops: passed as an argument it keeps the compiler from vectorising the step.
"""

from collections.abc import Callable
from functools import cache

from bem_adhesion.kernels.law import LANDING, LawKernels
from contact_study.numerics.kernel import kernel
from contact_study.physics.laws.lennard_jones import LennardJones

# s^(m+6) at which tangents bound the root of s^(m+6) − s^m = y from above.
_TANGENTS = (1.0, 1.1**11, 1.25**11, 1.6**11)


@cache
def _evaluation(exponent: int) -> Callable[..., float]:
    """Compile :meth:`LawKernels.evaluate` for one exponent."""
    low, high = float(exponent), exponent + 6.0
    attraction, repulsion = 1 / (exponent - 1), 1 / (exponent + 5)

    @kernel
    def evaluate(gap, length, prefactor, traction, stiffness):
        """Fill flat arrays; return r0 Σ [s^(m+5)/(m + 5) − s^(m−1)/(m − 1)]."""
        total = 0.0
        for i in range(gap.size):
            s = length / gap[i]
            power, s6 = s**exponent, s**6
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
        """Take a Newton step over flat arrays; tractions in units of the prefactor."""
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

    def evaluate(self, gap, traction, stiffness):
        law = self.law
        evaluate = _evaluation(law.exponent)
        total = evaluate(gap.reshape(-1), law.length, law.prefactor, traction.reshape(-1), stiffness.reshape(-1))
        return law.prefactor * float(total)

    def advance(self, gap, step, limit, out):
        law, advance = self.law, _advance(self.law.exponent)
        landing = LANDING * law.peak_tensile_stress / law.prefactor
        advance(gap.reshape(-1), step.reshape(-1), limit, law.length, landing, out.reshape(-1))
