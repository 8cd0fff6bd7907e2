"""Traction-separation laws, one a file."""
