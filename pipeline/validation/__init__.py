"""Validation: what a machine refuses, and why.

Each section of a state has a module. ``walk`` and ``validate`` go through the commands of a frame.
"""
