"""The machines, by their keys. Each is a literal, or made from its ancestor."""

from fixedpipe.pipeline.profiles.future import FUTURE
from fixedpipe.pipeline.profiles.g400 import G400
from fixedpipe.pipeline.profiles.geforce_3 import GEFORCE_3
from fixedpipe.pipeline.profiles.geforce_256 import GEFORCE_256
from fixedpipe.pipeline.profiles.ideal import IDEAL
from fixedpipe.pipeline.profiles.infinite_reality import INFINITE_REALITY
from fixedpipe.pipeline.profiles.multitexture import MULTITEXTURE
from fixedpipe.pipeline.profiles.nv2a import NV2A
from fixedpipe.pipeline.profiles.octane import OCTANE
from fixedpipe.pipeline.profiles.opengl_1_2 import OPENGL_1_2, OPENGL_1_2_IMAGING
from fixedpipe.pipeline.profiles.schilling import SCHILLING
from fixedpipe.pipeline.profiles.texram import TEXRAM

PROFILES = {
    "OPENGL_1_2": OPENGL_1_2,
    "OPENGL_1_2_IMAGING": OPENGL_1_2_IMAGING,
    "MULTITEXTURE": MULTITEXTURE,
    "GEFORCE_256": GEFORCE_256,
    "GEFORCE_3": GEFORCE_3,
    "NV2A": NV2A,
    "OCTANE": OCTANE,
    "INFINITE_REALITY": INFINITE_REALITY,
    "G400": G400,
    "TEXRAM": TEXRAM,
    "SCHILLING": SCHILLING,
    "FUTURE": FUTURE,
    "IDEAL": IDEAL,
}

__all__ = ["PROFILES", *PROFILES]
