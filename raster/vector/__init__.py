"""The vector engine: the same bits on explicit vectors, a band of rows at a time; the common states."""
