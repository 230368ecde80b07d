"""The vector engine: the common states on explicit vectors, a band of rows at a time. Its bits are the
portable engine's.
"""
