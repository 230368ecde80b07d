"""Passes (frozen states), machines (profiles), and functions that run passes on machines.

``help(fixedpipe.pipeline.Draw)`` describes one of these names in full. The enumerations, OpenGL's tokens, are
in ``fixedpipe.pipeline.enums``, and the rarer parts of a state in ``fixedpipe.pipeline.state``. The module of
a name is imported when the name is first used, so you can make states without loading a kernel.

  to run a frame      execute: on a new machine; Machine: keeps its contents; execute_ideal: on none
  what comes of it    Result, Fragments; IdealResult of the ideal
    several as one    beside, above: pictures or arrays as one picture, for a notebook
  to ask about it     validate: can the machine draw it; describe: in words; inspect: a pixel's PixelHistory
  what is refused     UnsupportedState is raised; DisabledTexture is a warning
  Command: any of     Clear, Draw, DrawPixels, Bitmap, CopyPixels, Accum, ReadPixels, MakeCurrent (a pbuffer)
    of textures       TexImage, CopyTexImage, CopyTexSubImage, BindTexImage, GetTexImage
    others            ResetHistogram, ResetMinmax, Saturate, MultiDraw, HostStep: the application's work
  what they take      Mesh, Texture, PixelImage, PixelTransfer
    makers of it      texture_1d, texture_2d, texture_3d, texture_cube_map
  a Draw's PassState  VertexState: transformation, lighting, clipping
    its textures      TextureUnit, Sampler, ColorKey, TextureShaderStage
    its combining     TextureEnvironment (environment makes one from words), RegisterCombiners, Fog
    its fragments     Scissor, AlphaTest, StencilTest, DepthTest, Blending, ColorMask
  notations           parse_program: a Program of !!RC1.0, !!TS1.0, ps.1.x and others, for a PassState
  machines            OPENGL_1_2, OPENGL_1_2_IMAGING, MULTITEXTURE, OCTANE, INFINITE_REALITY, G400, TEXRAM,
                      GEFORCE_256, GEFORCE_3, NV2A; SCHILLING and FUTURE, which papers proposed; IDEAL
    of any name       PROFILES, a mapping; Profile: what a machine is

``execute`` runs a frame, a tuple of commands, on a new machine. ``execute_ideal`` runs it in real numbers:

>>> from fixedpipe.pipeline import GEFORCE_256, Clear, Draw, Mesh, PassState, execute, execute_ideal
>>> triangle = Mesh([[-1, -1], [3, -1], [-1, 3]], colors=[[0.3, 0.6, 0.9]] * 3)
>>> black = Clear(label="black", color=(0, 0, 0, 0))
>>> frame = (black, Draw(label="one colour", mesh=triangle, state=PassState()))
>>> execute(frame, GEFORCE_256, 4, 4).image()[0, 0].tolist()
[76, 153, 229, 255]
>>> execute_ideal(frame, 4, 4).color[0, 0].round(3).tolist()
[0.3, 0.6, 0.9, 1.0]

A state is complete, and its defaults are OpenGL's initial values. Here a second pass adds to the first:

>>> from fixedpipe.pipeline import Blending
>>> from fixedpipe.pipeline.enums import BlendFactor, TextureFilter
>>> added = PassState(blending=Blending(source=BlendFactor.ONE, destination=BlendFactor.ONE))
>>> twice = (*frame, Draw(label="once more", mesh=triangle, state=added))
>>> execute(twice, GEFORCE_256, 4, 4).image()[0, 0].tolist()
[152, 255, 255, 255]

You make a texture from an array, and a command stores it. A texture unit names the texture that it reads:

>>> import numpy as np
>>> from fixedpipe.pipeline import Sampler, TexImage, TextureUnit, texture_2d
>>> grey = TexImage(label="grey", texture="grey", image=texture_2d(np.full((2, 2, 4), 128, np.uint8)))
>>> nearest = Sampler(min_filter=TextureFilter.NEAREST, mag_filter=TextureFilter.NEAREST)
>>> textured = PassState(texture_units=(TextureUnit("grey", nearest),))
>>> mapped = Mesh(triangle.positions, colors=triangle.colors, texture_coordinates=([[0, 0], [1, 0], [0, 1]],))
>>> modulated = (grey, Draw(label="colour times texel", mesh=mapped, state=textured))
>>> execute(modulated, GEFORCE_256, 4, 4).image()[0, 0].tolist()
[38, 77, 115, 128]

A ``Machine`` keeps its framebuffers and textures from one frame to the next. A command reads pixels back:

>>> from fixedpipe.pipeline import Machine, ReadPixels
>>> machine = Machine(GEFORCE_256, 4, 4)
>>> read = ReadPixels(label="read back", name="corner", width=1, height=1)
>>> machine.run((*frame, read)).pixels["corner"].tolist()
[[[76, 153, 229, 255]]]

A machine refuses a frame that it cannot draw before it draws anything. ``validate`` only checks a frame:

>>> from fixedpipe.pipeline import OPENGL_1_2, UnsupportedState, parse_program, validate
>>> code = "!!RC1.0 { rgb { spare0 = col0 * col0; } } out.rgb = spare0; out.a = col0.a;"
>>> squared = PassState(register_combiners=parse_program(code).combiners)
>>> try:
...     validate((Draw(label="squared", mesh=triangle, state=squared),), OPENGL_1_2, 4, 4)
... except UnsupportedState as refused:
...     print(refused)
Command 0, "squared": OpenGL 1.2 has no register combiners; choose a profile that has them.

"""

import importlib
import pkgutil
import re
import sys

# The module of each name, from the stub for type checkers. Its lines are "from module import name as name".
_STUB = pkgutil.get_data(__name__, "__init__.pyi").decode()
_MODULE_OF = {name: module for module, name in re.findall(r"(?m)^from (\S+) import (\w+) as \2$", _STUB)}
__all__ = sorted(_MODULE_OF)


def __getattr__(name):
    if name not in _MODULE_OF:
        raise AttributeError(
            f"module {__name__!r} has no attribute {name!r}; dir({__name__}) lists what it has. OpenGL's "
            f"tokens are in {__name__}.enums, the rest of states in {__name__}.state."
        )
    value = getattr(importlib.import_module(_MODULE_OF[name]), name)
    globals()[name] = value
    return value


def __dir__():
    # pydoc would print the help of every name here, three thousand lines. The table above names them all.
    caller = sys._getframe(1)
    while caller and caller.f_globals.get("__name__") == "inspect":
        caller = caller.f_back
    if caller and caller.f_globals.get("__name__") == "pydoc":
        return []
    return sorted({*globals(), *__all__})
