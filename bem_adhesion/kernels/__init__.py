"""Local energy of the interface: adhesive laws, walls, windows and springs, by loops over the points."""
