"""Programs of a pass: the rules and the normal forms of combiners, texture shaders, environments and fog."""
