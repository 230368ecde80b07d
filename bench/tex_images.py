"""TexImages as the imaging subset's techniques send them: small, each through a pixel transfer of its own."""

import time
from functools import cache

import numpy as np

from bench.measure import Repeated, clock_of
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.pixel_transfer import PixelImage, PixelTransfer
from fixedpipe.pipeline.profiles import OCTANE
from fixedpipe.pipeline.state import ColorTable

EDGE = 16
IMAGES = 64
TURNS = 19


@cache
def _table(size):
    """A colour table of RGBA; one object for each size, as programs send thousands of images through one."""
    entries = np.random.default_rng(size).uniform(0.0, 1.0, (size, 4))
    return ColorTable(tuple(map(tuple, entries.tolist())))


def tex_images(turn):
    """``IMAGES`` TexImages of a turn: RGB in single precision through scale and bias, two tables, the colour
    matrix, its scale and bias, the Octane's clamp, and a table. No two images or numbers are the same.
    """
    commands = []
    for number in range(turn * IMAGES, (turn + 1) * IMAGES):
        random = np.random.default_rng(number)
        scale, *matrix = (tuple(row) for row in random.uniform(-1.0, 1.0, (5, 4)).tolist())
        transfer = PixelTransfer(
            scale=scale,
            bias=(0.5,) * 4,
            color_table=_table(256),
            post_convolution_color_table=_table(512),
            color_matrix=tuple(matrix),
            post_color_matrix_scale=(0.5,) * 4,
            post_color_matrix_bias=(0.5,) * 4,
            post_color_matrix_color_table=_table(1024),
        )
        image = random.uniform(-0.1, 1.1, (EDGE, EDGE, 3)).astype(np.float32)
        commands.append(
            TexImage(label="load", texture="t", pixels=PixelImage(image, "RGB"), transfer=transfer)
        )
    return tuple(commands)


def measure():
    """name -> microseconds of the processor a TexImage, a list of ``TURNS`` turns of ``IMAGES``.

    "texture": the texture is made, and nothing else. "run": ``Machine.run`` of images that it has not seen,
    validation too; "run again": of the same ones once more.
    """
    from fixedpipe.pipeline.execution.machine import Machine
    from fixedpipe.pipeline.framebuffers.texture_copies import defined_texture

    machine = Machine(OCTANE, EDGE, EDGE, threads=1)
    found = {"texture": [], "run": [], "run again": []}
    for turn in range(TURNS + 1):
        commands = tex_images(turn)
        start = time.process_time()
        for command in commands:
            defined_texture(command, OCTANE, machine.statistics, None)
        found["texture"].append(time.process_time() - start)
        run = Repeated(machine, commands, clock_of(1))
        for name in "run", "run again":
            found[name].append(run.turn(1))
    return {name: [1e6 / IMAGES * each for each in seconds[1:]] for name, seconds in found.items()}
