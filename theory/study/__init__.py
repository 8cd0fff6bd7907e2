"""The theories along the loading path of a case, as a campaign runs them, and the command ``persson-theory``."""
