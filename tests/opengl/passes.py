"""Hypothesis strategies of frames that our machine and Mesa must draw alike, vertices on 1/16 pixels.

Structure is drawn by Hypothesis, so that it shrinks; bulk data (vertices, texels) comes from a drawn seed.
What keeps two correct machines from disagreeing is said where it is chosen.
"""

from dataclasses import replace
from random import Random

import numpy as np
from hypothesis import strategies as st

from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    BlendFactor,
    ColorMaterialParameter,
    CombineFunction,
    CombineSource,
    ComparisonFunction,
    Face,
    FogCoordinateSource,
    FogMode,
    FrontFace,
    LogicOperation,
    PrimitiveType,
    ProvokingVertex,
    ShadeModel,
    StencilOperation,
    TexGenMode,
    TextureEnvironmentMode,
    TextureFilter,
    TextureTarget,
)
from fixedpipe.pipeline.profiles import MULTITEXTURE, OPENGL_1_2, OPENGL_1_2_IMAGING
from fixedpipe.pipeline.state import (
    IDENTITY,
    AlphaTest,
    Blending,
    ColorMask,
    ColorMaterial,
    DepthTest,
    Fog,
    Light,
    Lighting,
    Material,
    PassState,
    PolygonState,
    Sampler,
    Scissor,
    StencilTest,
    TexGen,
    TextureEnvironment,
    TextureUnit,
    VertexState,
    Viewport,
)
from fixedpipe.pipeline.textures.images import COMPONENT_BITS, texture_1d, texture_2d
from tests.support.random_environments import random_environment

WIDTH, HEIGHT = 32, 16  # powers of two: window coordinates are exact, in float32 too

# A board with OpenGL's rules and the extensions that both sides have.
EXTENDED = MULTITEXTURE.changed(
    name="OpenGL with extensions",
    blend_factors_source=frozenset(BlendFactor),
    blend_factors_destination=frozenset(BlendFactor) - {BlendFactor.SRC_ALPHA_SATURATE},
    blend_equations=OPENGL_1_2_IMAGING.fragments.blend_equations,
    stencil_operations=frozenset(StencilOperation),
    fog_coordinate=True,
    texture_environment_modes=frozenset(TextureEnvironmentMode) - {TextureEnvironmentMode.NONE},
    combine_functions=frozenset(CombineFunction),
    texture_environment_crossbar=True,
    add_signed_scale_by_four=True,
)
PROFILES = (
    EXTENDED,
    OPENGL_1_2,
    MULTITEXTURE.changed(add_signed_scale_by_four=True),  # as EXT_texture_env_combine has it
    OPENGL_1_2_IMAGING,
)

seeds = st.integers(0, 2**32 - 1)
_bytes = st.integers(0, 255)
_functions = st.sampled_from(ComparisonFunction)
# Both sides hold bytes exactly: a constant between two bytes would be rounded on one side alone.
byte_colors = st.tuples(_bytes, _bytes, _bytes, _bytes).map(lambda c: tuple(v / 255.0 for v in c))


def maybe(strategy, often=1):
    """None, or one of the strategy: once, or ``often`` times, in each 1 + ``often``."""
    return st.one_of(st.none(), *[strategy] * often)


# --------------------------------------------------------------------------------------------------- geometry

_QUADS = (PrimitiveType.QUADS, PrimitiveType.QUAD_STRIP)
TRIANGLES = (
    PrimitiveType.TRIANGLES,
    PrimitiveType.TRIANGLE_STRIP,
    PrimitiveType.TRIANGLE_FAN,
    PrimitiveType.POLYGON,
)
_ANY_PROVOKES = (PrimitiveType.TRIANGLES, PrimitiveType.TRIANGLE_STRIP)
POLYGONS = (*TRIANGLES, *_QUADS)


