"""The driver of the column engine."""
