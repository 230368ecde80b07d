"""Memory that frames write: framebuffers, their copies in textures, and a frame's Result."""
