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
        in_millijoules = found.elastic_energy.pint.to("mJ/m^2").pint.dequantify()
        np.testing.assert_allclose(in_millijoules, 1e3 * dataset.elastic_energy, rtol=1e-12)
        assert (found.pressure_pdf * found.mean_pressure).pint.to("").pint.units == units.dimensionless
