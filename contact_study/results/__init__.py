"""What a model returns and what a dataset holds: states, observables and the schema of variables."""
