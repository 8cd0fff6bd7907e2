"""The datasets of the models: opened, held against their studies and told apart."""
