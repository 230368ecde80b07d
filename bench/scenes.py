"""The measured scenes: one Draw each, on the GeForce 256, and what another renderer needs to draw the same.

A scene is a mesh and a ``PassState``. A peer translates the state; only the register combiners have no
counterpart elsewhere, so a scene also names the texture environments (OpenGL 1.2.1 table 3.22,
ARB_texture_env_dot3) that its combiner program computes.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from pipeline.commands import Clear, Draw, Mesh, TexImage
from pipeline.enums import (
    BlendFactor,
    ComparisonFunction,
    ComponentUsage,
    Face,
    Mapping,
    PrimitiveType,
    Register,
    StencilOperation,
    TextureFilter,
)
from pipeline.state import (
    AlphaPortion,
    Blending,
    ColorMask,
    CombinerInput,
    DepthTest,
    FinalCombiner,
    GeneralCombiner,
    PassState,
    PolygonState,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    StencilTest,
    TextureUnit,
    VertexState,
)
from pipeline.textures import texture_2d

CLEAR_COLOR = (0.1, 0.15, 0.2, 1.0)


# ------------------------------------------------------------------------------------------ textures


@cache
def color_texture(n=512):
    """RGBA8 waves, a checkerboard of 16 texels and noise of ±16 levels; ``n`` texels along an edge."""
    row, column = np.mgrid[0:n, 0:n]
    rgb = np.stack(
        [
            127 + 100 * np.sin(column / 9) * np.cos(row / 13),
            127 + 100 * np.cos(column / 17 + row / 5),
            (column // 16 + row // 16) % 2 * 160.0 + 40,
        ],
        axis=-1,
    )
    rgb += np.random.default_rng(1).integers(-16, 17, (n, n, 3))
    image = np.full((n, n, 4), 255, np.uint8)
    image[..., :3] = np.clip(rgb, 0, 255)
    return texture_2d(image)


@cache
def normal_texture(n=512):
    """RGBA8 normals of a wavy surface: zero at 128, one at 255; alpha 255; ``n`` texels along an edge."""
    row, column = np.mgrid[0:n, 0:n]
    normal = np.empty((n, n, 3))
    normal[..., 0] = -0.6 * np.cos(column / 11) * np.cos(row / 19)
    normal[..., 1] = -0.6 * np.sin(column / 7 + row / 23)
    normal[..., 2] = 1.0
    normal /= np.sqrt((normal * normal).sum(-1, keepdims=True))
    image = np.full((n, n, 4), 255, np.uint8)
    image[..., :3] = np.rint(128 + 127 * normal)
    return texture_2d(image)


TEXTURES = {"color": color_texture, "normals": normal_texture}


def _unit(texture, coordinates=0):
    linear = Sampler(min_filter=TextureFilter.LINEAR, mag_filter=TextureFilter.LINEAR)
    return TextureUnit(texture, linear, coordinates=coordinates)


# --------------------------------------------------------------------------- register combiners


def _rgb(register, mapping=Mapping.UNSIGNED_IDENTITY):
    return CombinerInput(register, mapping)


def _alpha(register, mapping=Mapping.UNSIGNED_IDENTITY):
    return CombinerInput(register, mapping, ComponentUsage.ALPHA)


def _into_spare0(rgb, alpha, *, dot_product=False):
    """A general combiner that writes A · B of both portions to spare0."""
    output = {"ab_output": Register.SPARE0, "sum_output": Register.DISCARD}
    return GeneralCombiner(
        RGBPortion(*rgb, ab_dot_product=dot_product, **output), AlphaPortion(*alpha, **output)
    )


def _modulate(register, by):
    """Table 3.22's MODULATE: spare0 = register · by, RGB and alpha."""
    return _into_spare0((_rgb(register), _rgb(by)), (_alpha(register), _alpha(by)))


# spare0 = texture 0 · primary colour, both as vectors; alpha is texture 0's. The second stage's
# UNSIGNED_IDENTITY takes the clamp at 0 that DOT3_RGB asks for.
_DOT3 = _into_spare0(
    (_rgb(Register.TEXTURE0, Mapping.EXPAND_NORMAL), _rgb(Register.PRIMARY_COLOR, Mapping.EXPAND_NORMAL)),
    (_alpha(Register.TEXTURE0), _alpha(Register.ZERO, Mapping.UNSIGNED_INVERT)),
    dot_product=True,
)

# The fragment is spare0: A = 0 leaves C = 0 and D.
_SPARE0 = FinalCombiner(
    a=_rgb(Register.ZERO),
    b=_rgb(Register.ZERO),
    c=_rgb(Register.ZERO),
    d=_rgb(Register.SPARE0),
    g=_alpha(Register.SPARE0),
)

