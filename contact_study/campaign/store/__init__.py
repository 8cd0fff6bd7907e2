"""Files of a running campaign: one file per case that survives a kill, and the formats of datasets."""
