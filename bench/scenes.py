"""The measured scenes: one Draw each on a machine, and what another renderer needs to draw the same.

A scene is a mesh and a ``PassState``. A peer translates the state; only the register combiners have no
counterpart elsewhere, so a scene also names the texture environments (OpenGL 1.2.1 table 3.22,
ARB_texture_env_dot3) that its combiner program computes.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

from bench import shadow
from bench.meshes import look_at, perspective, quad, tiles, torus
from bench.textures import TEXTURES
from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    BlendFactor,
    ComparisonFunction,
    ComponentUsage,
    Face,
    Mapping,
    Register,
    StencilOperation,
    TextureCompareMode,
    TextureFilter,
    WrapMode,
)
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.state import (
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

CLEAR_COLOR = (0.1, 0.15, 0.2, 1.0)


_LINEAR = Sampler(min_filter=TextureFilter.LINEAR, mag_filter=TextureFilter.LINEAR)
_EDGE = replace(_LINEAR, wrap_s=WrapMode.CLAMP_TO_EDGE, wrap_t=WrapMode.CLAMP_TO_EDGE)
_TRILINEAR = replace(_LINEAR, min_filter=TextureFilter.LINEAR_MIPMAP_LINEAR)
_COMPARING = replace(
    _LINEAR,
    wrap_s=WrapMode.CLAMP_TO_EDGE,
    wrap_t=WrapMode.CLAMP_TO_EDGE,
    compare_mode=TextureCompareMode.COMPARE_R_TO_TEXTURE,
    compare_function=ComparisonFunction.LEQUAL,
)


def _unit(texture, coordinates=0):
    return TextureUnit(texture, _LINEAR, coordinates=coordinates)


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


def bump(stages):
    """Scene c's program with ``stages`` general combiners: DOT3, then texture 1 as often as there is room."""
    by_texture1 = _modulate(Register.SPARE0, Register.TEXTURE1)
    return RegisterCombiners((_DOT3, *(by_texture1,) * (stages - 1)), _SPARE0)


BUMP = bump(2)


# ------------------------------------------------------------------------------------------ scenes


