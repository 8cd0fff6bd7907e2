"""Sentences, captions, tables and the report that holds them."""
