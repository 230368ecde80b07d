"""The words in which techniques write their passes: draws and blending, combiners, texture shaders, what is
stored in textures and vertex colours, and copies through pixel textures.
"""
