"""What dominates an uncertain pull-off
====================================

Modulus, work and range of adhesion and the roughness of a contact are known with errors. 32 draws give the interval of
each answer; bars show what each input does to it.
"""

import contact_study
from contact_study import plots

draws = 32
study = {
    "surface": {
        "kind": "self_affine",
        "size": "1 um",
        "shape": [64, 64],
        "rms_height": "5 nm",
        "roll_off_mode": 2,
        "cutoff_mode": 8,
    },
    "material": {"youngs_modulus": "50 MPa", "poissons_ratio": 0.49},
    "interaction": {"law": "exponential", "work_of_adhesion": "1 mJ/m^2", "length": "3 nm"},
    "loading": {"control": "gap", "path": ["20 nm", "8 nm", "5 nm"], "unload": True, "adaptive": True},
    "uncertainty": {
        "draws": draws,
        "material.youngs_modulus": {"distribution": "lognormal", "relative_error": 0.2},
        "interaction.work_of_adhesion": {"distribution": "lognormal", "relative_error": 0.25},
        "interaction.length": {"distribution": "uniform", "low": "2 nm", "high": "4 nm"},
        "surface.rms_height": {"distribution": "normal", "relative_error": 0.08},
    },
}
found = contact_study.uncertainty(contact_study.run(study))
low, middle, high = found.pull_off_pressure.values / 1e3
print(f"pull-off at {middle:.0f} kPa, 5 to 95 %: {low:.0f} to {high:.0f} kPa")
plots.tornado(found).savefig("uncertain_inputs.png", dpi=150)
