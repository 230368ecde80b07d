"""Programs of a pass: rules and normal forms of combiners, texture shaders, environments and fog."""
