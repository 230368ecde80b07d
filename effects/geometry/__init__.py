"""Vectors, matrices, surfaces, views: no state, no pass."""
