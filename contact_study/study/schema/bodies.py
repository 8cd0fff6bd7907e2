"""The sections ``[detail]`` and ``[counterface]``, and the surface that they and ``[form]`` make with ``[surface]``."""

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from contact_study.inputs import plugins
from contact_study.inputs.errors import InputError
from contact_study.physics.surfaces.composite import CompositeSurface, combined_scales, placed
from contact_study.physics.surfaces.surface import Surface, SurfaceScales
from contact_study.study.schema.form import FORMS, NO_FORM, FormSection
from contact_study.study.schema.keys import TEXT, TaggedUnion, bind, key, keys_of
from contact_study.study.schema.surface import SURFACES, MapFile, SurfaceSection


@dataclass(frozen=True, kw_only=True)
class AddedSection:
    """Further roughness: [detail] on the same body, [counterface] on the other, heights outward from there."""

    absent: ClassVar[bool] = True

    kind: str = key(TEXT, "roughness added to that of [surface], of any kind that it has", "none")


NOTHING = AddedSection()
ADDED = TaggedUnion("kind", {"none": AddedSection, **SURFACES.declared}, inherited=("size", "shape", "seed"))
SURFACES.followers.append(ADDED)
ADDED_SECTIONS = ("detail", "counterface")
ROUGH_SECTIONS = ("surface", *ADDED_SECTIONS)


def bind_added(table: Mapping[str, Any], name: str, surface: SurfaceSection) -> Any:
    """Bind ``[detail]`` or ``[counterface]``: size, shape and seed are those of [surface] where it has none."""
    section, filled = ADDED.section_of(table) or AddedSection, dict(table)
    if "shape" in table and surface.shape is not None:
        raise InputError(f"{name}.shape: the grid is that of surface.shape; leave it out")
    with _speaking_of(name):
        for each in ADDED.inherited:
            given, of_map = getattr(surface, each, None), "path" in table and each != "seed"
            if given is None or of_map or each in table or each not in keys_of(section):
                continue
            if each == "shape" and surface.size is not None:  # the grid on a period of its own
                period = keys_of(section)["size"].read(filled["size"], f"{name}.size")
                given = [_points_on(period[axis], given[axis], surface.size[axis]) for axis in (0, 1)]
            filled[each] = list(given) if isinstance(given, tuple) else given
        return bind(ADDED, filled, name)


def _points_on(period: float, points: int, side: float) -> int:
    """Points on a period of the spacing of a grid."""
    return max(4, round(points * period / side))


@contextmanager
def _speaking_of(name: str) -> Iterator[None]:
    """Give errors of a kind of surface, which name [surface], and of a placement the name of their section."""
    try:
        yield
    except InputError as error:
        own = str(error).replace("surface.", f"{name}.")
        # The grid is no key of the section: points on its period follow from surface.shape.
        raise InputError(re.sub(rf"{name}\.shape = (\[[^]]*\])", r"surface.shape (\1 on its period)", own)) from None
    except ValueError as error:
        raise InputError(f"{name}.{error}") from None


