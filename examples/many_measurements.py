"""Three instruments, one power spectrum
=====================================

A stylus (100 µm), an atomic force (4 µm) and an electron microscope (120 nm) measure one surface. Their scans
become one spectrum with bounds, from which the theory takes the contact area and a simulation its surface.
"""

import numpy as np

import contact_study
from contact_study import plots

q = 2 * np.pi / np.array([400e-6, 20e-6, 0.2e-9])
np.savetxt("law.csv", np.stack([q, 3e-28 * (np.maximum(q, q[1]) / q[1]) ** -3.6], 1), header="q (1/m), C (m^4)")
solid = {"material": {"youngs_modulus": "1 GPa", "poissons_ratio": 0.3}, "interaction": {"law": "hard_wall"}}
solid |= {"loading": {"path": ["3 MPa"]}}


def scanned(size, seed, points=1024):
    """Return a quarter of a surface of the law, whose edges do not meet."""
    surface = {"kind": "spectrum", "spectrum_path": "law.csv", "size": size, "shape": [points, points], "seed": seed}
    case = contact_study.make_study({"surface": surface, **solid}).cases[0]
    return contact_study.realise(case).sampled[: points // 2, : points // 2]


for name, unit, width, scan in (("stylus", "um", 100, scanned(2e-4, 1)), ("microscope", "nm", 120, scanned(2.4e-7, 3))):
    columns = np.linspace(0, width, len(scan), endpoint=False), 1e9 * scan[0]
    np.savetxt(f"{name}.csv", np.stack(columns, 1), header=f"x ({unit}), height (nm)")
np.save("afm.npy", 1e9 * scanned(8e-6, 2))
keys = ["[[measurement]]", 'path = "afm.npy"', 'size = "4 um"', 'height_unit = "nm"', 'tip_radius = "10 nm"']
np.savetxt("list.toml", keys, fmt="%s")
spectrum = contact_study.measured_spectrum(["stylus.csv", "list.toml", "microscope.csv"])
spectrum.to_netcdf("psd.nc")
surface = {"spectrum_path": "psd.nc", "size": "1 um", "shape": [256, 256], "shortest_wave": "30 nm"}
solid["surface"] = {"kind": "spectrum", **surface}
area = [contact_study.run(solid, model).relative_contact_area.values.flat[0] for model in ("continuum", "theory")]
axes = plots.measured_spectra(spectrum)
axes.set_title(f"contact area at 3 MPa: {area[0]:.2f} simulated, {area[1]:.2f} by theory", fontsize=9)
axes.figure.savefig("many_measurements.png", dpi=150)
