"""Techniques of environment maps."""
