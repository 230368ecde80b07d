"""Techniques of texture filtering."""
