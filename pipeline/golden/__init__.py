"""Digests of pictures, and of the versions that the pictures were computed with."""
