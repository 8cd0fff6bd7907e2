"""Compiled passes of the local interaction: adhesive laws, walls, windows and springs."""
