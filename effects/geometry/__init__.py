"""Vectors, matrices, surfaces, views: no technique, no pass."""
