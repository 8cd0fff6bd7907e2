"""The plots of the README
========================

What the README plots of the paper's datasets, on a study of seconds: contact area over pressure, a map of gaps,
theories beside the continuum. The site offers this page as a notebook, too::

    python examples/plots_of_the_readme.py -o plots_of_the_readme.png
"""

import argparse
from importlib.resources import files

import matplotlib.pyplot as plt

import contact_study

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("-o", "--output", default="plots_of_the_readme.png", help="figure")
output = parser.parse_args().output

# %%
# The study is one of those that come with the package: ``bem-adhesion --example first``. What ``contact_study.run``
# gives is what ``xr.open_dataset`` reads of the file that the command writes.

study = str(files("contact_study") / "example_studies" / "first.toml")
bem = contact_study.run(study)
theory = contact_study.run(study, "theory")

# %%
# Contact area over pressure for each strength of adhesion, the map of gaps of one state, and the theories of another.

figure, (area, gaps, theories) = plt.subplots(1, 3, figsize=(12, 3.6), layout="constrained")
bem.relative_contact_area.plot.line(x="applied_pressure", hue="well_depth_ratio", marker="o", ax=area)

gap = bem.gap.sel(well_depth_ratio=4).isel(step=1)  # in metres
gap.plot(ax=gaps)

theory.relative_contact_area.sel(well_depth_ratio=1).plot.line(x="applied_pressure", hue="theory", ax=theories)
bem.relative_contact_area.sel(well_depth_ratio=1).plot.line("ko", x="applied_pressure", ax=theories)
figure.savefig(output, dpi=150)
