"""Kinds of surface, one a file: what the study file says of each, its heights and its scales."""

from contact_study.physics.surfaces.file import MapFile
from contact_study.physics.surfaces.flat import Flat
from contact_study.physics.surfaces.self_affine import SelfAffine
from contact_study.physics.surfaces.sphere import Sphere
from contact_study.physics.surfaces.wavy import Wavy
from contact_study.study.schema.keys import TaggedUnion

SURFACES = TaggedUnion(
    "kind",
    {"self_affine": SelfAffine, "file": MapFile, "sphere": Sphere, "wavy": Wavy, "flat": Flat},
)