def _quads(random, primitive, count, grid):
    """Parallelograms: which diagonal splits one is then nobody's business."""
    size = np.array([WIDTH, HEIGHT]) * grid

    def fourth(a, b, c):
        """The corner opposite to a, None where that is off the screen."""
        d = b + c - a
        return d if ((d >= 0) & (d <= size)).all() else None

    def places():
        return random.integers(0, size + 1)

    found = []
    while len(found) < count:
        a, b, c = places(), places(), places()
        if found and primitive is PrimitiveType.QUAD_STRIP:
            a, b, c = found[-1][2], found[-1][3], places()
        d = fourth(a, b, c)
        if d is not None:
            found.append((a, b, c, d))
    if primitive is PrimitiveType.QUADS:
        return np.array([corner for a, b, c, d in found for corner in (a, b, d, c)]) / grid
    return np.array([*found[0][:2], *(corner for _, _, c, d in found for corner in (c, d))]) / grid


@st.composite
def meshes(draw, primitives=POLYGONS, exact_colors=False, aligned=False):
    """Triangles and quads on the 1/16 pixels (or pixel centres and corners) of the screen, and none beyond:
    Mesa clips there, and a vertex that clipping makes lies anywhere.

    Attributes of quads are planes over the screen, so quads that overlap would lie in one another: their
    depth is constant. 1/w is a power of two, so that division is exact.
    ``exact_colors``: bytes, one colour for each mesh, which no interpolation changes.
    ``aligned``: of a texture of eight texels, each pixel holds 7/4 times a power of two along both axes, so
    that lambda is 0.8 and a whole number: never between 0 and 1/2, where OpenGL 1.2.1 still magnifies and
    Mesa does not (docs/mesa.md), nor near a change of level.
    """
    primitive, random = draw(st.sampled_from(primitives)), np.random.default_rng(draw(seeds))
    grid = draw(st.sampled_from((1, 2, 2, 16, 16, 16, 16)))
    planar = primitive in _QUADS
    if planar:
        pixels = _quads(random, primitive, draw(st.integers(1, 3)), grid)
    else:
        count = (
            draw(st.integers(1, 4)) * 3 if primitive is PrimitiveType.TRIANGLES else draw(st.integers(3, 8))
        )
        pixels = random.integers(0, np.array([WIDTH, HEIGHT]) * grid + 1, (count, 2)) / grid
    count = len(pixels)

    def values(width, kind):
        """[count, width] in [0, 1]: of single precision, which is what Mesa reads; planes for quads."""
        if kind == "constant":
            return np.tile(random.integers(0, 256, (1, width)) / 255.0, (count, 1))
        if planar:
            plane = pixels @ random.uniform(-1.0, 1.0, (2, width))
            return np.float32((plane - plane.min(0)) / np.maximum(np.ptp(plane, 0), 1e-3)).astype(float)
        if kind == "bytes":
            return random.integers(0, 256, (count, width)) / 255.0
        return random.random((count, width), np.float32).astype(float)

    def coordinates():
        """(s, t): at random; or aligned."""
        if not aligned:
            return 3.0 * values(2, "floats") - 1.5
        return pixels * random.choice([0.4375, 0.875, 1.75, 3.5], 2) / 8.0 + random.choice(
            [0.0, 0.0625, 0.3125], 2
        )

    w = np.ones(count)
    if not planar and not aligned and draw(st.integers(0, 3)) == 0:
        w = random.choice([0.5, 1.0, 2.0, 4.0], count)
    z = np.full(count, random.choice([-1.0, -0.5, 0.0, 0.5, 1.0]))
    if not planar and draw(st.booleans()):
        z = np.float32(2.0 * values(1, "floats")[:, 0] - 1.0).astype(float)
    x, y = (2.0 * pixels / (WIDTH, HEIGHT) - 1.0).T
    kind = "constant" if exact_colors else draw(st.sampled_from(("floats", "bytes", "constant")))
    indices = None
    if primitive is PrimitiveType.TRIANGLES and draw(st.integers(0, 3)) == 0:
        indices = random.integers(0, count, 3 * draw(st.integers(1, 4)))
    return Mesh(
        np.stack([x * w, y * w, z * w, w], -1),
        primitive,
        indices=indices,
        colors=values(4, kind),
        secondary_colors=values(3, kind),
        normals=np.float32(random.normal(size=(count, 3))),
        texture_coordinates=tuple(coordinates() for _ in range(2)),
        fog_coordinates=4.0 * values(1, "constant" if exact_colors else "floats")[:, 0],
    )


