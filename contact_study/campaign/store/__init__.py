"""Files of a running campaign: one file a case, written so that no kill can tear it."""
