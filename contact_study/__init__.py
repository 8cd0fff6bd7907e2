"""What is asked, how it is run and what came out: shared by the three models, with no solver in it."""

__version__ = "0.1.0"
