"""Bins of the distributions: one set for a study, wide enough, with zero stress inside a bin."""

import numpy as np
import pytest

from contact_study.problem.bins import with_bins
from contact_study.problem.study import make_study
from tests.problem.test_study import changed


def bins_of(**keys):
    table = changed("output", **keys)
    table["sweep"] = {"interaction.well_depth_ratio": [1, 8]}
    study = with_bins(make_study(table))
    assert len({id(case.bins) for case in study.cases}) == 1
    return study.cases[0].bins, study.cases[-1]


def test_zero_stress_lies_in_the_middle_of_a_bin():
    bins, _ = bins_of()
    nearest = np.argmin(np.abs(bins.pressure))
    width = bins.pressure_edges[1] - bins.pressure_edges[0]
    assert abs(bins.pressure[nearest]) < 1e-9 * width  # rounding of edges of a hundred widths


def test_tension_of_the_strongest_law_fits():
    bins, strongest = bins_of()
    assert bins.pressure_edges[0] < -strongest.law.peak_tensile_stress
    assert bins.pressure_edges[-1] > 10e9
    assert bins.gap_edges[0] == 0.0


def test_given_ranges_are_kept():
    bins, _ = bins_of(pressure_range=["-1 GPa", "3 GPa"], pressure_bins=8, gap_range=["0 nm", "2 nm"], gap_bins=4)
    np.testing.assert_allclose(bins.pressure_edges, np.linspace(-1e9, 3e9, 9))
    assert bins.gap == pytest.approx([0.25e-9, 0.75e-9, 1.25e-9, 1.75e-9])
