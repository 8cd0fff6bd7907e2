"""Laws and solids as objects in a study: the keys of its sections that make them again."""

from collections.abc import Mapping
from typing import Any

from contact_study.inputs.errors import InputError
from contact_study.physics.laws import LAWS, TractionLaw
from contact_study.physics.solids import Elasticity
from contact_study.study.schema.elasticity import ELASTICITIES
from contact_study.study.schema.interaction import INTERACTIONS
from contact_study.study.schema.sections import POISSONS_RATIO


def with_keys(study: Mapping[str, Any]) -> dict[str, Any]:
    """Replace laws and solids among the sections of a study by keys.

    ``interaction``, or its ``law``, may be a :class:`TractionLaw`; ``elasticity``, or its ``kind``, an
    :class:`Elasticity`, whose contact modulus then is the material's.
    """
    found = dict(study)
    law, beside = _object(found.get("interaction"), "law", TractionLaw)
    if law is not None:
        found["interaction"] = _joined("interaction", _keys_of_law(law), beside)
    solid, beside = _object(found.get("elasticity"), "kind", Elasticity)
    if solid is not None:
        material = found.get("material", {})
        if "youngs_modulus" in material:
            raise InputError("material.youngs_modulus: elasticity is an object with its modulus; leave it out")
        for name in ("youngs_modulus", "poissons_ratio"):
            if f"material.{name}" in found.get("sweep", {}):
                raise InputError(f"sweep.material.{name}: elasticity is an object of one material")
        constants = _constants(solid, material)
        found["elasticity"] = _joined("elasticity", _keys_of_solid(solid, constants["poissons_ratio"]), beside)
        found["material"] = {**material, **constants}
    return found


def _object(section: Any, tag: str, kind: type) -> tuple[Any, dict[str, Any]]:
    """The object that a section is, or names, and the keys beside it; None without one."""
    if isinstance(section, Mapping) and isinstance(section.get(tag), kind):
        return section[tag], {name: value for name, value in section.items() if name != tag}
    return section if isinstance(section, kind) else None, {}


def _joined(section: str, own: Mapping[str, Any], beside: Mapping[str, Any]) -> dict[str, Any]:
    if twice := [name for name in beside if name in own]:
        raise InputError(f"{section}.{twice[0]}: the object in this section has its own; leave it out")
    return {**own, **beside}


def _keys_of_law(law: TractionLaw) -> dict[str, Any]:
    for name, known in LAWS.items():
        if type(law) is known:
            return {"law": name, **INTERACTIONS.declared[name].keys_from(law)}
    raise InputError(
        f"interaction: {type(law).__name__} is no law of a study; pass TabulatedLaw.through(gaps, law.traction(gaps))"
    )


def _keys_of_solid(solid: Elasticity, poissons_ratio: float) -> dict[str, Any]:
    for kind, section in ELASTICITIES.declared.items():
        if section.makes is type(solid):
            return {"kind": kind, **section.keys_from(solid, poissons_ratio)}
    raise InputError(f"elasticity: no keys of a study make a {type(solid).__name__}; use rough_contact")


def _constants(solid: Elasticity, material: Mapping[str, Any]) -> dict[str, float]:
    """E and ν of a solid, ν its own or the material's."""
    given, ratio = material.get("poissons_ratio"), getattr(solid, "poissons_ratio", None)
    if given is not None:
        said = POISSONS_RATIO[0](given, "material.poissons_ratio")
        if ratio not in (None, said):
            raise InputError(f"material.poissons_ratio = {given!r}: the solid's is {ratio:g}; leave it out")
        ratio = said
    if ratio is None:
        raise InputError(f"missing key material.poissons_ratio: {type(solid).__name__} has a contact modulus alone")
    return {"youngs_modulus": solid.contact_modulus * (1 - ratio**2), "poissons_ratio": ratio}
