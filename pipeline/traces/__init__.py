"""Trace files of apitrace: bytes to calls and back, without any meaning of OpenGL."""
