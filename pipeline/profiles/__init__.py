"""The machines, one module each."""

from pipeline.profiles.geforce_256 import GEFORCE_256
from pipeline.profiles.ideal import IDEAL

PROFILES = {"GEFORCE_256": GEFORCE_256, "IDEAL": IDEAL}
