"""All of the self-test's frames."""

from fixedpipe.pipeline.selftest.combiner_frames import COMBINER_FRAMES
from fixedpipe.pipeline.selftest.fragment_frames import FRAGMENT_FRAMES
from fixedpipe.pipeline.selftest.pixel_frames import PIXEL_FRAMES
from fixedpipe.pipeline.selftest.texture_frames import TEXTURE_FRAMES

FRAMES = (*COMBINER_FRAMES, *TEXTURE_FRAMES, *FRAGMENT_FRAMES, *PIXEL_FRAMES)
