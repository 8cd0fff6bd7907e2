"""The atomistic model of a study: its cases and the methods by which atoms follow a loading path."""