@dataclass(frozen=True, eq=False)
class Scene:
    """One measured scene.

    name, title      the letter of the table and what is drawn
    draw             framebuffer edge in pixels -> the Draw command, or the first of a layer's
    meshes           framebuffer edge in pixels -> the meshes of a layer's Draws, all in ``draw``'s state, or
                     None: ``draw``'s alone
    depth_first      whether a frame begins with its meshes' depths alone: LESS, written, without textures
    environments     the texture environment of each unit that the combiners stand for: "MODULATE", "DOT3"
    size             the framebuffer's edge, in pixels, unless asked otherwise
    layers           how often a measured frame draws it after its one Clear
    picture_layers   how often the picture for the comparison draws it
    profile          the machine that draws it
    unit             "Mfragments/s" or "Mtriangles/s"
    covers           whether a layer makes one fragment for every pixel; else they are counted by drawing
    aim              the rate that is asked for, in ``unit``, or None
    levels           by how much a colour component may differ from the peer's picture, in levels of 255
    outside          which share of the pixels may differ by more
    snapped          whether snapping moves its vertices, which are at the screen's corners otherwise: then
                     ``levels`` and ``outside`` hold for the scene's own size and for larger ones
    """

    name: str
    title: str
    draw: Callable[[int], Draw]
    environments: tuple[str, ...]
    levels: int
    size: int = 1024
    layers: int = 8
    picture_layers: int = 1
    profile: Profile = GEFORCE_256
    unit: str = "Mfragments/s"
    covers: bool = True
    aim: float | None = None
    outside: float = 0.0
    snapped: bool = False
    meshes: Callable[[int], tuple[Mesh, ...]] | None = None
    depth_first: bool = False

    def textures(self):
        """The TexImage commands that the scene's Draw needs before it."""
        names = [unit.texture for unit in self.draw(self.size).state.texture_units]
        return tuple(TexImage(label=f"texture {n}", texture=n, image=TEXTURES[n]()) for n in names)

    def layer(self, size):
        """A layer's Draws."""
        draw = self.draw(size)
        return tuple(replace(draw, mesh=mesh) for mesh in self.meshes(size)) if self.meshes else (draw,)

    def frame(self, size, layers):
        """A frame: clear everything, the depths where they come first, then ``layers`` times the Draws."""
        clear, layer = Clear(label="clear", color=CLEAR_COLOR, depth=1.0, stencil=0), self.layer(size)
        depths = depths_alone(layer) if self.depth_first else ()
        return (clear, *depths, *layer * layers)

    def fragments(self, size):
        """Fragments that a layer makes, whether or not they pass the tests."""
        return size * size if self.covers else _count_fragments(self, size)

    def triangles(self, size):
        """Triangles that a layer submits."""
        meshes = (draw.mesh for draw in self.layer(size))
        return sum(2 if mesh.indices is None else len(mesh.indices) // 3 for mesh in meshes)

    def work(self, size):
        """Fragments or triangles of a measured frame, whichever ``unit`` counts."""
        counted = self.triangles if self.unit == "Mtriangles/s" else self.fragments
        return self.layers * counted(size)


@cache
def _count_fragments(scene, size):
    # numba is imported with it, which a peer's process has no use for.
    from fixedpipe.pipeline.execution.machine import execute

    return execute((*scene.textures(), *scene.layer(size)), scene.profile, size, size).fragments


def depths_alone(draws):
    """The Draws, in one state, that leave nothing but the depths of other Draws' meshes."""
    masked = ColorMask(False, False, False, False)
    state = PassState(vertex=draws[0].state.vertex, depth_test=DepthTest(), color_mask=masked)
    return tuple(replace(draw, label="depth", state=state) for draw in draws)


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


def _minified(size):
    unit = TextureUnit("color, mipmapped", _TRILINEAR)
    state = PassState(texture_units=(unit,), register_combiners=MODULATE)
    return Draw(label="minify", mesh=quad(w_far=2.5, scale=size / 512 * 5, units=1), state=state)


@cache
def _tiles(size):
    return tiles(size, scale=size / 512 * 3)


def _lit_tile(size):
    units = tuple(
        TextureUnit(name, _TRILINEAR, coordinates=k)
        for k, name in enumerate(("color, mipmapped", "light, mipmapped"))
    )
    test = DepthTest(ComparisonFunction.EQUAL, write=False)
    state = PassState(texture_units=units, depth_test=test)
    return Draw(label="texture x light", mesh=_tiles(size)[0], state=state)


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


def _shadowed(mesh):
    unit = TextureUnit("shadow map", _COMPARING, gen=shadow.coordinate_generation())
    state = PassState(
        vertex=VertexState(**shadow.VIEW),
        texture_units=(unit,),
        register_combiners=MODULATE,
        depth_test=DepthTest(ComparisonFunction.LEQUAL),
    )
    return lambda size: Draw(label="shadow", mesh=mesh(), state=state)


def _reflecting(size):
    """Figure F000-2's torus of 200 x 200 quads: both tables in one pass, coordinates at the vertices."""
    from fixedpipe.effects.geometry.matrices import rotation
    from fixedpipe.effects.geometry.surfaces import torus as surface
    from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view
    from fixedpipe.effects.reflectance.torrance_sparrow_passes import vertex_coordinates

    view, light = orthographic_view(Panel(0, 0, size, size)), Light((-0.45, 0.6, 0.75))
    body = surface(200, 200, 0.62, 0.3).rotated(rotation("x", 55.0))
    mesh = body.mesh(
        *vertex_coordinates(body, view, light), colors=((1.0, 0.88, 0.62, 1.0),) * len(body.normals)
    )
    state = PassState(
        vertex=VertexState(view.modelview, view.projection),
        texture_units=tuple(
            TextureUnit(name, _EDGE, coordinates=k) for k, name in enumerate(("F D", "G / (pi cos beta)"))
        ),
        depth_test=DepthTest(),
    )
    return Draw(label="Torrance-Sparrow", mesh=mesh, state=state)


_ONE, _TWO = ("MODULATE",), ("DOT3", "MODULATE")
_TORUS = {
    "size": 512,
    "layers": 1,
    "unit": "Mtriangles/s",
    "covers": False,
    "outside": 0.005,
    "snapped": True,
}
_SHADOW = {"profile": GEFORCE_3, "snapped": True}
_SHADOW_VIEW = {**_SHADOW, "layers": 1, "covers": False, "outside": 0.001}

# How far the pictures may be apart (levels), for a peer that computes in floats and rounds at the end:
# a2  two colour weights, each up to 1/256 of half the range low, and three roundings to a byte: 2
# b   a2's 2, one for the bilinear filter's fractions and bytes, one for the product's byte: 4
# c   EXPAND doubles b's 1 and a2's 2, and its half of 128 instead of 127.5 moves both operands by 1; a dot
#     product with a unit vector weighs a component's error by at most the square root of 3, which makes
#     (2 + 1 + 4 + 1) * 1.74 = 14; one each for the second texture and the product: 16
# e   vertices snap to 1/16 pixel here and to 1/256 there, so edges shift, and texels where the texture is
#     minified: a share of the pixels (Measured: 0.28 % at 512 x 512, less when larger) may exceed 32
# t   as e: vertices snap, and highlights move with them
# f3  b's 4; and the floor shifts by up to 1/16 pixel, which is 0.02 of the map's texels where a shadow's edge
#     lies, times 255: 5 more
# f2  f3's, but along the balls' edges and where a ball's own shadow begins: a share of the pixels (Measured:
#     0.04 % at 1024 x 1024)
# h   b's 4, which mixing two levels does not enlarge; one for the fraction of lambda in steps of 1/256, one
#     for the mixture's byte, two where lambda itself differs by the hundredth of a level: 8
# i   of either texture one for the filter's fractions and bytes, and h's four: 5; the product has both's, and
#     two products' bytes: 12
SCENES = {
    scene.name: scene
    for scene in (
        Scene("a", "flat quad", _flat, (), 0, aim=1000),
        Scene("a2", "Gouraud quad", _gouraud, (), 2, aim=900),
        Scene("b", "one bilinear texture, MODULATE, affine", _textured, _ONE, 4, aim=400),
        Scene("b2", "b in perspective", _textured_in_perspective, _ONE, 4, aim=400),
        Scene("c", "DOT3(texture 0, primary) x texture 1", _bumped, _TWO, 16, aim=240),
        Scene("d", "c, depth test, additive blend", _bumped_and_added, _TWO, 16, aim=200),
        Scene("e", "torus, textured, depth test", _torus(None), _ONE, 32, **_TORUS),
        Scene("e2", "e, back faces culled", _torus(Face.BACK), _ONE, 32, aim=15, **_TORUS),
        Scene("f2", "shadow-mapped view", _shadowed(shadow.balls_on_floor), _ONE, 9, **_SHADOW_VIEW),
        Scene("f3", "shadow comparison, floor only", _shadowed(shadow.floor), _ONE, 9, **_SHADOW),
        Scene("g", "stencil increments", _counted, (), 0, layers=100, picture_layers=100),
        Scene(
            "t", "torus by two tables (F000-2)", cache(_reflecting), ("MODULATE", "MODULATE"), 32, **_TORUS
        ),
        Scene("h", "trilinear minification", _minified, _ONE, 8, aim=200),
        Scene(
            "i",
            "121 Draws: two trilinear textures multiplied, depths first",
            _lit_tile,
            ("MODULATE", "MODULATE"),
            12,
            layers=1,
            meshes=_tiles,
            depth_first=True,
        ),
    )
}
