"""Constants of the hard-wall solver, as frozen options with defaults; trials behind them are in research/notes."""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class ActiveSetOptions:
    """Constants of the active-set iteration."""

    coarsest: int = 32  # points along the shorter side down to which grids are halved
    coarse_tolerance: float = 1e-2  # on all grids but the finest
    # Conjugate gradients on one contact set: reduction of the residual, and limit, about twice what that takes.
    reduction: float = 0.03
    inner_iterations: int = 15
    # With a hardness: relative difference of equal energies, and fractions of a step that are tried.
    energy_rounding: float = 1e-13
    fractions: tuple[float, ...] = (1.0, 0.5, 0.25)


@dataclass(frozen=True)
class HardWallOptions:
    """Constants of a hard-wall contact."""

    active_set: ActiveSetOptions = field(default_factory=ActiveSetOptions)
    # Relative change of the mean pressure, times points along the longer side, up to which an earlier state is a better
    # start than the coarser grids.
    similar_load: float = 16
    share_of_punch: float = 1e-3  # unit of errors of a nearly flat punch, over its displacement
    # Search for a pressure: largest over the hardness (no point of a grid is open then), first over that of a closed
    # approach, and step in the logarithm until the root is between two pressures.
    largest_share: float = 1 - 1e-9
    first_share: float = 1e-3
    stride: float = 2.0
    at_hardness: float = 1e-8  # relative difference from the hardness of one of many points that yield
