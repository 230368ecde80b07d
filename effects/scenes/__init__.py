"""Things to light. No technique, no check."""
