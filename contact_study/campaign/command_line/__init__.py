"""The command line that the three models share."""
