"""The machines, one module each."""

from pipeline.profiles.geforce_3 import GEFORCE_3
from pipeline.profiles.geforce_256 import GEFORCE_256
from pipeline.profiles.ideal import IDEAL
from pipeline.profiles.nv2a import NV2A

PROFILES = {"GEFORCE_256": GEFORCE_256, "GEFORCE_3": GEFORCE_3, "NV2A": NV2A, "IDEAL": IDEAL}
