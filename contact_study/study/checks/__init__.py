"""Doubts about a study that can be raised before it runs: ineffective keys, missing units, implausible values."""
