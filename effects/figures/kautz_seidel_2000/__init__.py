"""Figures of document 004."""
