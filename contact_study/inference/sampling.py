"""Samples of the posterior of a fit, by the ensemble sampler of the extra ``sampler``."""

import numpy as np

from contact_study.inference.fit import Fit
from contact_study.inputs.errors import InputError

_WALKERS, _BURN_IN = 4, 0.3  # walkers per parameter; share of the steps that is left out
_SCATTER = 0.5  # of the walkers' starts, over the standard errors
_SEED = 1


def samples(found: Fit, count: int) -> np.ndarray:
    """Draw samples of the free parameters, with priors flat in their coordinates beside those given.

    D. Foreman-Mackey, D. W. Hogg, D. Lang, J. Goodman, Publ. Astron. Soc. Pac. 125, 306 (2013), doi:10.1086/670067.

    Parameters
    ----------
    found : Fit
        Fit of a problem; its errors are taken as known.
    count : int
        Number of samples, at least.

    Returns
    -------
    numpy.ndarray
        SI values, shape (samples, parameters).

    Raises
    ------
    InputError
        Without the extra.
    """
    try:
        import emcee  # an extra
    except ImportError:
        raise InputError("samples: need emcee; pip install 'bem-adhesion[sampler]'") from None
    problem = found.problem
    low, high = problem.bounds()

    def log_density(u: np.ndarray) -> float:
        if ((u < low) | (u > high)).any():
            return -np.inf
        return -0.5 * sum(problem.cost(u))

    size = found.best.size
    walkers = _WALKERS * size
    steps = int(np.ceil(count / walkers / (1 - _BURN_IN)))
    random = np.random.default_rng(_SEED)
    error = np.minimum(np.sqrt(np.diag(found.covariance)), 1.0)
    start = np.clip(found.best + _SCATTER * error * random.normal(size=(walkers, size)), low, high)
    sampler = emcee.EnsembleSampler(walkers, size, log_density)
    sampler.random_state = np.random.RandomState(_SEED).get_state()
    sampler.run_mcmc(start, steps)
    chain = sampler.get_chain(discard=int(_BURN_IN * steps), flat=True)
    return np.array([[one.value(x) for one, x in zip(problem.free, u, strict=True)] for u in chain])
