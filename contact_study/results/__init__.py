"""Results of a model and contents of a dataset: states, observables and the schema of variables."""
