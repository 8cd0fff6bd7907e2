"""The section ``[elasticity]`` of a study file: the keys of each solid, and the solid that they make."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.physics.solids import (
    Elasticity,
    FunctionSolid,
    HalfSpace,
    Layer,
    Layered,
    Measured,
    Plate,
    Sheet,
    Viscoelastic,
)
from contact_study.physics.solids.base import indentation_modulus, stiffnesses
from contact_study.physics.solids.function import name_of, named
from contact_study.study.schema import keys
from contact_study.study.schema.keys import METRES, PASCALS, PER_METRE, SECONDS, TEXT, key, quantity, sequence
from contact_study.study.schema.sections import POISSONS_RATIO, MaterialSection

SAME_MODULUS = 1e-6  # relative difference of two contact moduli that are meant to be one


@dataclass(frozen=True, kw_only=True)
class ElasticitySection(ABC):
    """The solid, of the constants of [material]; a kind declares its keys as fields."""

    # The solid in a sentence, before its constants; a name in braces is replaced by the values of that key.
    words: ClassVar[str]
    may_be_free: ClassVar[bool] = False  # whether its surface may extend beyond the rigid one, and not be repeated
    makes: ClassVar[type[Elasticity] | None] = None  # whose objects a Python study may give in place of these keys

    kind: str = key(TEXT, "what solid the block is", "half_space")
    boundary: str = key(
        keys.choice("periodic", "free", "free_x", "free_y"),
        "axes along which surface and block are not repeated: one cell on a half-space",
        "periodic",
    )

    def __post_init__(self) -> None:
        if self.boundary != "periodic" and not self.may_be_free:
            raise InputError(
                f'elasticity.boundary = "{self.boundary}": known of kind = "half_space" and "transversely_isotropic" '
                f'only, not of "{self.kind}"; use boundary = "periodic"'
            )

    @abstractmethod
    def solid(self, material: MaterialSection) -> Elasticity:
        """Make the solid of a material."""

    @classmethod
    def keys_from(cls, solid: Any, poissons_ratio: float) -> dict[str, Any]:
        """Return the keys, without the kind, that make a solid of class ``makes``: the inverse of :meth:`solid`."""
        return {}


class HalfSpaceSection(ElasticitySection):
    """The default, which needs no key."""

    words = ""
    may_be_free = True
    makes = HalfSpace

    def solid(self, material: MaterialSection) -> HalfSpace:
        return HalfSpace(material.combined(material.contact_modulus))


@dataclass(frozen=True, kw_only=True)
class LayerSection(ElasticitySection):
    """A layer of the material on a rigid base."""

    words = "a layer of thickness {thickness} bonded to a rigid base, "
    makes: ClassVar[type[Elasticity] | None] = Layer

    thickness: float = key(METRES, "thickness of the layer")

    def solid(self, material: MaterialSection) -> Elasticity:
        return Layer(material.contact_modulus, material.poissons_ratio, self.thickness)

    @classmethod
    def keys_from(cls, solid: Any, poissons_ratio: float) -> dict[str, Any]:
        return {"thickness": solid.thickness}


@dataclass(frozen=True, kw_only=True)
class LayeredSection(LayerSection):
    """A layer of the material on a half-space of another."""

    words = (
        "a layer of thickness {thickness} bonded to a half-space of modulus {base_youngs_modulus} and Poisson's ratio "
        "{base_poissons_ratio}, "
    )
    makes = Layered

    base_youngs_modulus: float = key(PASCALS, "Young's modulus of the half-space under the layer")
    base_poissons_ratio: float = key(POISSONS_RATIO, "Poisson's ratio of the half-space under the layer")

    def solid(self, material: MaterialSection) -> Layered:
        layer = material.contact_modulus, material.poissons_ratio, self.thickness
        base_modulus = self.base_youngs_modulus / (1 - self.base_poissons_ratio**2)
        return Layered(*layer, base_modulus, self.base_poissons_ratio)

    @classmethod
    def keys_from(cls, solid: Any, poissons_ratio: float) -> dict[str, Any]:
        modulus, ratio = solid.base_modulus * (1 - solid.base_poissons_ratio**2), solid.base_poissons_ratio
        return {"thickness": solid.thickness, "base_youngs_modulus": modulus, "base_poissons_ratio": ratio}


@dataclass(frozen=True, kw_only=True)
class PlateSection(LayerSection):
    """A layer of the material that nothing supports."""

    words = "a plate of thickness {thickness} with free faces, "
    makes = Plate

    def solid(self, material: MaterialSection) -> Plate:
        return Plate(material.contact_modulus, self.thickness)


@dataclass(frozen=True, kw_only=True)
class SheetSection(ElasticitySection):
    """A sheet of its own constants; those of the material are quoted, and the unit of stresses."""

    words = (
        "a sheet of bending stiffness {bending_stiffness}, tension {tension} and foundation {foundation}, quoted by "
    )
    makes = Sheet

    bending_stiffness: float = key(quantity("J", minimum=0.0), "bending stiffness κ of the sheet")
    tension: float = key(quantity("N/m", minimum=0.0), "tension σ of the sheet, the same in all directions", 0.0)
    foundation: float = key(quantity("Pa/m", minimum=0.0), "stiffness k of springs under the sheet", 0.0)

    def solid(self, material: MaterialSection) -> Sheet:
        try:
            return Sheet(material.contact_modulus, self.bending_stiffness, self.tension, self.foundation)
        except ValueError as error:
            raise InputError(f"elasticity: {error}") from None

    @classmethod
    def keys_from(cls, solid: Any, poissons_ratio: float) -> dict[str, Any]:
        return {name: getattr(solid, name) for name in ("bending_stiffness", "tension", "foundation")}


def _imported(name: str) -> tuple[Any, str]:
    try:
        return named(name)
    except ValueError as error:
        raise InputError(f"elasticity.object = {name!r}: {error}") from None


def _stiffness(name: str, wavenumber: np.ndarray) -> np.ndarray:
    """K(q) of a named function; InputError if it raises, or returns anything but positive numbers."""
    try:
        return FunctionSolid(1.0, _imported(name)[0]).stiffness(wavenumber)
    except Exception as error:  # whatever a stranger's function raises
        raise InputError(
            f"elasticity.object = {name!r}: its K(q) fails ({type(error).__name__}: {error}); it takes an array of "
            "wavenumbers and returns one stiffness for each"
        ) from None


def importable(found: Any) -> str:
    """The module and name of an object that a Python study gives; InputError if a dataset could not record it."""
    try:
        return name_of(found)
    except ValueError as error:
        what = getattr(found, "__name__", type(found).__name__)
        raise InputError(f"elasticity.object: {what} is given as an object, but {error}") from None


@dataclass(frozen=True, kw_only=True)
class PythonSection(ElasticitySection):
    """A solid that a Python module holds, with the content of that module when the study was read."""

    words = "of stiffness K(q) by {object}, quoted by "

    object: str = key(TEXT, "function K(q) in SI or Elasticity of an importable module, module:name")
    object_hash: str | None = key(TEXT, "SHA-256 of that module's file, which a study records itself", None)

    @classmethod
    def recorded(cls, table: Mapping[str, Any]) -> dict[str, Any]:
        """Return the keys with the hash of the module; InputError if it is another than they hold."""
        name = table.get("object")
        if isinstance(name, Elasticity) or callable(name):
            name = importable(name)
        if not isinstance(name, str):  # missing, or another mistake that binding names
            return dict(table)
        content = _imported(name)[1]
        if table.get("object_hash", content) != content:
            raise InputError(
                f"elasticity.object = {name!r}: its module is another than that of elasticity.object_hash; restore it, "
                "or leave the hash out and run the study again"
            )
        return {**table, "object": name, "object_hash": content}

    def solid(self, material: MaterialSection) -> Elasticity:
        found, content = _imported(self.object)
        if content != self.object_hash:
            raise InputError("elasticity.object: modules cannot be swept; name objects of one module")
        if not isinstance(found, Elasticity):
            return FunctionSolid(material.contact_modulus, partial(_stiffness, self.object))
        if abs(found.contact_modulus / material.contact_modulus - 1) > SAME_MODULUS:
            raise InputError(
                f"elasticity.object = {self.object!r}: its contact modulus is {found.contact_modulus:.6g} Pa, that of "
                f"[material] {material.contact_modulus:.6g} Pa; give the same"
            )
        return found


@dataclass(frozen=True, kw_only=True)
class TransverselyIsotropicSection(ElasticitySection):
    """A half-space stiffer or softer along its normal; the material's E and ν are those in the plane."""

    words = (
        "transversely isotropic, along the normal E = {axial_modulus}, ν = {axial_poissons_ratio}, shear modulus "
        "{axial_shear_modulus}, in the plane "
    )
    may_be_free = True

    axial_modulus: float = key(PASCALS, "Young's modulus along the normal of the surface")
    axial_poissons_ratio: float = key(
        quantity("1", minimum=-2.0, maximum=2.0), "contraction in the plane over extension along the normal"
    )
    axial_shear_modulus: float = key(PASCALS, "shear modulus between plane and normal")

    def solid(self, material: MaterialSection) -> HalfSpace:
        in_plane = material.youngs_modulus, material.poissons_ratio
        try:
            known = stiffnesses(*in_plane, self.axial_modulus, self.axial_poissons_ratio)
        except ValueError as error:
            raise InputError(
                f"elasticity.axial_poissons_ratio = {self.axial_poissons_ratio:g}: no solid has it beside these "
                f"moduli, {error}"
            ) from None
        return HalfSpace(material.combined(indentation_modulus(*known, self.axial_shear_modulus)))