MODULATE = RegisterCombiners((_modulate(Register.TEXTURE0, Register.PRIMARY_COLOR),), _SPARE0)
BUMP = RegisterCombiners((_DOT3, _modulate(Register.SPARE0, Register.TEXTURE1)), _SPARE0)


# ------------------------------------------------------------------------------------------ meshes

# Light vectors as colours, lower left, lower right, upper left, upper right. Scenes without a bump map show
# them as Gouraud colours.
_LIGHTS = ((0.3, 0.3, 0.9, 1.0), (0.8, 0.3, 0.85, 1.0), (0.3, 0.8, 0.85, 1.0), (0.7, 0.7, 0.9, 1.0))


def quad(w_far=1.0, z=0.0, scale=1.0, colors=_LIGHTS, units=0):
    """A strip of two triangles over the whole screen, in clip coordinates.

    w runs from 1 at the bottom to ``w_far`` at the top; z/w is ``z``. s and t are affine in clip x and y, so
    that both triangles carry one perspective mapping, ``scale`` repeats of the texture along an affine edge.
    """
    corners = np.array([(-1, -1, 1, 1), (1, -1, 1, 1), (-1, 1, 1, 1), (1, 1, 1, 1)], np.float64)
    corners[:, 2] = z
    corners[2:] *= w_far
    repeats = scale if w_far == 1.0 else 0.75 * scale
    st = (corners[:, :2] + 1) / 2 * repeats
    return Mesh(corners, PrimitiveType.TRIANGLE_STRIP, colors=colors, texture_coordinates=(st,) * units)


@cache
def torus(around=200, across=200, major=1.0, minor=0.45):
    """A torus of 2 · ``around`` · ``across`` indexed triangles with (s, t) repeating 4 and 2 times."""
    u, v = np.meshgrid(
        np.linspace(0, 2 * np.pi, around + 1), np.linspace(0, 2 * np.pi, across + 1), indexing="ij"
    )
    radius = major + minor * np.cos(v)
    positions = np.stack([np.cos(u) * radius, np.sin(u) * radius, minor * np.sin(v)], axis=-1)
    st = np.stack([u / (2 * np.pi) * 4, v / (2 * np.pi) * 2], axis=-1)
    first = (np.arange(around)[:, None] * (across + 1) + np.arange(across)).ravel()
    next_u, next_v, opposite = first + across + 1, first + 1, first + across + 2
    triangles = np.stack([first, next_u, next_v, next_v, next_u, opposite], axis=-1)
    return Mesh(positions.reshape(-1, 3), indices=triangles.ravel(), texture_coordinates=(st.reshape(-1, 2),))


def perspective(degrees, near, far):
    """Make gluPerspective's matrix for a square viewport, as rows."""
    f = 1 / math.tan(math.radians(degrees) / 2)
    depth = near - far
    return (
        (f, 0.0, 0.0, 0.0),
        (0.0, f, 0.0, 0.0),
        (0.0, 0.0, (far + near) / depth, 2 * far * near / depth),
        (0.0, 0.0, -1.0, 0.0),
    )


def look_at(eye, target, up=(0.0, 0.0, 1.0)):
    """Make gluLookAt's matrix, as rows."""
    eye = np.asarray(eye, np.float64)
    forward = np.asarray(target) - eye
    forward /= np.linalg.norm(forward)
    side = np.cross(forward, up)
    side /= np.linalg.norm(side)
    rows = [side, np.cross(side, forward), -forward]
    return (*((*map(float, row), float(-row @ eye)) for row in rows), (0.0, 0.0, 0.0, 1.0))


# ------------------------------------------------------------------------------------------ scenes


@dataclass(frozen=True)
class Scene:
    """One measured scene.

    name, title      the letter of the table and what is drawn
    draw             framebuffer edge in pixels -> the Draw command
    environments     the texture environment of each unit that the combiners stand for: "MODULATE", "DOT3"
    size             the framebuffer's edge, in pixels, unless asked otherwise
    layers           how often a measured frame draws it after its one Clear
    picture_layers   how often the picture for the comparison draws it
    unit             "Mfragments/s" or "Mtriangles/s"
    goal             the least ratio of our rate to the peer's that is asked for
    levels           by how much a colour component may differ from the peer's picture, in levels of 255
    outside          which share of the pixels may differ by more, at the scene's own size
    """

    name: str
    title: str
    draw: Callable[[int], Draw]
    environments: tuple[str, ...]
    levels: int
    size: int = 1024
    layers: int = 8
    picture_layers: int = 1
    unit: str = "Mfragments/s"
    goal: float = 0.5
    outside: float = 0.0

    def textures(self):
        """The TexImage commands that the scene's Draw needs before it."""
        names = [unit.texture for unit in self.draw(self.size).state.texture_units]
        return tuple(TexImage(label=f"texture {n}", texture=n, image=TEXTURES[n]()) for n in names)

    def frame(self, size, layers):
        """A frame: clear everything, then ``layers`` times the Draw."""
        clear = Clear(label="clear", color=CLEAR_COLOR, depth=1.0, stencil=0)
        return (clear, *(self.draw(size),) * layers)

    def work(self, size):
        """Fragments (every layer covers the screen) or triangles of a measured frame."""
        if self.unit == "Mtriangles/s":
            return self.layers * len(self.draw(size).mesh.indices) // 3
        return self.layers * size * size


