"""What a machine refuses, and why: a module for each section of a state, and the walk over commands."""
