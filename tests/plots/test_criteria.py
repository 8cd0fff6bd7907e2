"""The map of criteria is checked by what it plots."""

import numpy as np
import pytest
import xarray as xr

from contact_study import plots

RATIOS = {
    "persson_tosatti_ratio": [0.1, 0.5],
    "pastewka_robbins_ratio": [0.2, 0.7],
    "dmt_tension_ratio": [0.9, 4.0],
    "bearing_area_ratio": [0.4, 3.0],
}


def dataset():
    columns = {"finest_tabor_number": [0.3, 2.0], **RATIOS}
    return xr.Dataset(
        {name: ("well_depth_ratio", values) for name, values in columns.items()}, {"well_depth_ratio": [1.0, 8.0]}
    )


def test_every_point_of_the_sweep_is_a_column_of_all_criteria():
    axes = plots.criteria_map(dataset(), name="study")
    markers = [line for line in axes.lines if line.get_marker() in "s^Do" and len(line.get_xdata()) == 1]
    shown = np.array([line.get_xydata()[0] for line in markers])
    expected = [[tabor, RATIOS[name][column]] for column, tabor in enumerate((0.3, 2.0)) for name in RATIOS]
    np.testing.assert_allclose(shown, expected)
    # Persson and Tosatti's is made for large Tabor parameters, the others for small ones.
    hollow = [line.get_markerfacecolor() == "white" for line in markers]
    assert hollow == [True, False, False, False, False, True, True, True]
    assert [text.get_text() for text in axes.texts][-2:] == [f"study\nwell depth ratio = {k}" for k in (1, 8)]
    low, high = axes.get_ylim()
    assert low < 0.1 < 4 < high
    assert 1 in axes.lines[0].get_ydata()
    assert axes.get_xscale() == axes.get_yscale() == "log"
    plots.criteria_map(dataset().isel(well_depth_ratio=1), axes, "one")  # on the same map
    assert len(axes.get_legend_handles_labels()[1]) == 4
    assert axes.texts[-1].get_text() == "one"
    with pytest.raises(ValueError, match="persson_tosatti_ratio"):
        plots.criteria_map(dataset().drop_vars("persson_tosatti_ratio"))