# ----------------------------------------------------------------------------------------------------- states


def _stencil_tests(profile):
    operations = st.sampled_from(sorted(profile.fragments.stencil_operations))
    return st.builds(
        StencilTest,
        function=_functions,
        reference=st.integers(-5, 300),
        mask=st.just(255) | _bytes,
        fail=operations,
        depth_fail=operations,
        depth_pass=operations,
        write_mask=st.just(255) | _bytes,
    )


def _blendings(profile):
    return st.builds(
        Blending,
        source=st.sampled_from(sorted(profile.fragments.blend_factors_source)),
        destination=st.sampled_from(sorted(profile.fragments.blend_factors_destination)),
        equation=st.sampled_from(sorted(profile.fragments.blend_equations)),
        color=byte_colors,
    )


_depth_tests = st.builds(DepthTest, _functions, st.booleans())
_alpha_tests = st.builds(AlphaTest, _functions, _bytes.map(lambda b: b / 255.0))
_color_masks = st.just(ColorMask()) | st.builds(ColorMask, *[st.booleans()] * 4)
_scissors = st.builds(
    Scissor,
    st.integers(-3, WIDTH),
    st.integers(-3, HEIGHT),
    st.integers(0, WIDTH + 5),
    st.integers(0, HEIGHT + 5),
)


def _fogs(profile):
    sources = (
        FogCoordinateSource if profile.vertices.fog_coordinate else (FogCoordinateSource.FRAGMENT_DEPTH,)
    )
    distances = st.sampled_from((0.0, 1.0, 2.0, -1.0, 0.25, 3.5))
    return st.builds(
        Fog,
        mode=st.sampled_from(FogMode),
        density=st.sampled_from((0.0, 0.25, 1.0, 3.0)),
        start=distances,
        end=distances,
        color=byte_colors,
        coordinate_source=st.sampled_from(sorted(sources)),
    ).filter(lambda fog: fog.start != fog.end)


@st.composite
def _polygons(draw, primitive):
    """The first vertex provokes where ARB_provoking_vertex and Mesa agree which it is (docs/mesa.md)."""
    return PolygonState(
        cull_face=draw(st.sampled_from((None, None, None, None, *Face))),
        front_face=draw(st.sampled_from(FrontFace)),
        offset_fill=draw(st.booleans()),
        offset_factor=draw(st.sampled_from((0.0, 1.0, -2.0, 0.5))),
        offset_units=draw(st.sampled_from((0.0, 1.0, -4.0, 1000.0, 1e9, -1e9))),
        shade_model=draw(st.sampled_from(ShadeModel)),
        provoking_vertex=draw(st.sampled_from(ProvokingVertex))
        if primitive in _ANY_PROVOKES
        else ProvokingVertex.LAST,
    )


_FORMATS = tuple(f for f, bits in COMPONENT_BITS.items() if set(bits) == {8})  # Mesa keeps others as it likes
_FILTERS = (TextureFilter.NEAREST, TextureFilter.LINEAR)


@st.composite
def textures(draw, profile, name):
    """A texture of one to eight texels along each edge, of noise; with mipmaps or without."""
    targets = profile.textures.texture_targets & {TextureTarget.TEXTURE_1D, TextureTarget.TEXTURE_2D}
    random, mipmaps = np.random.default_rng(draw(seeds)), draw(st.booleans())
    width, height = (1 << draw(st.integers(0, 3)) for _ in range(2))
    internal_format = draw(st.sampled_from(_FORMATS))
    texels = random.choice([0, 255, *range(256)], (height, width, 4)).astype(np.uint8)
    if draw(st.sampled_from(sorted(targets))) is TextureTarget.TEXTURE_1D:
        image = texture_1d(texels[0], internal_format, mipmaps=mipmaps)
    else:
        image = texture_2d(texels, internal_format, mipmaps=mipmaps)
    return TexImage(label="texture", texture=name, image=image)


