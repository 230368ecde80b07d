"""The vocabulary in which techniques write their passes.

It has draws and blending, combiners, texture shaders, the encoding of textures and vertex colours, and copies
through pixel textures.
"""
