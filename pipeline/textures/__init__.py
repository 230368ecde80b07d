"""Texels as images and as words of memory."""
