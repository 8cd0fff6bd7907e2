"""Run by test_plugins with a study where the plug-in is installed: its law, its keys, names that are taken."""

import sys
import tomllib

import pytest
from own_kinds import LARGEST_GAP, OwnInteraction, OwnMorse, RidgeSection

import contact_study
from contact_study import start
from contact_study.inputs.errors import InputError
from contact_study.results.state import Observable

if __name__ == "__main__":
    study = tomllib.loads(sys.argv[1])
    other = {**study["interaction"], "law": "lennard_jones_10_4"}
    with pytest.raises(InputError, match=r'interaction\.width: law = "lennard_jones_10_4" has no such key'):
        contact_study.make_study({**study, "interaction": other, "sweep": {}})
    contact_study.register_law("own_morse", OwnMorse, OwnInteraction)  # again
    contact_study.register_observable(LARGEST_GAP)
    for register, arguments in (
        (contact_study.register_law, ("morse", OwnMorse, OwnInteraction)),
        (contact_study.register_surface, ("sphere", RidgeSection)),
        (contact_study.register_observable, (Observable(LARGEST_GAP.variables, dict),)),
    ):
        with pytest.raises(ValueError, match=r"is a variable already|give another name"):
            register(*arguments)
    (case, *_) = contact_study.make_study(study).cases
    assert case.surface.path == "ridges.txt", "a key of this name"
    assert not case.height_maps, "is no height map"
    strong = {"law": "strong_morse", "length": "3.28 angstrom", "width": "2 angstrom", "strength": "1 GPa"}
    (case,) = contact_study.make_study({**study, "interaction": strong, "sweep": {}}).cases
    assert case.law.work_of_adhesion == 1e9 * 3.28e-10
    dataset = contact_study.run(study, workers=2)
    assert (dataset.sizes["stiffening"], dataset.sizes["width"]) == (2, 2)
    assert (dataset.contact_modulus[1] == 2 * dataset.contact_modulus[0]).all()
    assert dataset.converged.all()
    assert (dataset.largest_gap > dataset.mean_gap).all()
    for section in ("interaction", "surface", "elasticity"):
        start.bem_adhesion(["keys", section])
