"""Techniques of volumes."""