@dataclass(frozen=True, kw_only=True)
class MeasuredSection(ElasticitySection):
    """Keys of a table, from a file whose numbers it becomes when the study is read."""

    words = "of tabulated stiffness K(q), quoted by "
    makes = Measured
    columns: ClassVar[dict[str, str]] = {"wavenumber": "m^-1", "stiffness": "Pa/m"}  # see tables.with_columns

    path: str | None = key(TEXT, "text table of wavenumber and stiffness K, relative to the study file", None)
    wavenumber_unit: str = key(TEXT, "unit of the wavenumbers in that table", "m^-1")
    stiffness_unit: str = key(TEXT, "unit of the stiffnesses in that table", "Pa/m")
    wavenumber: tuple[float, ...] | None = key(sequence(PER_METRE), "wavenumbers of the table, in place of path", None)
    stiffness: tuple[float, ...] | None = key(
        sequence(quantity("Pa/m", positive=True)), "stiffnesses at these wavenumbers, in place of path", None
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        keys.check_table(self, "elasticity", f'kind = "{self.kind}"')

    def solid(self, material: MaterialSection) -> Measured:
        try:
            return Measured(material.contact_modulus, self.wavenumber or (), self.stiffness or ())
        except ValueError as error:
            raise InputError(f"elasticity: the table of the stiffness {error}") from None

    @classmethod
    def keys_from(cls, solid: Any, poissons_ratio: float) -> dict[str, Any]:
        return {"wavenumber": solid.wavenumbers, "stiffness": solid.stiffnesses}


@dataclass(frozen=True, kw_only=True)
class ViscoelasticSection(ElasticitySection):
    """A half-space with the material's E after all time, and branches that relax."""

    words = "relaxing from branches of moduli {branch_youngs_moduli} in times {relaxation_times}, "
    makes = Viscoelastic

    branch_youngs_moduli: tuple[float, ...] = key(
        sequence(PASCALS), "Young's moduli E_i of the branches, beside material.youngs_modulus"
    )
    relaxation_times: tuple[float, ...] = key(sequence(SECONDS), "times τ_i in which the branches relax, one for each")

    def solid(self, material: MaterialSection) -> Viscoelastic:
        if len(self.branch_youngs_moduli) != len(self.relaxation_times):
            raise InputError(
                f"elasticity: {len(self.branch_youngs_moduli)} branch_youngs_moduli and {len(self.relaxation_times)} "
                "relaxation_times; give one of each for every branch"
            )
        plane_strain = 1 - material.poissons_ratio**2
        moduli = tuple(modulus / plane_strain for modulus in self.branch_youngs_moduli)
        try:
            return Viscoelastic(material.contact_modulus, moduli, self.relaxation_times)
        except ValueError as error:
            raise InputError(f"elasticity: {error}") from None

    @classmethod
    def keys_from(cls, solid: Any, poissons_ratio: float) -> dict[str, Any]:
        moduli = [modulus * (1 - poissons_ratio**2) for modulus in solid.branch_moduli]
        return {"branch_youngs_moduli": moduli, "relaxation_times": solid.relaxation_times}


ELASTICITIES = keys.TaggedUnion(
    "kind",
    {
        "half_space": HalfSpaceSection,
        "layer": LayerSection,
        "layered": LayeredSection,
        "plate": PlateSection,
        "sheet": SheetSection,
        "transversely_isotropic": TransverselyIsotropicSection,
        "tabulated": MeasuredSection,
        "python": PythonSection,
        "viscoelastic": ViscoelasticSection,
    },
)
register_solid = ELASTICITIES.register
