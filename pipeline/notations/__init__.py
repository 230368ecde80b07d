"""Notations of programs: register combiners and texture shaders, read and written; Direct3D's pixel shaders,
read.
"""
