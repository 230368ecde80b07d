"""Other renderers that the scenes are measured against."""
