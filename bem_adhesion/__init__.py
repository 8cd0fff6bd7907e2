"""Boundary-element solver of the adhesive contact of an elastic half-space with a rough rigid solid."""
