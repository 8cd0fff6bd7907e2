"""The datasets that are to be joined: what each holds, read from its attributes."""

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import xarray as xr

from contact_study.campaign.dataset.formats import engine_of, readable, require_dataset
from contact_study.campaign.model import MODULES, Model, model_of
from contact_study.campaign.resume.identity import Cases, recorded_height_maps
from contact_study.campaign.store.files import real
from contact_study.errors import InputError
from contact_study.study.study import make_study

# What every file of one study has in common besides the study.
_SAME = ("model", "version", "schema_version")


@dataclass(frozen=True)
class Source(Cases):
    """One of the datasets.

    Attributes
    ----------
    path : pathlib.Path
        Its file.
    attributes : dict
        Its global attributes.
    """

    path: Path
    attributes: dict[str, Any]


def read_sources(paths: Sequence[Path]) -> list[Source]:
    """Open datasets of one model and version.

    Raises
    ------
    InputError
        If there are fewer than two, one is given twice, missing or foreign, or they are of different models, versions
        or height maps.
    """
    if len(paths) < 2:
        raise InputError("give at least two datasets to join")
    seen: set[str] = set()
    for path in paths:
        if real(path) in seen:
            raise InputError(f"{path} is given twice")
        seen.add(real(path))
    sources = [_source(path) for path in paths]
    first = sources[0]
    for other in sources[1:]:
        for name in _SAME:
            one, two = (source.attributes.get(name) for source in (first, other))
            if one != two:
                raise InputError(
                    f"{first.path} and {other.path} cannot be joined: {name} is {one} in the one and {two} in the other"
                )
        if bool(first.attributes.get("predictor")) != bool(other.attributes.get("predictor")):
            raise InputError(
                f"{first.path} and {other.path} cannot be joined: one was run with --predictor, one without"
            )
    _check_height_maps(sources)
    return sources


def _source(path: Path) -> Source:
    require_dataset(path)
    with readable(path), xr.open_dataset(path, engine=engine_of(path), decode_timedelta=False) as dataset:
        attributes, sizes = dict(dataset.attrs), dict(dataset.sizes)
        held = {str(name): dataset[name].values.tolist() for name in dataset.dims if name in dataset.coords}
    model = _model(path, attributes)
    try:
        study = make_study(tomllib.loads(str(attributes["study_toml"])), path.parent)
    except (KeyError, tomllib.TOMLDecodeError, InputError) as error:
        reason = f" ({error})" if isinstance(error, InputError) else ""
        raise InputError(f"{path}: its study cannot be read{reason}") from None
    for name, swept in study.sweep.items():
        if held.get(name) != list(swept.values):
            raise InputError(
                f"{path}: does not hold the points of {name} that its study sweeps ({sizes.get(name, 0)} of "
                f"{len(swept.values)}), as if it had been cut or joined by other means; give files as they were written"
            )
    maps = recorded_height_maps(attributes)
    if any(case.height_map is not None and case.surface.map_path not in maps for case in study.cases):
        raise InputError(f"{path}: does not say what its height map held")
    return Source(model, study, maps, path, attributes)


def _model(path: Path, attributes: dict[str, Any]) -> Model:
    kind = str(attributes.get("model"))
    if kind not in MODULES or "schema_version" not in attributes:
        raise InputError(f"{path}: is no dataset of bem-adhesion, md-reference or persson-theory")
    return model_of(kind)


def _check_height_maps(sources: Sequence[Source]) -> None:
    """One path stands for one content: the study that is joined names each map once."""
    known: dict[str, tuple[Source, str]] = {}
    for source in sources:
        for name, content in source.height_maps.items():
            first, other = known.setdefault(name, (source, content))
            if other != content:
                raise InputError(
                    f"{first.path} and {source.path} cannot be joined: the height map {name} had another content "
                    f"(SHA-256 {other[:12]}… and {content[:12]}…)"
                )