_dyadic = st.sampled_from((-1.0, -0.5, 0.0, 0.0, 0.25, 0.5, 1.0))
_gens = st.none() | st.builds(
    TexGen, st.sampled_from((TexGenMode.OBJECT_LINEAR, TexGenMode.EYE_LINEAR)), st.tuples(*[_dyadic] * 4)
)


@st.composite
def texture_units(draw, profile, texture, number, exact, aligned):
    """A unit that reads the texture; ``exact``: and hands on a texel's bytes; ``aligned``: all pixels have
    one lambda, and mipmaps may be read.
    """
    image, wraps = texture.image, st.sampled_from(sorted(profile.textures.wrap_modes))
    filters = st.just(TextureFilter.NEAREST) if exact else st.sampled_from(_FILTERS)
    magnified = minified = draw(filters)
    gen, matrix = (TexGen(),) * 4, IDENTITY
    if aligned and not exact:
        complete = len(image.levels) == max(image.width, image.height).bit_length()
        minified = draw(st.sampled_from(TextureFilter if complete else _FILTERS))
    elif draw(st.integers(0, 2)) == 0:
        gen = (draw(_gens) or TexGen(), draw(_gens) or TexGen(), TexGen(), TexGen())
        rows = st.tuples(st.sampled_from((0.5, 1.0, 2.0)), _dyadic)
        (a, b), (c, d) = draw(rows), draw(rows)
        matrix = ((a, 0.0, 0.0, b), (0.0, c, 0.0, d), *IDENTITY[2:])
    environment = TextureEnvironment(TextureEnvironmentMode.REPLACE)
    if not exact:
        environment = random_environment(Random(draw(seeds)), profile, image.internal_format)
    return TextureUnit(
        texture.texture,
        Sampler(minified, magnified, draw(wraps), draw(wraps), border_color=draw(byte_colors)),
        coordinates=number,
        gen=gen,
        matrix=matrix,
        environment=environment,
    )


# A shininess of 0 leaves 0 to the power 0, which is 1 here and 0 in Mesa: docs/mesa.md.
_materials = st.builds(Material, *[byte_colors] * 4, shininess=st.sampled_from((1.0, 2.0, 8.0)))
_lights = st.builds(
    Light,
    ambient=byte_colors,
    diffuse=byte_colors,
    specular=byte_colors,
    position=st.tuples(*[st.floats(-2.0, 2.0, width=32)] * 2, st.just(2.0), st.sampled_from((0.0, 1.0))),
    spot_cutoff=st.sampled_from((180.0, 180.0, 60.0)),
    spot_exponent=st.sampled_from((0.0, 1.0, 4.0)),
    linear_attenuation=st.sampled_from((0.0, 0.5)),
    quadratic_attenuation=st.sampled_from((0.0, 0.25)),
)
# Mesa lights back faces otherwise with BACK than with FRONT_AND_BACK: docs/mesa.md.
_lightings = st.builds(
    Lighting,
    lights=st.lists(_lights, max_size=2).map(tuple),
    front=_materials,
    back=_materials,
    model_ambient=byte_colors,
    local_viewer=st.booleans(),
    two_side=st.booleans(),
    separate_specular_color=st.booleans(),
    color_material=maybe(
        st.builds(
            ColorMaterial,
            st.sampled_from((Face.FRONT, Face.FRONT_AND_BACK)),
            st.sampled_from(ColorMaterialParameter),
        )
    ),
)


