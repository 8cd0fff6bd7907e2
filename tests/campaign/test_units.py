"""Units of a dataset read by pint, in the spelling of UDUNITS that CF asks for."""

import numpy as np
import pytest
import xarray as xr

from contact_study.results.schema import COORDINATES, VARIABLES
from tests.report.synthetic import write

units = pytest.importorskip("cf_xarray.units").units
pytest.importorskip("pint_xarray")


@pytest.mark.filterwarnings("ignore::pint.UnitStrippedWarning")  # of indices, which are kept as they are
def test_a_dataset_is_quantified_and_converted(tmp_path):
    for unit in {entry.units for entry in {**VARIABLES, **COORDINATES}.values()}:
        assert units.parse_units(unit) is not None
    with xr.open_dataset(write(tmp_path / "bem.nc", "continuum")) as dataset:
        found = dataset.pint.quantify(unit_registry=units)
        energy = found.elastic_energy
        assert energy.pint.units == units.parse_units("J/m^2")
        in_millijoules = energy.pint.to("mJ/m^2").pint.dequantify()
        np.testing.assert_allclose(in_millijoules, 1e3 * dataset.elastic_energy, rtol=1e-12)
        # Δγ/(E* h_rms) is a pure number.
        ratio = (found.work_of_adhesion / (found.contact_modulus * found.rms_height)).pint.to("")
        expected = dataset.work_of_adhesion / (dataset.contact_modulus * dataset.rms_height)
        np.testing.assert_allclose(ratio.pint.dequantify(), expected, rtol=1e-12)
        density = (found.pressure_pdf * found.mean_pressure).pint.to("")
        assert density.pint.units == units.dimensionless
