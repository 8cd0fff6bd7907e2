"""Persson's theory without adhesion: closed forms, corrections, distribution of the gap."""