def _names_units(unit):
    """Whether an environment reads texels by their unit's number: of a disabled one Mesa has none."""
    sources = {*unit.environment.rgb.sources, *unit.environment.alpha.sources}
    return any(source >= CombineSource.TEXTURE0 for source in sources)


@st.composite
def draws(draw, profile, bitwise, offset, images):
    """A mesh in a whole pass state of the profile; ``bitwise``: perhaps with a logic operation; ``images``:
    TexImages of which each may be a unit's.

    Quads are not lit: their colours would be no planes; nor is what has w other than 1 (docs/mesa.md).
    Logic operations turn a difference of one into any other, so all that is drawn are bytes that nothing
    changes.
    Depths that are tested for equality are exact where they are constant.
    Fog of eye distance gets one sign of z: ours takes the magnitude at vertices, Mesa at fragments.
    With color sum and fog no sum passes one: Mesa does not clamp it before fog (docs/mesa.md).
    """
    logic_op = draw(maybe(st.sampled_from(LogicOperation), 3)) if bitwise else None
    aligned = bool(images) and draw(st.booleans())
    mesh = draw(meshes(exact_colors=bitwise, aligned=aligned))
    lighting = None
    plain = mesh.primitive in TRIANGLES and (mesh.positions[:, 3] == 1.0).all()
    if plain and not bitwise and draw(st.integers(0, 3)) == 0:
        lighting = draw(_lightings)
    polygon, depth_test = draw(_polygons(mesh.primitive)), draw(maybe(_depth_tests))
    if depth_test is not None and depth_test.function in (
        ComparisonFunction.EQUAL,
        ComparisonFunction.NOTEQUAL,
    ):
        polygon = replace(polygon, offset_fill=False)
        z, w = mesh.positions[:, 2], mesh.positions[:, 3]
        if (z == z[0] / w[0] * w).all():
            mesh = replace(
                mesh, positions=np.where([0, 0, 1, 0], np.sign(z - 0.1)[:, None] * w[:, None], mesh.positions)
            )
    if not offset:
        polygon = replace(polygon, offset_fill=False)
    color_sum = profile.fragments.color_sum and lighting is None and draw(st.booleans())
    fog = draw(maybe(_fogs(profile))) if not bitwise else None
    if (color_sum and images) or (lighting is not None and lighting.separate_specular_color):
        fog = None
    if color_sum and fog is not None:
        mesh = replace(mesh, colors=mesh.colors / 2.0, secondary_colors=mesh.secondary_colors / 2.0)
    if fog is not None and fog.coordinate_source is FogCoordinateSource.FRAGMENT_DEPTH:
        mesh = replace(
            mesh,
            positions=mesh.positions * (1.0, 1.0, 0.5, 1.0) - mesh.positions[:, 3:] * (0.0, 0.0, 0.5, 0.0),
        )
    units = [draw(texture_units(profile, image, i, bitwise, aligned)) for i, image in enumerate(images)]
    if not any(map(_names_units, units)):
        units = [unit if draw(st.integers(0, 3)) else None for unit in units]
    state = PassState(
        texture_units=tuple(units),
        vertex=VertexState(
            lighting=lighting,
            normalize=lighting is not None,
            viewport=draw(
                st.sampled_from(
                    (Viewport(),) * 4 + (Viewport(near=1.0, far=0.0), Viewport(near=0.25, far=0.75))
                )
            ),
        ),
        polygon=polygon,
        color_sum=color_sum,
        fog=fog,
        scissor=draw(st.none() | st.none() | st.none() | _scissors),
        alpha_test=draw(st.none() | st.none() | _alpha_tests),
        stencil_test=draw(maybe(_stencil_tests(profile))),
        depth_test=depth_test,
        blending=draw(maybe(_blendings(profile))) if logic_op is not None or not bitwise else None,
        logic_op=logic_op,
        color_mask=draw(_color_masks),
    )
    return Draw(label="draw", mesh=mesh, state=state)


# ----------------------------------------------------------------------------------------------------- frames


