"""The packages as a library: what they export, with examples that run."""

import doctest
import importlib
import importlib.resources
from functools import partial

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


@pytest.mark.parametrize("package", [*PACKAGES, "contact_study.plots"])
def test_what_is_exported_is_there_explained_and_offered(package):
    module = importlib.import_module(package)
    assert len(module.__all__) == len(set(module.__all__))
    for name in module.__all__:
        assert name == "__version__" or getattr(module, name).__doc__
    if package != "theory.references":
        assert dir(module) == sorted(module.__all__)
    assert "." in package or importlib.resources.files(package).joinpath("py.typed").is_file()


def test_every_solid_and_law_of_a_study_is_at_hand_from_python():
    solids = {name for name, of in vars(elasticity).items() if isinstance(of, type) and issubclass(of, Elasticity)}
    assert {"Layered", "Measured", "Tabulated"} < solids
    assert solids | {law.__name__ for law in LAWS.values()} <= set(bem_adhesion.__all__)


WITH_EXAMPLES = """
    bem_adhesion.contacts.rough_contact bem_adhesion.contacts.viscoelastic bem_adhesion.solution
    contact_study.physics.roughness.spectrum md_reference.solution md_reference.statics.contact
    theory.persson.theory theory.gap_flow.flow theory.edge_flow.flow theory.non_adhesive.corrections
"""


@pytest.mark.parametrize("module", WITH_EXAMPLES.split())
def test_examples_of_docstrings(module):
    found = doctest.testmod(importlib.import_module(module))
    assert found.attempted > 0
    assert found.failed == 0


def test_spectrum_of_a_height_array():
    found = spectrum_of(HEIGHT, (8e-9, 12e-9))
    assert found.rms_height == pytest.approx(HEIGHT.std(), rel=1e-12)
    np.testing.assert_array_equal(found.variances, radial_spectrum(HEIGHT, Grid((16, 24), (8e-9, 12e-9))).variances)
    assert spectrum_of(HEIGHT[:, :16].tolist(), 8e-9).limits == spectrum_of(HEIGHT[:, :16], (8e-9, 8e-9)).limits


@pytest.mark.parametrize(
    ("function", "arguments", "message"),
    [
        (spectrum_of, ("heights.npy", 1e-8), "height"),
        (spectrum_of, (np.full((4, 4), np.nan), 1e-8), "height is not finite"),
        (spectrum_of, (np.ones((4, 4)), 1e-8), "flat"),
        (spectrum_of, (HEIGHT, 0.0), "size"),
        (PerssonTheory, (spectrum_of(HEIGHT, 1e-8), 1e10, "0.1 J/m2"), "work_of_adhesion"),
        (partial(PerssonTheory, alpha=0.0), (spectrum_of(HEIGHT, 1e-8), 1e10, 0.1), "alpha"),
        (partial(PerssonTheory, nodes=np.nan), (spectrum_of(HEIGHT, 1e-8), 1e10, 0.1), "nodes"),
        (partial(PerssonTheory, true_area="hertz"), (spectrum_of(HEIGHT, 1e-8), 1e10, 0.1), "true_area"),
    ],
)
def test_bad_arguments_are_named(function, arguments, message):
    with pytest.raises(ValueError, match=message):
        function(*arguments)


def test_states_of_the_theories_at_a_pressure():
    spectrum = spectrum_of(HEIGHT, 1e-8)
    with pytest.raises(ValueError, match="pressure = nan"):
        PerssonTheory(spectrum, 93.7e9, 0.1).at_pressure(np.nan)
    flow = gap_flow(spectrum, 93.7e9, LennardJones104(0.1, 3.28e-10), gaps=200, scales=200)
    state = flow.at_pressure(1e9)
    assert state.mean_gap == flow.gap_at(1e9)
    assert state.pressure == pytest.approx(1e9, rel=1e-9)  # linear between the same nodes
    with pytest.raises(ValueError, match="pull-off"):
        flow.at_pressure(1.01 * flow.pull_off_pressure)
