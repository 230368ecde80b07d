"""Techniques of shadows."""
