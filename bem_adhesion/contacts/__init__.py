"""Contacts that a user steps through a load: rough, free boundaries, plastic, viscoelastic, overdamped."""
