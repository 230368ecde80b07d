"""What a frame leaves in memory, and its copies."""
