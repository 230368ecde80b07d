"""What a program is: combiners, texture shaders, texture environments, fog. Its rules and its normal form."""
