"""The elastic block of atoms: condensed to its surface, or explicit and coarsened with depth."""