def _flat(size):
    return Draw(label="flat", mesh=quad(colors=((0.8, 0.4, 0.2, 1.0),) * 4), state=PassState())


def _gouraud(size):
    return Draw(label="Gouraud", mesh=quad(), state=PassState())


_TEXTURED = PassState(texture_units=(_unit("color"),), register_combiners=MODULATE)
_BUMPED = PassState(texture_units=(_unit("normals"), _unit("color", 1)), register_combiners=BUMP)


def _textured(size):
    return Draw(label="texture", mesh=quad(scale=size / 512 * 0.93, units=1), state=_TEXTURED)


def _textured_in_perspective(size):
    return Draw(label="texture", mesh=quad(w_far=2.0, scale=size / 512, units=1), state=_TEXTURED)


def _bumped(size):
    return Draw(label="bump", mesh=quad(w_far=2.0, scale=size / 512, units=2), state=_BUMPED)


def _bumped_and_added(size):
    state = PassState(
        texture_units=_BUMPED.texture_units,
        register_combiners=BUMP,
        depth_test=DepthTest(ComparisonFunction.LEQUAL),
        blending=Blending(BlendFactor.ONE, BlendFactor.ONE),
    )
    return Draw(label="bump, added", mesh=quad(w_far=2.0, scale=size / 512, z=0.25, units=2), state=state)


def _torus(cull_face):
    vertex = VertexState(look_at((0.9, -2.2, 2.6), (0, 0, 0)), perspective(45, 1.0, 10.0))
    state = PassState(
        vertex=vertex,
        polygon=PolygonState(cull_face=cull_face),
        texture_units=(_unit("color"),),
        register_combiners=MODULATE,
        depth_test=DepthTest(),
    )
    return lambda size: Draw(label="torus", mesh=torus(), state=state)


def _counted(size):
    state = PassState(
        depth_test=DepthTest(ComparisonFunction.LEQUAL, write=False),
        stencil_test=StencilTest(depth_pass=StencilOperation.INCR),
        color_mask=ColorMask(False, False, False, False),
    )
    return Draw(label="count", mesh=quad(w_far=2.0, z=0.25, colors=None), state=state)


_ONE, _TWO = ("MODULATE",), ("DOT3", "MODULATE")
_TORUS = {"size": 512, "layers": 1, "unit": "Mtriangles/s", "outside": 0.005}

# How far the pictures may be apart (levels), for a peer that computes in floats and rounds at the end:
# a2  two colour weights, each up to 1/256 of half the range low, and three roundings to a byte: 2
# b   a2's 2, one for the bilinear filter's fractions and bytes, one for the product's byte: 4
# c   EXPAND doubles b's 1 and a2's 2, and its half of 128 instead of 127.5 moves both operands by 1; a dot
#     product with a unit vector weighs a component's error by at most the square root of 3, which makes
#     (2 + 1 + 4 + 1) * 1.74 = 14; one each for the second texture and the product: 16
# e   vertices snap to 1/16 pixel here and to 1/256 there, so edges shift, and texels where the texture is
#     minified: a share of the pixels (Measured: 0.28 % at 512 x 512, less when larger) may exceed 32
SCENES = {
    scene.name: scene
    for scene in (
        Scene("a", "flat quad", _flat, (), 0),
        Scene("a2", "Gouraud quad", _gouraud, (), 2),
        Scene("b", "one bilinear texture, MODULATE, affine", _textured, _ONE, 4),
        Scene("b2", "one bilinear texture, MODULATE, perspective", _textured_in_perspective, _ONE, 4),
        Scene("c", "DOT3(texture 0, primary) x texture 1", _bumped, _TWO, 16),
        Scene("d", "c, depth test, additive blend", _bumped_and_added, _TWO, 16),
        Scene("e", "torus, textured, depth test", _torus(None), _ONE, 32, **_TORUS),
        Scene("e2", "e, back faces culled", _torus(Face.BACK), _ONE, 32, **_TORUS),
        Scene("g", "stencil increments", _counted, (), 0, layers=100, picture_layers=100),
    )
}
