"""Analytic theories of rough adhesive contact: Persson 2008 and gap flow."""