@st.composite
def _clears(draw, whole):
    """``whole``: everything; or a part of the buffers in a part of the screen, through masks."""
    depth = st.sampled_from((0.0, 0.25, 0.5, 0.75, 1.0))
    if whole:
        return Clear(label="clear", color=draw(byte_colors), depth=draw(depth), stencil=draw(_bytes))
    return Clear(
        label="clear a part",
        color=draw(maybe(byte_colors, 3)),
        depth=draw(maybe(depth, 3)),
        stencil=draw(maybe(_bytes, 3)),
        scissor=draw(_scissors),
        color_mask=draw(_color_masks),
        stencil_write_mask=draw(st.just(255) | _bytes),
    )


@st.composite
def frames(draw, profile, offset=True, textured=False):
    """Rectangles of colours, depths and stencil values, and one or two passes over them, ``textured`` or not.

    ``offset``: whether there may be a polygon offset; where the driver clamps at vertices what it gives,
    which section 3.5.5 allows, there may not.
    """
    clears = [draw(_clears(i == 0)) for i in range(draw(st.integers(1, 3)))]
    bitwise = draw(st.integers(0, 5)) == 5
    images = ()
    if textured:
        images = tuple(
            draw(textures(profile, f"texture {i}")) for i in range(profile.textures.max_texture_units)
        )
    return (
        *images,
        *clears,
        *(draw(draws(profile, bitwise, offset, images)) for _ in range(draw(st.integers(1, 2)))),
    )


@st.composite
def anywhere(draw):
    """Triangles of any vertices, on, beside and behind the screen, each fragment counted in the stencil.

    One colour and one depth for all: what lies between moved vertices shows nowhere.
    """
    random = np.random.default_rng(draw(seeds))
    count = draw(st.integers(3, 12))
    reach = draw(st.sampled_from((1.1, 1.1, 2.0, 20.0)))
    w = np.ones(count)
    kind = draw(st.sampled_from(("flat", "flat", "perspective", "behind")))
    if kind != "flat":
        w = np.exp(random.uniform(-2.0, 2.0, count))
    positions = random.uniform(-reach, reach, (count, 4)) * w[:, None]
    positions[:, 2:] = np.stack([0.25 * w, w], -1)
    if kind == "behind":  # the near plane cuts where z = -w
        positions[:, 2] = random.uniform(-2.0, 1.0, count) * w
    mesh = Mesh(np.float32(positions), draw(st.sampled_from(TRIANGLES[:3])))
    count_up = StencilTest(depth_pass=StencilOperation.INCR)
    polygon = PolygonState(cull_face=draw(st.sampled_from((None, None, *Face))))
    return (Draw(label="draw", mesh=mesh, state=PassState(polygon=polygon, stencil_test=count_up)),)


@st.composite
def strokes(draw):
    """Lines and points of width and size 1, each fragment counted in the stencil.

    x in odd eighths and y in odd sixteenths of a pixel: no vertex lies on the boundary of a diamond or of a
    pixel, where OpenGL's rules ask for the vertex to be moved by an infinitesimal, up or down.
    """
    random = np.random.default_rng(draw(seeds))
    primitives = (
        PrimitiveType.LINES,
        PrimitiveType.LINE_STRIP,
        PrimitiveType.LINE_LOOP,
        PrimitiveType.POINTS,
    )
    count = draw(st.integers(2, 8))
    x = (2 * random.integers(0, 4 * WIDTH, count) + 1) / 8.0
    y = (2 * random.integers(0, 8 * HEIGHT, count) + 1) / 16.0
    positions = np.stack([2.0 * x / WIDTH - 1.0, 2.0 * y / HEIGHT - 1.0], -1)
    count_up = StencilTest(depth_pass=StencilOperation.INCR)
    mesh = Mesh(positions, draw(st.sampled_from(primitives)))
    return (Draw(label="draw", mesh=mesh, state=PassState(stencil_test=count_up)),)
