"""The question, in SI units: study, surface and traction-separation law."""
