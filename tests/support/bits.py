"""Print digests of frames, tables and figures: run by test_same_bits under other processors, threads and
batches.

``python -m tests.support.bits THREADS:BATCH ... ID ...`` prints a digest for each choice, with the figures of
these ids. With ``--assembly`` it also counts the fused multiply-adds in the kernels' machine code, those that
a source asks for and others, which needs kernels that this process compiled itself.
"""

import hashlib
import importlib
import re
import sys
from itertools import chain
from pathlib import Path

import numpy as np
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from fixedpipe.effects.figures import FIGURES
from fixedpipe.pipeline.enums import FogMode
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import GEFORCE_256, PROFILES
from fixedpipe.pipeline.programs.fog import fog_thresholds
from fixedpipe.pipeline.state import Fog
from fixedpipe.raster.portable.sample import POWERS_OF_TWO
from fixedpipe.raster.vector import lanes
from tests.support.strategies import frames

_ROOT = Path(__file__).parents[2]
FIGURE_SIZE = 64
FUSED = re.compile(r"\bv?fn?m(?:add|sub)", re.IGNORECASE)  # x86's vfmadd..., Arm's fmadd
FUNCTION = re.compile(r"^(_Z\S+):", re.MULTILINE)


def digests(choices, figures):
    """sha256 over the framebuffers of 60 random frames and of figures, given by id, and over the tables, for
    each of ``choices``, (threads, batch).
    """
    totals = [hashlib.sha256() for _ in choices]

    def add(commands, profile, width, height, depth_bits):
        for total, (threads, batch) in zip(totals, choices, strict=True):
            framebuffer = execute(
                commands, profile, width, height, depth_bits=depth_bits, threads=threads, batch=batch
            ).framebuffer
            for buffer in (framebuffer.color, framebuffer.depth, framebuffer.stencil):
                total.update(np.ascontiguousarray(buffer).tobytes())

    @settings(
        max_examples=60,
        derandomize=True,
        database=None,
        deadline=None,
        phases=(Phase.generate,),
        suppress_health_check=list(HealthCheck),
    )
    @given(frames(160, 130), st.sampled_from(GEFORCE_256.framebuffers.depth_bits))
    def random_frames(commands, depth_bits):
        add(commands, GEFORCE_256, 160, 130, depth_bits)

    random_frames()
    for figure in map(FIGURES.__getitem__, figures):
        profile = PROFILES[figure.machines[0]]
        size = figure.dimensions(FIGURE_SIZE)
        add(figure.commands(profile, FIGURE_SIZE), profile, *size, profile.widest_depth)
    for total in totals:
        total.update(POWERS_OF_TWO.tobytes())
        for mode in FogMode:
            total.update(fog_thresholds(Fog(mode, density=0.37, start=1.0, end=7.0)).tobytes())
    return [total.hexdigest() for total in totals]


def asks(module):
    """Whether a module has ``fused``, or a kernel that names it and whose code LLVM may put into the module's
    own.
    """
    if module is lanes:
        return False
    functions = [value.py_func for value in vars(module).values() if hasattr(value, "inspect_asm")]
    names = [[function.__globals__.get(n) for n in function.__code__.co_names] for function in functions]
    return any(value is lanes.fused for value in (*vars(module).values(), *chain(*names)))


def fused_operations():
    """(kernels read, lines of machine code, fused multiply-adds among them, and those in functions of modules
    that ask for them) over everything in raster/.

    A kernel's text has the kernels that it calls.
    """
    kernels = lines = fused = asked = 0
    names = [
        ".".join(("fixedpipe", *path.relative_to(_ROOT).with_suffix("").parts)).removesuffix(".__init__")
        for path in sorted(_ROOT.glob("raster/**/*.py"))
    ]
    modules = {name: importlib.import_module(name) for name in names}
    asking = [
        "".join(f"{len(part)}{part}" for part in name.split("."))  # as a function's symbol begins
        for name, module in modules.items()
        if asks(module)
    ]
    for module in modules.values():
        for value in vars(module).values():
            if hasattr(value, "inspect_asm") and value.py_func.__module__ == module.__name__:
                for text in value.inspect_asm().values():
                    kernels += 1
                    lines += text.count("\n")
                    _before, *functions = FUNCTION.split(text)
                    for function, code in zip(functions[::2], functions[1::2], strict=True):
                        found = len(FUSED.findall(code))
                        if any(mangled in function for mangled in asking):
                            asked += found
                        else:
                            fused += found
    return kernels, lines, fused, asked


if __name__ == "__main__":
    asked = [argument for argument in sys.argv[1:] if argument != "--assembly"]
    choices = [tuple(map(int, choice.split(":"))) for choice in asked if ":" in choice]
    print(*digests(choices, [argument for argument in asked if ":" not in argument]))
    if "--assembly" in sys.argv:
        print(*fused_operations())
