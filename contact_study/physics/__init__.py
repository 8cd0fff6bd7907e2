"""What is in contact: adhesive laws, elastic solids, rough surfaces. Formulas, and nothing of a solver."""
