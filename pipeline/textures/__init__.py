"""Textures: their images, and the words of memory that they come from."""
