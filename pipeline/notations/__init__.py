"""Notations of programs: register combiners, texture shaders and Direct3D's pixel shaders, read and
written.
"""
