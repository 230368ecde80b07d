"""From a mesh to primitives in window coordinates."""
