"""Texts of the time that can be read and written: register combiners, texture shaders, Direct3D's pixel shaders."""
