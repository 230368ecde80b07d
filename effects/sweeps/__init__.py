"""Sweeps: a figure, a study or a script at every point of a grid of machines, bits and parameters."""
