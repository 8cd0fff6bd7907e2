"""Studies: sections and keys, reading, the sweep and its cases, and checks before any work starts."""
