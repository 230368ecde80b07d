"""Pictures of a user's own data: photographs as bumps, meshes with shadows, volumes."""
