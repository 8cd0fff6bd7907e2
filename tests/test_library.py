"""The packages as a library: what they export, with examples that run."""

import doctest
import importlib
import importlib.resources

import numpy as np
import pytest

import bem_adhesion
from bem_adhesion import Elasticity
from contact_study.numerics.grid import Grid
from contact_study.physics import solids as elasticity
from contact_study.physics.laws import LAWS
from contact_study.physics.roughness.spectrum import radial_spectrum
from theory import LennardJones104, PerssonTheory, gap_flow, spectrum_of

PACKAGES = ("contact_study", "bem_adhesion", "md_reference", "theory", "theory.references")
HEIGHT = 5e-10 * np.random.default_rng(0).standard_normal((16, 24))


@pytest.mark.parametrize("package", [*PACKAGES[:-1], "contact_study.plots"])
def test_completion_offers_what_is_public(package):
    module = importlib.import_module(package)
    assert dir(module) == sorted(module.__all__)


@pytest.mark.parametrize("package", PACKAGES[:-1])
def test_packages_are_marked_as_typed(package):
    assert importlib.resources.files(package).joinpath("py.typed").is_file()


@pytest.mark.parametrize("package", PACKAGES)
def test_what_is_exported_is_there_and_explained(package):
    module = importlib.import_module(package)
    assert len(module.__all__) == len(set(module.__all__))
    for name in module.__all__:
        assert hasattr(module, name)
        assert name == "__version__" or getattr(module, name).__doc__


def test_every_solid_and_law_of_a_study_is_at_hand_from_python():
    solids = {name for name, of in vars(elasticity).items() if isinstance(of, type) and issubclass(of, Elasticity)}
    assert {"Layered", "Measured", "Tabulated"} < solids
    assert solids | {law.__name__ for law in LAWS.values()} <= set(bem_adhesion.__all__)


@pytest.mark.parametrize(
    "module",
    [
        "bem_adhesion.contacts.rough_contact",
        "contact_study.physics.roughness.spectrum",
        "md_reference.solution",
        "bem_adhesion.contacts.viscoelastic",
        "bem_adhesion.solution",
        "md_reference.statics.contact",
        "theory.persson.theory",
        "theory.gap_flow.flow",
        "theory.edge_flow.flow",
        "theory.non_adhesive.corrections",
    ],
)
def test_examples_of_docstrings(module):
    found = doctest.testmod(importlib.import_module(module))
    assert found.attempted > 0
    assert found.failed == 0


def test_spectrum_of_a_height_array():
    size = (8e-9, 12e-9)
    found = spectrum_of(HEIGHT, size)
    assert found.rms_height == pytest.approx(HEIGHT.std(), rel=1e-12)
    same = radial_spectrum(HEIGHT, Grid((16, 24), size))
    np.testing.assert_array_equal(found.variances, same.variances)
    assert spectrum_of(HEIGHT[:, :16].tolist(), 8e-9).limits == spectrum_of(HEIGHT[:, :16], (8e-9, 8e-9)).limits


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("heights.npy", 1e-8), "height"),
        ((np.full((4, 4), np.nan), 1e-8), "height is not finite"),
        ((np.ones((4, 4)), 1e-8), "flat"),
        ((HEIGHT, "10 nm"), "size"),
        ((HEIGHT, 0.0), "size"),
    ],
)
def test_bad_heights_are_named(arguments, message):
    with pytest.raises(ValueError, match=message):
        spectrum_of(*arguments)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"work_of_adhesion": -0.1}, "work_of_adhesion"),
        ({"work_of_adhesion": "0.1 J/m2"}, "work_of_adhesion"),
        ({"alpha": 0.0}, "alpha"),
        ({"nodes": np.nan}, "nodes"),
        ({"true_area": "hertz"}, "true_area"),
    ],
)
def test_bad_choices_of_perssons_theory_are_named(arguments, message):
    with pytest.raises(ValueError, match=message):
        PerssonTheory(
            **{"spectrum": spectrum_of(HEIGHT, 1e-8), "elasticity": 1e10, "work_of_adhesion": 0.1} | arguments
        )


def test_states_of_the_theories_at_a_pressure():
    spectrum = spectrum_of(HEIGHT, 1e-8)
    persson = PerssonTheory(spectrum, 93.7e9, 0.1)
    np.testing.assert_array_equal(persson.at_pressure(1e9).contact, persson.at_pressure(1e9, "adhered").contact)
    with pytest.raises(ValueError, match="pressure = nan"):
        persson.at_pressure(np.nan)
    flow = gap_flow(spectrum, 93.7e9, LennardJones104(0.1, 3.28e-10), gaps=200, scales=200)
    state = flow.at_pressure(1e9)
    assert state.mean_gap == flow.gap_at(1e9)
    assert state.pressure == pytest.approx(1e9, rel=1e-9)  # linear between the same nodes
    with pytest.raises(ValueError, match="pull-off"):
        flow.at_pressure(1.01 * flow.pull_off_pressure)
