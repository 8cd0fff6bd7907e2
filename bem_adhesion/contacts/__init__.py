"""Contacts that a user steps through a load: rough, with free boundaries, plastic, viscoelastic."""
