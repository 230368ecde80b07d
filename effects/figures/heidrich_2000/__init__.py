"""Figures of document 002, and of its techniques."""
