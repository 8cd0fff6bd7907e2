"""Studies of contact, the campaigns that run them and their datasets, shared by the three models.

:func:`run` runs a study, from a file or as nested mappings, and returns an :class:`xarray.Dataset`.
"""

import importlib
from typing import TYPE_CHECKING, Any

from contact_study.version import __version__

if TYPE_CHECKING:
    from contact_study.campaign.dataset.export import to_vtk, to_xyz
    from contact_study.campaign.library import run
    from contact_study.inference.library import infer
    from contact_study.inputs.errors import InputError
    from contact_study.physics.force_curves.curve import read_force_curve
    from contact_study.results.measured_spectrum import measured_spectrum
    from contact_study.results.schema import register_observable
    from contact_study.results.uncertainty import uncertainty
    from contact_study.study.case import realise
    from contact_study.study.schema.bodies import composite_surface
    from contact_study.study.schema.elasticity import register_solid
    from contact_study.study.schema.interaction import register_law
    from contact_study.study.schema.surface import register_surface
    from contact_study.study.study import make_study, read_study

__all__ = [
    "InputError",
    "__version__",
    "composite_surface",
    "infer",
    "make_study",
    "measured_spectrum",
    "read_force_curve",
    "read_study",
    "realise",
    "register_law",
    "register_observable",
    "register_solid",
    "register_surface",
    "run",
    "to_vtk",
    "to_xyz",
    "uncertainty",
]

_MODULES = {
    "InputError": "inputs.errors",
    "composite_surface": "study.schema.bodies",
    "infer": "inference.library",
    "make_study": "study.study",
    "read_force_curve": "physics.force_curves.curve",
    "measured_spectrum": "results.measured_spectrum",
    "read_study": "study.study",
    "realise": "study.case",
    "register_law": "study.schema.interaction",
    "register_observable": "results.schema",
    "register_solid": "study.schema.elasticity",
    "register_surface": "study.schema.surface",
    "run": "campaign.library",
    "to_vtk": "campaign.dataset.export",
    "to_xyz": "campaign.dataset.export",
    "uncertainty": "results.uncertainty",
}


def __getattr__(name: str) -> Any:
    # Imported on first use: the solvers need the numerics only, not files and datasets.
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{_MODULES[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
