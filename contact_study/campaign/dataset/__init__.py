"""The one dataset of a study: assembled, described, written, and read again."""
