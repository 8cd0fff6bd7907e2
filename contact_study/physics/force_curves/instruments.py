"""Force curves in files of atomic force microscopes, by the library afmformats."""

import logging
from pathlib import Path
from typing import Any

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.inputs.number_tables import TableError
from contact_study.physics.force_curves.columns import RawCurve

# Formats of afmformats whose names are not those of plain text: Igor, JPK, and its own.
SUFFIXES = (".ibw", ".jpk-force", ".jpk-force-map", ".jpk-qi-data", ".jpk-qi-series", ".h5", ".tab")
_HEIGHTS = ("height (measured)", "height (piezo)")
_CONSTANTS = ("spring constant", "sensitivity")


def read_instrument(path: Path, number: int | None, given: dict[str, float | None]) -> RawCurve:
    """Read one curve of a file; ``given`` has constants of the cantilever (SI) that replace or complete the file's."""
    try:
        import afmformats  # an extra
        from afmformats.errors import MissingMetaDataError
    except ImportError:
        raise InputError(f"{path}: files of microscopes need afmformats; pip install 'bem-adhesion[afm]'") from None
    asked = {name: value for name, value in given.items() if value is not None}
    logger = logging.getLogger("afmformats.formats")
    before, logger.disabled = logger.disabled, True  # it prints tracebacks
    try:
        try:
            curve = _one(afmformats.load_data(path, modality="force-distance"), number)
            found = _columns(curve)
        except MissingMetaDataError:
            curve = _one(afmformats.load_data(path, modality="force-distance", meta_override=asked), number)
            found = _columns(curve)
    except (InputError, KeyboardInterrupt, MemoryError):
        raise
    except MissingMetaDataError:
        raise TableError(f"{{path}} lacks constants of its cantilever; give {_wanted(asked)}") from None
    except BaseException as error:  # of the library's own errors none is an Exception
        raise TableError(f"cannot be read ({str(error).strip().partition(chr(10))[0]})") from None
    finally:
        logger.disabled = before
    meta = curve.metadata
    for name, value in asked.items():
        if not meta.get(name):
            raise TableError(f"{{path}} does not give its own {name}, so its force cannot be put to {value:g}")
        found["force"] = found["force"] * (value / float(meta[name]))
    own = asked.get("spring constant", meta.get("spring constant"))
    return RawCurve(found, spring_constant=None if own is None else float(own), baseline=True)


def _one(curves: list[Any], number: int | None) -> Any:
    """The curve of a number, or the only one."""
    count = len(curves)
    if not count:
        raise TableError("holds no curve of force and distance")
    if number is None and count != 1:
        raise TableError(f"holds {count} force curves; choose one with curve = 0 to {count - 1}")
    if number is not None and not 0 <= number < count:
        raise TableError(f"holds {count} force curves; curve = {number} must be 0 to {count - 1}")
    return curves[number or 0]


def _wanted(asked: dict[str, float]) -> str:
    return " and ".join(name.replace(" ", "_") for name in _CONSTANTS if name not in asked) or "others"


def _columns(curve: Any) -> dict[str, np.ndarray]:
    """The columns of a curve by quantity; the first height is the best that the file has."""
    held = curve.columns
    heights = [name for name in _HEIGHTS if name in held]
    if "force" not in held or not heights:
        raise TableError(f"holds {', '.join(held)}; a curve needs force and height")
    found = {"force": curve["force"], "height": curve[heights[0]]}
    found |= {name: curve[other] for other, name in (("time", "time"), ("segment", "branch")) if other in held}
    if "branch" in found and np.ptp(found["branch"]) == 0:  # the format has no segments
        del found["branch"]
    return {name: np.array(values, dtype=float) for name, values in found.items()}
