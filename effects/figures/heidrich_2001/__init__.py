"""Figures of document 000."""
