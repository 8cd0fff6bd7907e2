"""Real transforms of periodic fields by FFTW, and interpolation with them.

Plans are measured once per machine and shape and kept as FFTW "wisdom" in the user's cache directory: a resumed run
repeats the arithmetic of an uninterrupted one.
"""

import hashlib
import json
import math
import os
import sys
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from contact_study.inputs.files import cache_folder, has_locks
from contact_study.numerics.memory import Memory, Scratch

# OpenMP's threads spin while they wait for one another: two take up to a hundred times as long as one where another
# process holds a core. FFTW reads it when loaded.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

# A second thread of FFTW gains little below this size, and costs much when the other core is busy.
POINTS_FOR_THREADS = 1024**2
# Larger transforms for occasional use hold no memory: they are planned each time, from the wisdom.
POINTS_TO_HOLD = 512**2


@cache
def _fftw() -> Any:
    """Import pyFFTW without its faces of Dask and SciPy, which take longer than most commands need to start."""
    hidden = [name for name in ("dask", "scipy.fftpack") if name not in sys.modules]
    sys.modules.update(dict.fromkeys(hidden))  # type: ignore[arg-type]
    try:
        import pyfftw
    finally:
        for name in hidden:
            sys.modules.pop(name, None)
    return pyfftw


def _load_wisdom(path: Path) -> None:
    """Import wisdom if it is whole: FFTW may abort the process over damaged wisdom."""
    with suppress(OSError, ValueError):  # none yet, or a damaged file: measure again
        checksum, _, content = path.read_text("ascii").partition("\n")
        if checksum == _checksum(content):
            _fftw().import_wisdom([wisdom.encode() for wisdom in json.loads(content)])


def _save_wisdom(path: Path) -> None:
    content = json.dumps([wisdom.decode() for wisdom in _fftw().export_wisdom()])
    partial = path.with_suffix(".tmp")  # one at a time, under the lock
    partial.write_text(f"{_checksum(content)}\n{content}", "ascii")
    partial.replace(path)


def _checksum(content: str) -> str:
    return hashlib.sha256(content.encode()).hexdigest()


_planned: set[tuple[tuple[int, ...], np.dtype, int]] = set()  # what this process has planned and saved


