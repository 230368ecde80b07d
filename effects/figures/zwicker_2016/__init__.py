"""Figures of document 003."""
