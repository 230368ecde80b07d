"""Drawn diagrams: lines, letters, geometry of the plane."""
