"""Figures of document 004, and of its techniques."""
