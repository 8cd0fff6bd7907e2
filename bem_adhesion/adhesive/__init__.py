"""Adhesive contact by Newton's method over several grids."""
