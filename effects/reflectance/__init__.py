"""Techniques that evaluate reflectance: document 004's materials and what they are compared with."""
