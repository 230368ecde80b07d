"""Digests of what was drawn, and what drew it."""
