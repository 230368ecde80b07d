"""Acceptance of pictures: checks and measures, rays as the truth, and agreement with them."""
