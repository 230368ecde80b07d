"""Figures of document 003, and of its techniques."""