class RealTransform:
    """A planned pair of real transforms over the last two axes, with its own aligned buffers.

    Write into :attr:`field`, call :meth:`forward`, multiply :attr:`spectrum`, call :meth:`backward`. Neither direction
    is normalised: fold ``1 / points`` into the kernel. :meth:`backward` destroys the spectrum, and so does the next use
    of any transform with its ``scratch``. ``pairs`` counts each transform as one half.
    """

    def __init__(
        self,
        shape: tuple[int, ...],
        dtype: type = np.float64,
        threads: int = 1,
        scratch: Scratch | None = None,
        memory: Memory | None = None,
    ):
        self.shape = tuple(shape)
        self.dtype = np.dtype(dtype)
        self.points = shape[-2] * shape[-1]
        self.pairs = 0.0
        complex_type = np.dtype(np.complex128 if self.dtype == np.float64 else np.complex64)
        self.field = (memory or Memory()).array(self.shape, dtype)
        self.spectrum = (scratch or Scratch()).array((*self.shape[:-1], self.shape[-1] // 2 + 1), complex_type)
        self._plan(threads)

    def _plan(self, threads: int) -> None:
        from filelock import FileLock  # slow to import, as FFTW is

        fftw = _fftw().FFTW

        def plan() -> tuple[Any, Any]:
            flags = ("FFTW_MEASURE", "FFTW_DESTROY_INPUT")
            forward = fftw(self.field, self.spectrum, (-2, -1), "FFTW_FORWARD", flags[:1], threads)
            return forward, fftw(self.spectrum, self.field, (-2, -1), "FFTW_BACKWARD", flags, threads)

        key = (self.shape, self.dtype, threads)
        path = cache_folder() / "fftw-wisdom.txt"
        with suppress(OSError):  # of a read-only home
            path.parent.mkdir(parents=True, exist_ok=True)
            if key not in _planned and has_locks(path.parent):
                with FileLock(path.with_suffix(".lock")):
                    _load_wisdom(path)
                    plan()
                    # Saved even when nothing had to be measured: a plan put together from the wisdom of other shapes
                    # must be the plan of every later process too, whatever it has planned before.
                    _save_wisdom(path)
                _planned.add(key)
        self._forward, self._backward = plan()  # from the wisdom, if it could be kept
        self.field[...] = 0  # measuring overwrites the buffers
        self.spectrum[...] = 0

    def forward(self) -> np.ndarray:
        """Transform :attr:`field` into :attr:`spectrum`; return that."""
        self._forward.execute()
        self.pairs += 0.5
        return self.spectrum

    def backward(self) -> np.ndarray:
        """Transform :attr:`spectrum` into :attr:`field`, which is returned, without ``1 / points``."""
        self._backward.execute()
        self.pairs += 0.5
        return self.field

    def interpolate(self, coarser: "RealTransform") -> np.ndarray:
        """Interpolate the field of a transform on a coarser grid of the same periods into :attr:`field`."""
        coefficients = coarser.forward() / coarser.points  # a copy: the spectra may lie in one memory
        resize_spectrum(coefficients, coarser.shape, self.shape, self.spectrum)
        return self.backward()


_held = cache(RealTransform)


def _occasional(shape: tuple[int, ...]) -> RealTransform:
    """A single-threaded transform of a shape, shared with other calls unless it is large."""
    return _held(shape) if math.prod(shape) <= POINTS_TO_HOLD else RealTransform(shape)


def transform(field: np.ndarray) -> np.ndarray:
    """Coefficients h_q of ``h(x) = Σ_q h_q exp(i q·x)`` of a real field, in the layout of ``rfft2``."""
    plan = _occasional(field.shape)
    plan.field[...] = field
    return plan.forward() / plan.points


def synthesise(coefficients: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """The real field on ``shape`` points whose coefficients :func:`transform` would return."""
    plan = _occasional(tuple(shape))
    plan.spectrum[...] = coefficients
    field = plan.backward()
    return field.copy() if field.size <= POINTS_TO_HOLD else field


def resize_spectrum(
    coefficients: np.ndarray, old: tuple[int, ...], new: tuple[int, ...], out: np.ndarray | None = None
) -> np.ndarray:
    """Convert coefficients of :func:`transform` to another number of points of the same trigonometric polynomial.

    A Nyquist mode of an even old grid is split between both signs on a finer one: real, of least curvature.
    """
    rows = _resize_full_axis(coefficients, old[0], new[0])
    out = np.empty((new[0], new[1] // 2 + 1), dtype=coefficients.dtype) if out is None else out
    out[...] = 0
    keep = (min(old[1], new[1]) - 1) // 2 + 1  # modes strictly below both Nyquist modes
    out[:, :keep] = rows[:, :keep]
    if old[1] % 2 == 0 and new[1] > old[1]:
        out[:, old[1] // 2] = 0.5 * rows[:, old[1] // 2]
    elif new[1] % 2 == 0 and old[1] >= new[1]:
        # Both signs of the mode fall on the new Nyquist column.
        column = rows[:, new[1] // 2]
        out[:, new[1] // 2] = column if old[1] == new[1] else column + np.conj(np.roll(column[::-1], 1))
    return out


def _resize_full_axis(coefficients: np.ndarray, old: int, new: int) -> np.ndarray:
    if old == new:
        return coefficients
    out = np.zeros((new, coefficients.shape[1]), dtype=coefficients.dtype)
    keep = (min(old, new) - 1) // 2
    below = np.r_[: keep + 1, -keep:0]
    out[below] = coefficients[below]
    if old % 2 == 0 and new > old:
        out[[old // 2, -(old // 2)]] = 0.5 * coefficients[old // 2]
    elif new % 2 == 0 and old > new:
        out[new // 2] = coefficients[new // 2] + coefficients[-(new // 2)]
    return out


def interpolate(field: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """Trigonometric interpolation of a periodic field on another number of points."""
    if field.shape == tuple(shape):
        return field.copy()
    return synthesise(resize_spectrum(transform(field), field.shape, shape), shape)
