"""Scenes and objects to light. No technique, no check."""
