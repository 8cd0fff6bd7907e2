import pytest

from contact_study.study.checks.idle_keys import idle_motion
from contact_study.study.study import make_study
from tests.study.test_plausibility import table_of

FLOW = 'atomistic.method or solver.path = "overdamped"'


@pytest.mark.parametrize(
    ("section", "keys", "chosen", "belongs"),
    [
        ("overdamped", {"loading_rate": 1e-2}, {"atomistic": {"method": "overdamped"}}, FLOW),
        ("overdamped", {"loading_rate": 1e-2}, {"solver": {"path": "overdamped"}}, FLOW),
        ("sampling", {"trajectories": 20}, {"atomistic": {"method": "sampling"}}, 'atomistic.method = "sampling"'),
        (
            "dynamics",
            {"duration": "1 ps", "frames": 5},
            {"atomistic": {"method": "dynamics"}},
            'atomistic.method = "dynamics"',
        ),
    ],
)
def test_keys_of_a_way_of_motion_that_is_not_gone_are_said(section, keys, chosen, belongs):
    (note,) = idle_motion(make_study(table_of(**{section: keys})).cases)
    assert note == f"{', '.join(f'{section}.{name}' for name in keys)}: without effect; it belongs to {belongs}"
    assert idle_motion(make_study(table_of(**{section: keys}, **chosen)).cases) == []


def test_keys_of_each_way_of_motion_in_a_sweep_have_an_effect():
    table = table_of(sampling={"trajectories": 20}, dynamics={"duration": "1 ps"})
    table["sweep"] = {"atomistic.method": ["sampling", "dynamics"]}
    assert idle_motion(make_study(table).cases) == []
