"""One file with the states of datasets: a slider, maps, curves, section and distributions, without a server."""

import base64
import contextlib
import itertools
import json
import math
import zlib
from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

import jinja2
import numpy as np
import xarray as xr
from bokeh.embed import components

from contact_study.campaign.store.files import write_aside
from contact_study.explore import pictures
from contact_study.explore.pictures import MapView, View
from contact_study.explore.selection import fields_of, in_words, load_path, state_of, sweep_menus
from contact_study.inputs.errors import InputError
from contact_study.report.read.lazy import Model, open_models

_FIELDS = {"gap": "gap", "pressure": "pressure", "clusters": "patches"}
_BYTES = 6e6  # of all maps before they are compressed, to about a third
_FINEST, _COARSEST = 200, 40  # cells of a map along a side
_LEVELS = 254  # of a map between the ends of its colours; one more is contact
_DIGITS = 4


def write_static_page(paths: Sequence[Path], output: Path, title: str = "") -> None:
    """Write one page with all states of some datasets, which works without a network.

    Maps have as many cells, and levels of a byte, as keep the file to a few megabytes.

    Parameters
    ----------
    paths : sequence of pathlib.Path
        Datasets; maps are of the first with fields.
    output : pathlib.Path
        The page, ``.html``.
    title : str, optional
        Its heading, by default the title of the first study.

    Returns
    -------
    None

    Raises
    ------
    InputError
        If a path leads to no dataset, or a dataset has no state.

    Examples
    --------
    >>> from pathlib import Path
    >>> write_static_page([Path("bem.nc")], Path("page.html"))  # doctest: +SKIP
    """
    models = open_models(paths)
    menus = sweep_menus(models)
    points = [
        dict(zip(menus, one, strict=True)) for one in itertools.product(*(own.values() for own in menus.values()))
    ]
    with_maps = [name for name, model in models.items() if fields_of(model.dataset)]
    lead = next(iter(with_maps or models))
    maps = len(points) * models[lead].dataset.sizes["step"] * len(_FIELDS)
    cells = min(_FINEST, int(math.sqrt(_BYTES / maps)))
    cells = cells if with_maps and cells >= _COARSEST else 0
    cases = [_case(models, lead, point, cells) for point in points]
    views = [case.pop("views") for case in cases if case is not None]
    if not views:
        raise InputError(f"{paths[0]}: holds no state to show")
    shown = _figures(views[0])
    palettes = {name: pictures.palette(view.look) for name, view in views[0].get("maps", {}).items()}
    text = json.dumps({"cases": cases, "palettes": palettes}, default=_plain).replace("</", "<\\/")
    heading = title or str(models[lead].dataset.attrs.get("title", "")) or "Results"
    choices = {"curves": pictures.CURVES, "densities": pictures.DISTRIBUTIONS}
    given = {
        **{what: {name: words[name] for name in words if name in views[0][what]} for what, words in choices.items()},
        "keys": [{"name": key.replace("_", " "), "words": [*own]} for key, own in menus.items()],
        "fields": {name: _FIELDS[name] for name in palettes},
        "inks": pictures.INKS,
        "ground": pictures.GROUND,
        "data": text,
    }
    template = jinja2.Environment().from_string(files(__package__).joinpath("static_page.html.j2").read_text("utf-8"))
    script, given["pictures"] = components(shown)
    library = files("bokeh").joinpath("server/static/js/bokeh.min.js").read_text("utf-8")  # Panel changes INLINE
    page = template.render(title=heading, library=library, script=script, **given)
    write_aside(output, lambda partial: partial.write_text(page, encoding="utf-8"))


