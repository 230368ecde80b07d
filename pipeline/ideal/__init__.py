"""The ideal: the same passes in real numbers. Its modules have the names of an engine's stages."""
