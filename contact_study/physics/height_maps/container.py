"""Containers of contact.engineering: all measurements of a surface with their instruments in one ``.zip``.

Source: M. C. Röttger et al., Surf. Topogr.: Metrol. Prop. 10, 035032 (2022).
"""

import gc
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.inputs.units import quantity
from contact_study.physics.height_maps.height_map import silent
from contact_study.physics.height_maps.text import MapError, step_of
from contact_study.physics.roughness.measurement import Measurement


def read_container(path: Path, surface: str | int | None) -> tuple[list[Measurement], list[str]]:
    """Read the measurements of one surface of a container, NaN where heights are missing, and what is left out.

    ``surface`` is its name or number, from 0, in a container of several. InputError if there is none.
    """
    try:
        with silent():  # it warns of an MPI that is not there
            from SurfaceTopography.Container.IO import open_container
    except ImportError:
        raise InputError(f"surface.path: {path} is a container; it needs pip install '.[instruments]'") from None
    try:
        with silent():
            opened = open_container(str(path), format="ce")
            surfaces = [opened.container(number) for number in range(opened.nb_containers)]
    except Exception as error:  # of a dozen types, of a file that is damaged
        reason = str(error).strip().partition("\n")[0]
        raise InputError(f"surface.path: {path} is no container of contact.engineering ({reason})") from None
    names = [str((one.info or {}).get("name", number)) for number, one in enumerate(surfaces)]
    chosen = surface if isinstance(surface, int) else names.index(surface) if surface in names else None
    if len(surfaces) != 1 and (chosen is None or chosen >= len(surfaces)):
        listed = ", ".join(f"{number}: {name}" for number, name in enumerate(names))
        raise InputError(f"surface.channel = {surface!r}: {path} holds {len(surfaces)} surfaces ({listed}); choose one")
    found = surfaces[chosen or 0]
    doi = str(((found.info or {}).get("publication") or {}).get("doi_url") or "")
    notes = [] if doi else [f"{path} has no digital object identifier: its SHA-256 alone identifies it"]
    measurements = []
    scan = None
    for number in range(len(found)):
        name = f"{path.name}/{number}"
        try:
            with silent():
                scan = found[number]
                measurements.append(_measurement(f"{path.name}/{scan.info.get('name') or number}", scan, doi))
        except (MapError, InputError) as error:
            notes.append(f"{name} is left out: {str(error).replace('{path}', name)}")
        except Exception as error:
            notes.append(f"{name} is left out: it cannot be read ({str(error).strip().partition(chr(10))[0]})")
    with silent():
        del opened, surfaces, found, scan
        gc.collect()  # closes the files that the library leaves open
    if not measurements:
        raise InputError(f"surface.path: {path} holds no measurement that can be read ({'; '.join(notes)})")
    return measurements, notes


def _measurement(name: str, scan: Any, doi: str) -> Measurement:
    """One measurement in m; arrays of SurfaceTopography are (x, y)."""
    if scan.unit is None:
        raise MapError("it has no unit")
    metres = quantity(f"1 {scan.unit}", "m", f"unit of {name}")
    heights: np.ndarray = np.ma.filled(np.ma.asarray(scan.heights(), dtype=float), np.nan).T
    if scan.dim == 1:
        spacing: tuple[float, ...] = (metres * step_of("x", np.asarray(scan.positions(), dtype=float)),)
    else:
        spacing = tuple(metres * side / n for side, n in zip(scan.physical_sizes[::-1], heights.shape, strict=True))
    instrument = scan.info.get("instrument") or {}
    tip_radius, resolution = (_length(instrument.get("parameters") or {}, key) for key in ("tip_radius", "resolution"))
    words = str(instrument.get("name") or instrument.get("type") or "")
    return Measurement(name, metres * heights, spacing, tip_radius, resolution, bool(scan.is_periodic), words, doi=doi)


def _length(parameters: Mapping[str, Any], key: str) -> float | None:
    """A length of an instrument (m)."""
    given = parameters.get(key)
    return None if not given else quantity(f"{given['value']} {given['unit']}", "m", key)
