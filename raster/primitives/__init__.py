"""Geometry before any engine shades: vertices, clipping, triangles, strokes, bands of rows. No fragments."""
