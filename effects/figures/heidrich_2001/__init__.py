"""Figures of document 000, and of its techniques."""
