"""Reads and writes trace files of apitrace: bytes to calls and back, without what calls mean in OpenGL."""
