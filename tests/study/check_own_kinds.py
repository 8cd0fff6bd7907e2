"""Run by test_plugins with a study where the plug-in is installed: its law, its keys, names that are taken."""

import sys
import tomllib

import pytest
from own_kinds import LARGEST_GAP, OwnInteraction, OwnMorse, RidgeSection

import contact_study
from contact_study import start
from contact_study.inputs.errors import InputError
from contact_study.results.state import Observable


def check(study):
    assert len(contact_study.make_study(study).cases) == 4
    for changes, words in (
        ({"law": "lennard_jones_10_4"}, 'interaction.width: law = "lennard_jones_10_4" has no such key'),
        ({"width": None}, 'missing key interaction.width: law = "own_morse" needs it'),
    ):
        asked = {name: value for name, value in {**study["interaction"], **changes}.items() if value is not None}
        with pytest.raises(InputError, match=words):
            contact_study.make_study({**study, "interaction": asked, "sweep": {}})

    contact_study.register_law("own_morse", OwnMorse, OwnInteraction)  # again
    contact_study.register_observable(LARGEST_GAP)
    for register, arguments in (
        (contact_study.register_law, ("morse", OwnMorse, OwnInteraction)),
        (contact_study.register_surface, ("sphere", RidgeSection)),
        (contact_study.register_observable, (Observable(LARGEST_GAP.variables, dict),)),
    ):
        with pytest.raises(ValueError, match=r"is a variable already|give another name"):
            register(*arguments)

    dataset = contact_study.run(study, workers=2)
    assert (dataset.sizes["stiffening"], dataset.sizes["width"]) == (2, 2)
    assert (dataset.contact_modulus[1] == 2 * dataset.contact_modulus[0]).all()
    assert dataset.converged.all()
    assert (dataset.largest_gap > dataset.mean_gap).all()
    assert dataset.largest_gap.attrs["units"] == "m"


if __name__ == "__main__":
    check(tomllib.loads(sys.argv[1]))
    for section in ("interaction", "surface", "elasticity"):
        start.bem_adhesion(["keys", section])
