"""Adhesive contact, and walls with attraction, by Newton's method over several grids."""
