"""Techniques of bump mapping."""
