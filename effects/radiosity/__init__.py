"""Diffuse light between surfaces, solved on the host and shown as light maps."""