def _case(models: Mapping[str, Model], lead: str, point: Mapping[str, Any], cells: int) -> dict[str, Any] | None:
    """All states of a case as the page's script reads them, and the views of the first for its figures."""
    found = {name: model.case(point) for name, model in models.items()}
    paths = {name: load_path(case) for name, case in found.items() if case is not None}
    cases = {name: case for name, case in found.items() if case is not None and paths[name].steps.size}
    if lead not in cases:
        return None
    curves = {kind: view for kind in pictures.CURVES if (view := pictures.curve_view(cases, kind)) is not None}
    fields = [name for name in fields_of(cases[lead]) if name in _FIELDS] if cells else []
    first: dict[str, Any] = {"curves": curves}
    states = []
    for place in range(paths[lead].steps.size):
        places = {name: paths[name].nearest(paths[lead], place) for name in cases}
        steps = {name: int(paths[name].steps[own]) for name, own in places.items()}
        densities = {of: view for of in pictures.DISTRIBUTIONS if (view := pictures.density_view(cases, steps, of))}
        state = {
            "words": [in_words(models[name], cases[name], paths[name], own) for name, own in places.items()],
            "now": {kind: pictures.states_now(view, places) for kind, view in curves.items()},
            "densities": {of: _of(view) for of, view in densities.items()},
        }
        first.setdefault("densities", densities)
        with contextlib.suppress(ValueError):  # a state whose fields were not kept
            shown = state_of(cases[lead], steps[lead], *fields, "section") if fields else xr.Dataset()
            maps = {name: pictures.map_view(shown, name, cells=cells) for name in fields}
            state["maps"] = {name: _levels(view) for name, view in maps.items()}
            if "height" in shown:
                section = pictures.section_view(shown)
                state["section"] = _of(section)
                first.setdefault("section", section)
            first.setdefault("maps", maps)
        states.append(state)
    return {"curves": {kind: _of(view) for kind, view in curves.items()}, "states": states, "views": first}


def _figures(views: Mapping[str, Any]) -> dict[str, Any]:
    """The figures of a page, with names by which its script finds them and their sources."""
    shown: dict[str, Any] = {}
    if views.get("maps"):
        shown["map"] = pictures.MapPicture(next(iter(views["maps"].values())), "Map")
        shown["map"].mapper.name, shown["map"].bar.name = "map:colours", "map:bar"
    if views["curves"]:
        shown["curve"] = pictures.CurvePicture(next(iter(views["curves"].values())), (380, 250))
        shown["curve"].now.name = "curve:now"
    if "section" in views:
        shown["section"] = pictures.SectionPicture(views["section"], (380, 130), "Section through the highest point")
    if views["densities"]:
        shown["density"] = pictures.CurvePicture(next(iter(views["densities"].values())), (380, 140))
    for name, picture in shown.items():
        picture.figure.name = name
        for own, source in picture.sources.items():
            source.name = f"{name}:{own}"
    return {name: picture.figure for name, picture in shown.items()}


def _of(view: View) -> dict[str, Any]:
    return {"sources": view.sources, "x_label": view.x_label, "y_label": view.y_label}


def _levels(view: MapView) -> dict[str, Any]:
    """A map in levels of a byte, compressed."""
    low, high = (end / view.look.unit.size for end in (view.look.low, view.look.high))
    with np.errstate(invalid="ignore"):
        levels = np.clip(np.rint((view.cells - low) / (high - low or 1.0) * _LEVELS), 0, _LEVELS)
    levels = np.where(np.isfinite(view.cells), levels, _LEVELS + 1).astype(np.uint8)
    image = {name: column[0] for name, column in view.sources["image"].items() if name != "image"}
    packed = base64.b64encode(zlib.compress(levels.tobytes(), 9)).decode()
    return {"levels": packed, "shape": levels.shape, "image": image, "low": low, "high": high, "words": view.look.words}


def _plain(value: Any) -> Any:
    """Numbers of arrays to a few digits, none where they are not finite."""
    if isinstance(value, np.ndarray):
        return [float(f"{one:.{_DIGITS}g}") if np.isfinite(one) else None for one in value.tolist()]
    return value.item()
