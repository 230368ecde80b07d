"""Validation: what a machine refuses, and why. A module for each section of a state, and the walk over
commands.
"""
