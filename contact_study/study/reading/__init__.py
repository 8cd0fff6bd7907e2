"""Numbers that a study takes from files and from overrides on the command line."""
