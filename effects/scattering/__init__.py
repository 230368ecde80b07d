"""Scattered light between the bumps of a height field, from visibility that is computed once.

Source: Heidrich, Daubert, Kautz, Seidel 2000.
"""
