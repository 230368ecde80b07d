"""Readers and writers of program notations: register combiners, texture shaders, Direct3D's pixel shaders."""
