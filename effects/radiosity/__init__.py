"""Diffuse light that surfaces send each other, solved on the host and shown as light maps."""
