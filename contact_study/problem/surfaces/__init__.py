"""Kinds of surface, one a file: what the study file says of each, its heights and its scales."""

from contact_study.problem.keys import Kinds
from contact_study.problem.surfaces.file import MapFile
from contact_study.problem.surfaces.flat import Flat
from contact_study.problem.surfaces.self_affine import SelfAffine
from contact_study.problem.surfaces.sphere import Sphere
from contact_study.problem.surfaces.wavy import Wavy

SURFACES = Kinds(
    "kind",
    {"self_affine": SelfAffine, "file": MapFile, "sphere": Sphere, "wavy": Wavy, "flat": Flat},
)
