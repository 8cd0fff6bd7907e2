"""Going on from an earlier run: what decides the numbers of a step, and what of it stands."""