@dataclass(frozen=True, kw_only=True)
class Composite(SurfaceSection):
    """``[surface]`` with the form and the roughness beside it, for all who need heights."""

    words = "two bodies: form, roughness and counterface"

    kind: str = "composite"
    surface: SurfaceSection
    form: FormSection
    detail: Any
    counterface: Any

    @property
    def _added(self) -> dict[str, SurfaceSection]:
        every = {name: getattr(self, name) for name in ADDED_SECTIONS}
        return {name: part for name, part in every.items() if not part.absent}

    @property
    def _parts(self) -> dict[str, SurfaceSection]:
        """Sections of roughness, seeds of random ones independent."""
        found = {"surface": self.surface}
        for name, part in self._added.items():
            # Equal seeds of two sections draw other waves, and an ensemble over surface.seed has new ones of both.
            number = [1 + ADDED_SECTIONS.index(name), getattr(part, "seed", 0)]
            drawn: Any = {"seed": int(np.random.SeedSequence(number).generate_state(1)[0])}
            found[name] = replace(part, **drawn) if hasattr(part, "seed") else part
        return found

    @property
    def height_key(self) -> str:  # type: ignore[override]
        parts = [part.height_key.replace("surface.", f"{name}.") for name, part in self._parts.items() if part.rough]
        return ", ".join(parts + ([] if self.form.kind == "none" else ["form"])) or self.surface.height_key

    @property
    def rough(self) -> bool:  # type: ignore[override]
        return self.form.kind != "none" or any(part.rough for part in self._parts.values())

    @property
    def periodic(self) -> bool:  # type: ignore[override]
        return self.form.kind == "none" and all(part.periodic for part in self._parts.values())

    @property
    def map_keys(self) -> dict[str, str]:
        return {f"{name}.path": part.map_path for name, part in self._parts.items() if part.map_path is not None}

    @property
    def realisation(self) -> int | None:
        seeds = (part.realisation for part in (self.surface, *self._added.values()))
        return next((seed for seed in seeds if seed is not None), None)

    def cell(self, directory: Path) -> tuple[float, float] | None:
        return self.surface.cell(directory)

    def realise(self, directory: Path) -> CompositeSurface:
        made: list[Surface] = []
        for name, part in self._parts.items():
            with _speaking_of(name):
                one = part.realise(directory)
                size, shape = (made[0].size, made[0].shape) if made else (one.size, one.shape)
                made.append(placed(one, size, shape, part.offset, part.rotation, facing=name == "counterface"))
        form = self.form.made(size, shape)
        return CompositeSurface(size, shape, None, (*made, *([] if form is None else [form])))

    def scales(self, directory: Path) -> SurfaceScales:
        found: dict[str, SurfaceScales] = {}
        for name, part in self._parts.items():
            with _speaking_of(name):
                if found and type(part) is MapFile:  # the grid of the contact may be too coarse for it
                    whole, period = found["surface"], part.cell(directory)
                    y, x = (_points_on(period[axis], whole.shape[axis], whole.size[axis]) for axis in (0, 1))
                    part = replace(part, shape=(y, x))
                found[name] = part.scales(directory)
        whole = found["surface"]
        maps = ((path, found[key.partition(".")[0]]) for key, path in self.map_keys.items())
        form = self.form.made(whole.size, whole.shape)
        return replace(combined_scales([*found.values()], form, whole.size, whole.shape), maps=tuple(maps))


def composed(
    surface: SurfaceSection,
    form: FormSection = NO_FORM,
    detail: Any = NOTHING,
    counterface: Any = NOTHING,
) -> SurfaceSection:
    """The surface of a contact: ``[surface]`` itself if there is nothing beside it, and it is not moved."""
    sections = {"form": form, "detail": detail, "counterface": counterface}
    beside = [name for name, section in sections.items() if section.kind != "none"]
    if surface.absent and beside:
        raise InputError(f'missing key surface.kind: [{beside[0]}] is added to a surface, of kind "flat" if to nothing')
    if not (beside or any(surface.offset) or surface.rotation):
        return surface
    return Composite(surface=surface, size=surface.size, shape=surface.shape, **sections)


def composite_surface(
    surface: Mapping[str, Any],
    form: Mapping[str, Any] | None = None,
    detail: Mapping[str, Any] | None = None,
    counterface: Mapping[str, Any] | None = None,
    directory: Path | str = ".",
) -> Surface:
    """Combine form and roughness of one body with the roughness of the other into one height function.

    Parameters
    ----------
    surface, form, detail, counterface : mapping
        Sections of these names, as in a study file.
    directory : path-like, optional
        Start of relative paths of height maps.

    Returns
    -------
    Surface
        Its ``sampled`` are the combined heights on the grid of ``surface``, shape (y, x), toward the flat body (m).

    Raises
    ------
    InputError
        If a key is unknown, missing or impossible, or a height map cannot be read.

    Examples
    --------
    >>> import contact_study
    >>> found = contact_study.composite_surface(
    ...     {"kind": "wavy", "size": "1 um", "shape": [32, 32], "amplitude": "2 nm", "modes": [4, 4]},
    ...     form={"kind": "sphere", "radius": "10 um"},
    ...     counterface={"kind": "wavy", "amplitude": "2 nm", "modes": [4, 4], "offset": ["125 nm", "0 nm"]},
    ... )
    >>> f"{1e9 * found.sampled.max():.2f} nm"  # half a wave apart the waves cancel, and the sphere is left
    '8.34 nm'
    """
    plugins.load()
    body = bind(SURFACES, surface, "surface")
    added = (
        bind_added(table or {}, name, body) for name, table in zip(ADDED_SECTIONS, (detail, counterface), strict=True)
    )
    return composed(body, bind(FORMS, form or {}, "form"), *added).realise(Path(directory))
