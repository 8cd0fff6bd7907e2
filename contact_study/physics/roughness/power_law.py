"""The power spectrum of a surface in bands, and the self-affine law that fits it.

The spectrum has the convention of :mod:`contact_study.physics.roughness.spectrum`, h_rms² = 2π ∫ q C dq.
"""

from dataclasses import dataclass, replace

import numpy as np

BANDS_PER_OCTAVE = 8
# Powers of q in C from 0 to −6; a self-affine surface has H from 0 to 1, noise and filters make others.
_HURST = np.linspace(-1.0, 2.0, 301)
_TAIL_POWERS = np.linspace(0.0, 8.0, 33)
# A self-affine range is nothing below an octave.
_SHORTEST_RANGE = BANDS_PER_OCTAVE
# Relative departure of C of a real surface from any law. Without it the thousands of waves of the shortest bands,
# known to a per cent, would decide alone.
_DEPARTURE = 0.1


@dataclass(frozen=True)
class PowerSpectrum:
    """Radial average of a power spectrum, in bands of an eighth of an octave; bands without a wave are left out.

    Attributes
    ----------
    wavevectors : numpy.ndarray, shape (n,)
        Root-mean-square |q| of the waves of each band, up to the Nyquist wavevector of the coarser axis (1/m).
    density : numpy.ndarray, shape (n,)
        C (m⁴).
    waves : numpy.ndarray, shape (n,)
        Independent amplitudes in each band: two a pair of waves of both signs.
    """

    wavevectors: np.ndarray
    density: np.ndarray
    waves: np.ndarray


@dataclass(frozen=True)
class SelfAffineFit:
    """A self-affine spectrum: flat up to the roll-off, C ∝ q^(−2−2H) from there to the cutoff.

    Attributes
    ----------
    hurst_exponent : float
        H; outside 0 to 1 the spectrum is flatter or steeper than that of any self-affine surface.
    uncertainty : float
        Its standard deviation.
    roll_off, cutoff : float
        Wavevectors (1/m) between which it was fitted.
    density : float
        C at and below the roll-off (m⁴).
    """

    hurst_exponent: float
    uncertainty: float
    roll_off: float
    cutoff: float
    density: float


def law_through(
    spectrum: PowerSpectrum, hurst_exponent: float, uncertainty: float, roll_off: float, cutoff: float
) -> SelfAffineFit:
    """A law of these constants at the level of a spectrum."""
    q = spectrum.wavevectors
    weight = _weights(spectrum) * (q <= cutoff)
    shape = np.maximum(q / roll_off, 1.0) ** (-2 - 2 * hurst_exponent)
    level = float(np.sum(weight * spectrum.density / shape) / np.sum(weight))
    return SelfAffineFit(hurst_exponent, uncertainty, roll_off, cutoff, level)


def self_affine_fit(spectrum: PowerSpectrum, limits: tuple[float, float] | None = None) -> SelfAffineFit | None:
    """The self-affine law of a spectrum by likelihood, each wave's power being exponentially distributed about C.

    That is the distribution of |h_q|² on a Gaussian surface (Whittle's likelihood of a spectrum); a band counts as
    no more waves than its C is known by, see ``_DEPARTURE``. Beyond the cutoff C is another power law: next to
    nothing, the flat floor of a measurement, or what edges leave. Roll-off and cutoff are those of the largest
    likelihood, and taken for real only where they raise it by more than their number asks for (Schwarz' criterion).
    H is the mean over all limits by their likelihood and its uncertainty the standard deviation, so that limits which
    the spectrum leaves open count, too. Where even the best law misses the spectrum by more than chance, the likelihood
    is widened by what it misses it by (deviance over degrees of freedom).

    Parameters
    ----------
    spectrum : PowerSpectrum
        The spectrum.
    limits : tuple of float, optional
        Roll-off and cutoff where they are known, of a spectrum of the waves between them (1/m).

    Returns
    -------
    SelfAffineFit or None
        None if it has less than an octave, or no power; of unknown limits, less than two octaves.
    """
    q, known = spectrum.wavevectors, limits is not None
    octaves = 1 if known else 2
    if q.size <= _SHORTEST_RANGE or spectrum.density.max() <= 0 or np.log2(q[-1] / q[0]) < octaves * (1 - 1e-9):
        return None
    waves = _weights(spectrum)
    # What rounding of a transform leaves of nothing.
    power = np.maximum(spectrum.density / spectrum.density.max(), 1e-30)
    own = waves * (np.log(power) + 1)  # cost of bands that no law covers
    number, tail = np.cumsum(waves), _tails(q, waves, power)
    penalty = 0.5 * np.log(number[-1])
    tried, costs = [], []
    for start in range(1 if known else q.size - _SHORTEST_RANGE):
        shape = np.maximum(q / q[start], 1.0)[None, :] ** (-2 - 2 * _HURST[:, None])
        # Sums up to each end, of every H.
        level, curve = np.cumsum(waves * power / shape, axis=1), np.cumsum(waves * np.log(shape), axis=1)
        for end in range(q.size - 1 if known else start + _SHORTEST_RANGE, q.size):
            cost = curve[:, end] + number[end] * (np.log(level[:, end] / number[end]) + 1) + penalty * (start > 0)
            if end + 1 < q.size:  # the cutoff divides a band, which no law covers
                cost = cost + own[end + 1] + 2 * penalty
            if end + 2 < q.size:
                cost = cost + tail[end + 2] + 2 * penalty
            tried.append((start, end))
            costs.append(cost)
    cost = np.stack(costs)
    misfit = max(2 * (cost.min() - own.sum()) / max(q.size - (2 if known else 4), 1), 1.0)
    likelihood = np.exp((cost.min() - cost) / misfit)
    likelihood /= likelihood.sum()
    hurst = float(np.sum(likelihood * _HURST))
    spread = float(np.sqrt(np.sum(likelihood * (_HURST - hurst) ** 2)))
    if limits is not None:
        return law_through(spectrum, hurst, spread, *limits)
    start, end = tried[int(np.argmin(cost.min(axis=1)))]
    found = law_through(spectrum, hurst, spread, float(q[start]), float(q[end]))
    # Squares of the wavevectors that part bands, of the last band by its mean square.
    outer = np.append(q[:-1] * q[1:], 2 * q[-1] ** 2 - q[-2] * q[-1])
    cutoff = outer[end]
    if end + 1 < q.size:
        # As far into the divided band, by its area, as its C is that of the law.
        share = spectrum.density[end + 1] / (found.density * (q[end + 1] / q[start]) ** (-2 - 2 * hurst))
        cutoff += min(share, 1.0) * (outer[end + 1] - outer[end])
    return replace(found, cutoff=float(np.sqrt(cutoff)))


def _weights(spectrum: PowerSpectrum) -> np.ndarray:
    """Observations that a band counts as: pairs of amplitudes, up to 1/``_DEPARTURE``²."""
    pairs = spectrum.waves / 2
    return pairs / (1 + pairs * _DEPARTURE**2)


def _tails(q: np.ndarray, waves: np.ndarray, power: np.ndarray) -> np.ndarray:
    """Least cost of a power law through all bands from each one on."""
    shape = (q / q[0])[None, :] ** -_TAIL_POWERS[:, None]
    number, level, curve = (
        np.cumsum(part[..., ::-1], axis=-1)[..., ::-1] for part in (waves, waves * power / shape, waves * np.log(shape))
    )
    return np.min(curve + number * (np.log(level / number) + 1), axis=0)
