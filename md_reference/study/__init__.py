"""The atomistic model of a study: its cases and the ways in which atoms follow a loading path, one file each."""
