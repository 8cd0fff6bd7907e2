"""The section ``[form]`` of a study file: the keys of each shape."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.inputs.units import length
from contact_study.physics.surfaces import forms
from contact_study.physics.surfaces.forms import Form, Placement
from contact_study.study.schema.keys import (
    ANGLE,
    FACTOR,
    METRES,
    OFFSET,
    TEXT,
    TaggedUnion,
    key,
    keys_of,
    pair,
    quantity,
)

Pair: TypeAlias = tuple[float, float]
Points: TypeAlias = tuple[int, int]


@dataclass(frozen=True, kw_only=True)
class FormSection:
    """The shape under the roughness of [surface], which ends at the edges of the cell."""

    kind: str = key(TEXT, "shape of the rigid body under its roughness", "none")

    @property
    def words(self) -> str:
        """Kind and lengths."""
        found = {name: getattr(self, name) for name, one in keys_of(type(self)).items() if one.kind.startswith("m")}
        sizes = (f"{name.replace('_', ' ')} {length(*np.atleast_1d(value))}" for name, value in found.items())
        return ", ".join([self.kind, *sizes])

    def made(self, size: Pair, shape: Points) -> Form | None:
        """The form on a cell, None without one; InputError if it ends within."""
        return None


@dataclass(frozen=True, kw_only=True)
class PlacedForm(FormSection, ABC):
    """A form, and where it is."""

    offset: tuple[float, float] = key(OFFSET, "axis of the form from the middle of the cell", (0.0, 0.0))
    rotation: float = key(ANGLE, "turn of the form about its axis, from x to y", 0.0)
    tilt: tuple[float, float] = key(pair(quantity("rad", minimum=-1.5, maximum=1.5)), "rise along y and x", (0.0, 0.0))

    @abstractmethod
    def shape_of(self, size: Pair, shape: Points, placement: Placement) -> Form:
        """The form on a cell."""

    def made(self, size: Pair, shape: Points) -> Form:
        found = self.shape_of(size, shape, Placement(self.offset, self.rotation, self.tilt))
        if not found.covers_cell:
            raise InputError(
                f"form.radius: the {self.kind} ends within the cell of {size[0]:g} x {size[1]:g} m; use a larger "
                'radius, a smaller cell or kind = "paraboloid"'
            )
        return found


class PlaneSection(PlacedForm):
    """A plane, to be tilted."""

    def shape_of(self, size: Pair, shape: Points, placement: Placement) -> Form:
        return forms.EllipticParaboloid(size, shape, None, placement, (np.inf, np.inf))


@dataclass(frozen=True, kw_only=True)
class SphereSection(PlacedForm):
    """A sphere of its true shape."""

    radius: float = key(METRES, "radius of the sphere, or of the cylinder along y")

    def shape_of(self, size: Pair, shape: Points, placement: Placement) -> Form:
        return forms.Sphere(size, shape, None, placement, self.radius)


class CylinderSection(SphereSection):
    """A cylinder of its true shape, along y unless rotated."""

    def shape_of(self, size: Pair, shape: Points, placement: Placement) -> Form:
        return forms.Cylinder(size, shape, None, placement, self.radius)


@dataclass(frozen=True, kw_only=True)
class ParaboloidSection(PlacedForm):
    """A paraboloid, the sphere of Hertz and JKR, or an elliptic one."""

    radii: tuple[float, float] = key(pair(METRES, broadcast=True), "radii of curvature of the apex")

    def shape_of(self, size: Pair, shape: Points, placement: Placement) -> Form:
        return forms.EllipticParaboloid(size, shape, None, placement, self.radii)


@dataclass(frozen=True, kw_only=True)
class ConeSection(PlacedForm):
    """A cone, whose tip may be rounded."""

    slope: float = key(FACTOR, "slope of the face, tangent of its angle against the plane")
    tip_radius: float = key(quantity("m", minimum=0.0), "radius of curvature of the tip, 0: sharp", 0.0)

    def shape_of(self, size: Pair, shape: Points, placement: Placement) -> Form:
        return forms.Cone(size, shape, None, placement, self.slope, self.tip_radius)


@dataclass(frozen=True, kw_only=True)
class PunchSection(PlacedForm):
    """A flat round punch with a rounded edge."""

    flat_radius: float = key(METRES, "radius of the flat face")
    edge_radius: float = key(METRES, "radius of curvature of the edge")

    def shape_of(self, size: Pair, shape: Points, placement: Placement) -> Form:
        return forms.Punch(size, shape, None, placement, self.flat_radius, self.edge_radius)


NO_FORM = FormSection()
FORMS = TaggedUnion(
    "kind",
    {
        "none": FormSection,
        "plane": PlaneSection,
        "sphere": SphereSection,
        "paraboloid": ParaboloidSection,
        "cone": ConeSection,
        "cylinder": CylinderSection,
        "punch": PunchSection,
    },
)
