"""Sections and keys of the study file, each section a frozen dataclass, and the physics that they make."""
