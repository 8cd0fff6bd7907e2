"""Contact with a hard wall by active sets, elastic or with a hardness: convex problems with one solution."""
