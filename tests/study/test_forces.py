"""Forces on the whole cell as points of a loading path."""

import numpy as np
import pytest

from contact_study.inputs.errors import InputError
from contact_study.study.study import make_study

SPHERE = {
    "surface": {"kind": "sphere", "size": ["2 um", "3 um"], "shape": [20, 30], "radius": "9 um"},
    "material": {"youngs_modulus": "20 MPa", "poissons_ratio": 0.3},
    "interaction": {"law": "hard_wall"},
    "loading": {"path": ["12 nN", "0.3 uN"]},
}


def test_forces_are_shared_out_over_the_cell():
    case = make_study(SPHERE).cases[0]
    # 6e-12 m²; the quotient of two decimals, to rounding.
    np.testing.assert_allclose(case.loading.path, [2e3, 5e4], rtol=1e-14)
    name, size = case.loading.unit
    assert name == "nN"
    assert size == pytest.approx(1e-9 / 6e-12, rel=1e-14)

    cases = make_study({**SPHERE, "sweep": {"surface.size": ["2 um", "4 um"]}}).cases
    assert cases[0].loading.path[0] == pytest.approx(4 * cases[1].loading.path[0], rel=1e-14)


def test_a_map_brings_its_own_cell(tmp_path):
    np.save(tmp_path / "map.npy", np.random.default_rng(1).normal(size=(16, 16)) * 1e-9)
    surface = {"kind": "file", "path": "map.npy", "size": "2 um", "crop": [["0 um", "1 um"], ["0 um", "0.5 um"]]}
    case = make_study({**SPHERE, "surface": surface}, tmp_path).cases[0]
    assert case.loading.path[0] == pytest.approx(12e-9 / 0.5e-12, rel=1e-12)


@pytest.mark.parametrize(
    ("loading", "culprit"),
    [
        ({"path": ["12 nN", "2 MPa"]}, r"loading\.path\[1\] = '2 MPa'.*expected a number in N"),
        ({"path": ["12 nN"], "control": "gap"}, r"loading\.path\[0\] = '12 nN'.*expected a number in m"),
        ({"path": ["-12 nN"]}, r"-2000 Pa cannot be carried"),
    ],
)
def test_what_is_no_path_of_forces_is_named(loading, culprit):
    with pytest.raises(InputError, match=culprit):
        make_study({**SPHERE, "loading": loading})
