"""The portable engine: plain loops, every state there is; a file for each stage, whose names the other engines repeat."""
