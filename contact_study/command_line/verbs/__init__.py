"""One file a verb of the program: its options and what it does."""
