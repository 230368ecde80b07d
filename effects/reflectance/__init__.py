"""Techniques that evaluate reflectance: document 004's materials, and the models to compare them with."""
