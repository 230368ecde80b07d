"""Figures of document 001, and of its techniques."""
