"""Pictures of a dataset
=====================

Each picture of a dataset is one call of ``contact_study.plots``. The figure shows one state of a loading path as maps
and as a section, and the whole path as contact area and as a loop.
"""

import matplotlib.pyplot as plt

from contact_study import plots, run

study = {
    "material": {"youngs_modulus": "3 GPa", "poissons_ratio": 0.3},
    "interaction": {"law": "lennard_jones_9_3", "length": "0.5 nm", "work_of_adhesion": "0.15 J/m^2"},
    "surface": {
        "kind": "self_affine",
        "size": "200 nm",
        "shape": [192, 192],
        "rms_height": "3 nm",
        "cutoff_mode": 10,
    },
    "loading": {"path": "1 MPa, 2 MPa, 5 MPa, 10 MPa, 20 MPa, 40 MPa, 70 MPa, 100 MPa", "unload": True},
    "output": {"fields": True},
}
dataset = run(study)
state = dataset.isel(step=2)

figure = plt.figure(figsize=(11, 8.5), layout="constrained")
axes = figure.subplot_mosaic([["gap", "pressure", "contact"], ["section"] * 3, ["area", "loop", "spectrum"]])
plots.gap_map(state, axes["gap"])
plots.pressure_map(state, axes["pressure"])
plots.contact_map(state, axes["contact"])
plots.section(state, axes=axes["section"])
plots.contact_area(dataset, axes["area"])
plots.hysteresis_loop(dataset, axes["loop"])
plots.surface_spectrum(dataset, axes["spectrum"])
figure.savefig("pictures.png", dpi=150)
