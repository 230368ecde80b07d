"""The sources: C99, written by hand, and GLSL, made of it by ``tests/emulators/glsl.py``."""

from pathlib import Path

FOLDER = Path(__file__).parent
# The parts of the chip, each behind what it needs: nv2a_STAGE.h and nv2a_STAGE.glsl.
STAGES = (
    *("numbers", "vertex_programs", "lighting_unit", "rasterization", "depth", "texels", "textures"),
    *("texture_shaders", "combiners", "fog", "fragments", "blending"),
)
