import copy

import pytest

from contact_study.campaign.record import prepare_run
from contact_study.campaign.resume import match
from contact_study.inputs.errors import InputError
from contact_study.study.study import make_study
from tests.campaign.toy_model import TOY
from tests.campaign.toy_study import BASE, changed

REFUSED = [
    ({"surface": {"hurst_exponent": 0.7}}, "surface.hurst_exponent is 0.8 there and 0.7 here"),
    ({"material": {"youngs_modulus": "70 GPa"}}, "material.youngs_modulus is 7.72e+10 there and 7e+10 here"),
    (
        {"surface": {"hurst_exponent": 0.7, "seed": 3}, "solver": {"tolerance": 1e-6, "max_iterations": 9}},
        "surface.hurst_exponent is 0.8 there and 0.7 here, surface.seed is 1 there and 3 here, "
        "solver.tolerance is 1e-08 there and 1e-06 here, and 1 keys more differ",
    ),
    ({"sweep": {"interaction.well_depth_ratio": [1, 8]}}, "the study lacks the point well_depth_ratio = 4.0"),
    ({"sweep": {"interaction.well_depth_ratio": None}}, "interaction.well_depth_ratio is 4 there and 1 here"),
    ({"loading": {"path": ["0.1 GPa", "1 GPa"]}}, "loading.path at well_depth_ratio = 1.0"),
    ({"loading": {"path": ["0.1 GPa", "1.1 GPa", "2 GPa"]}}, "does not begin with the 3 points"),
]


def run(table):
    study = make_study(copy.deepcopy(table))
    return prepare_run(TOY, study)


def test_another_study_is_refused_and_its_keys_named():
    attributes = run(BASE).attributes
    for sections, words in REFUSED:
        with pytest.raises(InputError) as failure:
            match(attributes, run(changed(**sections)))
        assert words in str(failure.value)
        assert "\n" not in str(failure.value)
    with pytest.raises(InputError, match=r"loading\.unload is true there and false here"):
        match(run(changed(loading={"unload": True})).attributes, run(BASE))


@pytest.mark.parametrize("name", ["model", "version", "schema_version", "study_toml"])
def test_what_is_not_known_is_refused(name):
    attributes = run(BASE).attributes
    for other in ({**attributes, name: "another"}, {key: value for key, value in attributes.items() if key != name}):
        words = "its study is not one this version can read|does not hold the study" if name == "study_toml" else name
        with pytest.raises(InputError, match=words):
            match(other, run(BASE))


def test_names_of_cases_follow_from_their_numbers():
    names = run(BASE).case_names
    assert len(set(names)) == 2
    assert run(changed(study={"title": "t"}, surface={"size": "10 nm"}, solver={"threads": 2})).case_names == names
    assert run(changed(loading={"path": ["1 GPa"]})).case_names == names
    assert not set(run(changed(surface={"seed": 2})).case_names) & set(names)
    # Points of a sweep over what decides nothing are cases all the same.
    threads = changed(sweep={"interaction.well_depth_ratio": [1], "solver.threads": [1, 2], "theory.alpha": [1, 2]})
    assert len(set(run(threads).case_names)) == 4
    assert len(match(run(threads).attributes, run(threads))[1]) == 4


@pytest.mark.parametrize(
    ("first", "then", "stands"),
    [
        (["-40 GPa", "100 GPa"], ["-40 GPa", "100 GPa"], True),
        (["-40 GPa", "100 GPa"], ["-10 GPa", "90 GPa"], True),
        (["-40 GPa", "100 GPa"], ["-41 GPa", "100 GPa"], False),
        (["-40 GPa", "100 GPa"], ["-40 GPa", "101 GPa"], False),
        (["0 GPa", "1 GPa"], None, False),  # what lies outside was not counted
        (None, ["-1000 GPa", "1000 GPa"], True),  # nothing lay outside
    ],
)
def test_ranges_that_left_something_out(first, then, stands):
    gaps = [["0 nm", "2 nm"], ["0 nm", "1 nm"] if stands else ["0 nm", "3 nm"]]
    for key, ranges in (("pressure_range", (first, then)), ("gap_range", gaps)):
        one, two = (run(changed(output={key: chosen})) for chosen in ranges)
        matches = match(one.attributes, two)[1].values()
        assert [found.steps for found in matches] == ([3, 3] if stands else [0, 0])


def test_values_that_are_equal_but_for_a_rounding_match():
    for sizes, alike in (
        (("83.2 angstrom", 8.32e-9), True),  # in other units
        ((8.3200000000049e-9, 8.320000000005e-9), False),  # equal values may round to different names
    ):
        one, two = (run(changed(surface={"size": size, "rms_height": "0.1 nm"})) for size in sizes)
        assert one.study.cases[0].surface.size != two.study.cases[0].surface.size
        assert (one.case_names == two.case_names) == alike
        assert [found.steps for found in match(one.attributes, two)[1].values()] == [3, 3]


def test_points_that_differ_in_how_far_they_go():
    table = changed(sweep={"loading.unload": [False, True], "interaction.well_depth_ratio": None})
    _, matches = match(run(table).attributes, run(table))
    assert [matches[number].earlier for number in (0, 1)] == [0, 1]
    assert [matches[number].steps for number in (0, 1)] == [3, 5]
