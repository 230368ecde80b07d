"""Draw scene c at 2048 x 2048 pixels with two textures of that size and print the process's peak, in bytes.

Run as ``python -m bench.largest_frame THREADS``.
"""

import sys

import numpy as np

from bench.scenes import SCENES
from bench.textures import TEXTURES
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.textures.images import texture_2d

EDGE = 2048


def peak_resident_bytes(status="/proc/self/status"):
    """The most that has been resident of this process. Raises OSError where there is no such file.

    Not getrusage's maximum, which also counts what the process was before it became Python's.
    """
    with open(status) as lines:
        for line in lines:
            if line.startswith("VmHWM:"):
                return 1024 * int(line.split()[1])  # Source: proc(5); "kB" are 1024 bytes
    raise OSError(f"{status} has no VmHWM.")


def draw(threads, edge=EDGE):
    """Draw the frame on ``threads`` threads."""
    scene = SCENES["c"]
    machine = Machine(scene.profile, edge, edge, threads=threads)
    for unit in scene.draw(edge).state.texture_units:
        texels = TEXTURES[unit.texture]().levels[0][0]
        repeats = edge // texels.shape[0]
        image = texture_2d(np.tile(texels, (repeats, repeats, 1)))
        machine.run([TexImage(label=unit.texture, texture=unit.texture, image=image)])
    machine.run(scene.frame(edge, 1))


if __name__ == "__main__":
    draw(int(sys.argv[1]))
    print(peak_resident_bytes())
