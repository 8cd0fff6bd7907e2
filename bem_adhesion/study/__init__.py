"""Boundary elements as a campaign runs them: loading paths, checks, the command."""
