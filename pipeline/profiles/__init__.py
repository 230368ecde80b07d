"""The machines, by their keys: each is a module, or shares its family's."""

from fixedpipe.pipeline.profiles.future import FUTURE
from fixedpipe.pipeline.profiles.geforce_3 import GEFORCE_3
from fixedpipe.pipeline.profiles.geforce_256 import GEFORCE_256
from fixedpipe.pipeline.profiles.ideal import IDEAL
from fixedpipe.pipeline.profiles.multitexture import G400, MULTITEXTURE, TEXRAM
from fixedpipe.pipeline.profiles.nv2a import NV2A
from fixedpipe.pipeline.profiles.opengl_1_2 import OPENGL_1_2, OPENGL_1_2_IMAGING
from fixedpipe.pipeline.profiles.silicon_graphics import INFINITE_REALITY, OCTANE

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
    "FUTURE": FUTURE,
    "IDEAL": IDEAL,
}
