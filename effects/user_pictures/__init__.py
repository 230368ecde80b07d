"""Pictures of what a user brings: photographs as bumps, meshes with shadows, volumes."""
