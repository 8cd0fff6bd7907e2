"""The theories as a campaign runs them, and the command."""
