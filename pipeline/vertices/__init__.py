"""The vertex stage: from a mesh to primitives in window coordinates."""
