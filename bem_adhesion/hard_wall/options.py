"""Constants of the hard-wall solver, as frozen options with defaults; trials behind them are in research/notes."""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class ActiveSetOptions:
    """Constants of the active-set iteration.

    Parameters
    ----------
    coarsest : int
        Points along the shorter side down to which grids are halved.
    coarse_tolerance : float
        Residual on all grids but the finest.
    reduction : float
        Reduction of the residual by conjugate gradients before the contact set is checked again.
    inner_iterations : int
        Largest number of conjugate gradients on one contact set; about twice what the reduction takes.
    energy_rounding : float
        With a hardness: relative difference of equal energies.
    fractions : tuple of float
        With a hardness: fractions of a step of conjugate gradients that are tried.
    """

    coarsest: int = 32
    coarse_tolerance: float = 1e-2
    reduction: float = 0.03
    inner_iterations: int = 15
    energy_rounding: float = 1e-13
    fractions: tuple[float, ...] = (1.0, 0.5, 0.25)


@dataclass(frozen=True)
class HardWallOptions:
    """Constants of a hard-wall contact.

    Parameters
    ----------
    active_set : ActiveSetOptions
        Constants of the iteration.
    similar_load : float
        Relative change of the mean pressure, times points along the longer side, up to which an earlier state is a
        better start than the coarser grids.
    share_of_punch : float
        Unit of errors of a nearly flat punch with free boundaries, over its displacement.
    largest_share : float
        Largest pressure of a search over the hardness; no point of a grid is open then.
    first_share : float
        First pressure of a search, over that of a closed approach.
    at_hardness : float
        Relative difference from the hardness of one of many points that yield.
    stride : float
        Step of a search in the logarithm of the pressure, until it has the root between two pressures.
    """

    active_set: ActiveSetOptions = field(default_factory=ActiveSetOptions)
    similar_load: float = 16
    share_of_punch: float = 1e-3
    largest_share: float = 1 - 1e-9
    first_share: float = 1e-3
    at_hardness: float = 1e-8
    stride: float = 2.0
