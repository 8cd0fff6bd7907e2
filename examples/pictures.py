"""Pictures of a dataset
=====================

A study from a table of keys, and pictures of what came out: contact area along the path, one state of the interface,
what a cycle of loading costs. Each is one call on the dataset::

    python examples/pictures.py -o pictures.png
"""

import argparse

import matplotlib.pyplot as plt

import contact_study
from contact_study import plots

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("-o", "--output", default="pictures.png", help="figure")
parser.add_argument("--points", type=int, default=192, help="points along each side")
given = parser.parse_args()

study = {
    "material": {"youngs_modulus": "3 GPa", "poissons_ratio": 0.3},
    "interaction": {"law": "lennard_jones_9_3", "length": "0.5 nm", "work_of_adhesion": "0.15 J/m^2"},
    "surface": {
        "kind": "self_affine",
        "size": ["200 nm", "200 nm"],
        "shape": [given.points, given.points],
        "hurst_exponent": 0.8,
        "rms_height": "3 nm",
        "cutoff_mode": 10,
    },
    "loading": {"path": "1 MPa, 2 MPa, 5 MPa, 10 MPa, 20 MPa, 40 MPa, 70 MPa, 100 MPa", "unload": True},
    "output": {"fields": True},
}
dataset = contact_study.run(study)
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
figure.savefig(given.output, dpi=150)
