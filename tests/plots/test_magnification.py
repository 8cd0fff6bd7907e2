"""Pictures of Persson's theory against magnification are checked by the data that they show."""

import numpy as np
import pytest
import xarray as xr

from contact_study import plots

WAVEVECTOR = 3e7 * np.array([1.0, 2.0, 4.0, 8.0])
ZETA = np.array([2.0, 4.0, 8.0])
STRESS = np.linspace(-2e9, 6e9, 17)


def dataset():
    """Two states whose numbers a test can foretell."""
    density = np.exp(-0.5 * ((STRESS[None, :] - 1e9) / (4e8 * ZETA[:, None])) ** 2) / ZETA[:, None] * 1e-9
    states = np.stack([density, 2 * density])
    curves = {
        "relative_contact_area_at": [[1.0, 0.8, 0.5, 0.2], [1.0, 0.9, 0.7, 0.4]],
        "detachment_stress": [[0.0, 0.0, 1e9, 3e9], [0.0, 1e9, 2e9, 4e9]],
        "effective_work_of_adhesion": [[-0.1, 0.1, 0.3, 0.7], [0.1, 0.2, 0.5, 1.4]],
    }
    return xr.Dataset(
        {name: (("step", "wavevector"), values) for name, values in curves.items()}
        | {"pressure_pdf_at": (("step", "magnification", "pressure_bin"), states)},
        {"wavevector": WAVEVECTOR, "magnification": ZETA, "pressure_bin": STRESS, "step": [0, 1]},
    )


@pytest.mark.parametrize(
    ("draw", "name", "unit", "words"),
    [
        (plots.area_by_magnification, "relative_contact_area_at", 1, "$A(\\zeta)/A_0$"),
        (plots.detachment_stress, "detachment_stress", 1e9, "(GPa)"),
        (plots.effective_work_of_adhesion, "effective_work_of_adhesion", 1, "(J/m²)"),
    ],
)
def test_curves_are_over_the_magnification_in_their_units(draw, name, unit, words):
    axes = draw(dataset())
    lines = [line for line in axes.lines if len(line.get_xdata()) == 4]
    assert [line.get_label() for line in lines] == ["step = 0", "step = 1"]
    for number, line in enumerate(lines):
        np.testing.assert_allclose(line.get_xdata(), [1, 2, 4, 8])
        np.testing.assert_allclose(line.get_ydata(), dataset()[name][number] / unit)
    assert axes.get_ylabel().endswith(words)
    assert axes.get_xscale() == "log"


def test_small_works_of_adhesion_are_in_millijoules():
    axes = plots.effective_work_of_adhesion(dataset().isel(step=0) * 1e-3)
    assert axes.get_ylabel().endswith("(mJ/m²)")
    assert axes.lines[0].get_ydata()[-1] == pytest.approx(0.7)
    assert list(axes.lines[1].get_ydata()) == [0, 0], "zero is marked where the energy changes its sign"


def test_map_shows_the_density_at_its_stress_and_magnification():
    state = dataset().isel(step=1)
    axes = plots.stress_by_magnification(state)
    mesh = axes.collections[0]
    shown = mesh.get_array()
    across, along = mesh.get_coordinates()[0, :, 0], mesh.get_coordinates()[:, 0, 1]
    assert across[-1] == ZETA[-1]
    assert np.all((across[:-1] < ZETA) & (across[1:] >= ZETA))
    density = state["pressure_pdf_at"].values.T * 1e9  # stress upwards, in 1/GPa
    peak = density.max()
    for row in range(shown.shape[0]):
        stress = 0.5 * (along[row] + along[row + 1])
        expected = density[np.argmin(abs(STRESS / 1e9 - stress))]
        np.testing.assert_allclose(shown[row].filled(0), np.where(expected > 1e-4 * peak, expected, 0))
    assert shown.mask.any()
    assert axes.get_ylabel() == r"stress $\sigma$ (GPa)"
    assert "1/GPa" in mesh.colorbar.ax.get_ylabel()


def test_states_without_a_map_are_refused():
    with pytest.raises(ValueError, match=r"theory\.magnifications = 48"):
        plots.stress_by_magnification(dataset().drop_vars("pressure_pdf_at"))
    with pytest.raises(ValueError, match="more than one state: select one along 'step'"):
        plots.stress_by_magnification(dataset())
    with pytest.raises(ValueError, match="nothing is in contact"):
        plots.stress_by_magnification(dataset().isel(step=0) * 0)
