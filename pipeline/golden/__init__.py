"""Digests of pictures, and what the pictures were computed with."""
