"""The marble that F004-6 and F004-7 show."""

# What the marble is made of: the keywords of ``material_textures.marble`` besides its size. F004-7 shows the
# textures of the same.
MARBLE = {
    "cells": 2,
    "width": 10.0,
    "relief": 1.5,
    "alpha_x": 0.5,
    "alpha_y": (0.3, 1.0),
    "k_s": 1.0,
    "light_color": (0.93, 0.88, 0.80),
    "dark_color": (0.20, 0.30, 0.27),
}
MAP_SIZE = 256
