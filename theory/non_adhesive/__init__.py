"""Persson's theory without adhesion: closed forms, corrections of its diffusion, distribution of the gap."""
