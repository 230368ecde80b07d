"""Hypothesis strategies of whole frames that a GeForce 256 can draw: states, textures, meshes.

Structure is drawn by Hypothesis, so that it shrinks; bulk data (texels, vertices) comes from a drawn seed.
"""

from dataclasses import dataclass, replace
from random import Random

import numpy as np
from hypothesis import strategies as st

from fixedpipe.pipeline.commands import (
    BindTexImage,
    Clear,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    MakeCurrent,
    Mesh,
    ReadPixels,
    TexImage,
)
from fixedpipe.pipeline.enums import (
    ColorFormat,
    ComparisonFunction,
    ComponentUsage,
    Face,
    FogCoordinateSource,
    FogMode,
    FrontFace,
    LineRasterization,
    LogicOperation,
    PolygonMode,
    PrimitiveType,
    ProvokingVertex,
    Register,
    ShadeModel,
    StencilOperation,
    TextureFilter,
    TextureTarget,
    WindowOrigin,
    WrapMode,
)
from fixedpipe.pipeline.profiles import GEFORCE_256, NV2A
from fixedpipe.pipeline.state import (
    IDENTITY,
    AlphaTest,
    Blending,
    ColorMask,
    CombinerInput,
    DepthClamp,
    DepthTest,
    FinalCombiner,
    Fog,
    GeneralCombiner,
    Light,
    Lighting,
    LineState,
    PassState,
    PointParameters,
    PointState,
    PolygonState,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    Scissor,
    StencilTest,
    TextureUnit,
    VertexState,
    Viewport,
    WindowClip,
)
from fixedpipe.pipeline.textures.images import COMPONENT_BITS, texture_1d, texture_2d, texture_cube_map
from fixedpipe.pipeline.textures.pixel_formats import READABLE_AS
from tests.support.combiner_strategies import colors, register_combiners
from tests.support.random_environments import random_environment

seeds = st.integers(0, 2**32 - 1)
POLYGONS = tuple(p for p in PrimitiveType if p < PrimitiveType.POINTS)


def maybe(strategy):
    """None half of the time."""
    return st.none() | strategy


# --------------------------------------------------------------------------------------------------- textures


@dataclass(frozen=True)
class NamedTexture:
    """A texture object with its name."""

    name: str
    image: object


def _noise(seed, shape):
    """Random bytes in which 0 and 255 are frequent."""
    random = np.random.default_rng(seed)
    image = random.integers(0, 256, shape)
    extreme = random.random(shape) < 0.25
    return np.where(extreme, random.choice([0, 255], shape), image).astype(np.uint8)


@st.composite
def textures(draw, name):
    """Small textures of every target and internal format, with or without mipmaps."""
    target = draw(st.sampled_from(sorted(GEFORCE_256.textures.texture_targets)))
    internal_format = draw(st.sampled_from(sorted(COMPONENT_BITS)))
    seed, mipmaps = draw(seeds), draw(st.sampled_from((True, True, False)))
    width, height = (1 << draw(st.integers(0, 3)) for _ in range(2))
    if target is TextureTarget.TEXTURE_1D:
        image = texture_1d(_noise(seed, (width, 4)), internal_format, mipmaps=mipmaps)
    elif target is TextureTarget.TEXTURE_2D:
        image = texture_2d(_noise(seed, (height, width, 4)), internal_format, mipmaps=mipmaps)
    else:
        image = texture_cube_map(_noise(seed, (6, width, width, 4)), internal_format, mipmaps=mipmaps)
    return NamedTexture(name, image)


_UNMIPMAPPED = (TextureFilter.NEAREST, TextureFilter.LINEAR)


@st.composite
def texture_units(draw, texture):
    """A unit that reads the texture with any filter, wrap mode, bias and border color it may have."""
    image = texture.image
    complete = len(image.levels) == max(image.width, image.height).bit_length()
    sampler = Sampler(
        min_filter=draw(st.sampled_from(TextureFilter if complete else _UNMIPMAPPED)),
        mag_filter=draw(st.sampled_from(_UNMIPMAPPED)),
        wrap_s=draw(st.sampled_from(WrapMode)),
        wrap_t=draw(st.sampled_from(WrapMode)),
        border_color=draw(colors),
    )
    scale = draw(st.sampled_from((1.0, 1.0, 0.25, 7.0)))
    matrix = tuple(tuple(scale * v for v in row) if i < 2 else row for i, row in enumerate(IDENTITY))
    limit = GEFORCE_256.textures.max_lod_bias
    bias = draw(st.sampled_from((0.0, 0.0, 0.5, -0.5)) | st.floats(-limit, limit))
    return TextureUnit(
        texture.name, sampler, lod_bias=bias, coordinates=draw(st.integers(0, 1)), matrix=matrix
    )


def texture_environments(image):
    """Environments of the GeForce 256 for a unit that reads the image."""
    return seeds.map(lambda seed: random_environment(Random(seed), GEFORCE_256, image.internal_format))


# ----------------------------------------------------------------------------------------------------- states

_factors_source = st.sampled_from(sorted(GEFORCE_256.fragments.blend_factors_source))
_factors_destination = st.sampled_from(sorted(GEFORCE_256.fragments.blend_factors_destination))
_bytes = st.integers(0, 255)
_functions = st.sampled_from(ComparisonFunction)
_operations = st.sampled_from(StencilOperation)

alpha_tests = st.builds(AlphaTest, _functions, _bytes.map(lambda b: b / 255.0) | st.floats(-0.5, 1.5))
stencil_tests = st.builds(
    StencilTest,
    function=_functions,
    reference=st.integers(-5, 300),
    mask=st.just(255) | _bytes,
    fail=_operations,
    depth_fail=_operations,
    depth_pass=_operations,
    write_mask=st.just(255) | _bytes,
)
depth_tests = st.builds(DepthTest, _functions, st.booleans())


def blendings(nv2a=False):
    """Factors, equations and constants of the GeForce 256, or of the NV2A."""
    profile = NV2A if nv2a else GEFORCE_256
    return st.builds(
        Blending,
        source=_factors_source,
        destination=_factors_destination,
        equation=st.sampled_from(sorted(profile.fragments.blend_equations)),
        color=colors,
    )


color_masks = st.just(ColorMask()) | st.builds(
    ColorMask, st.booleans(), st.booleans(), st.booleans(), st.booleans()
)
polygons = st.builds(
    PolygonState,
    cull_face=st.sampled_from((None, None, None, None, None, *Face)),
    front_face=st.sampled_from(FrontFace),
    offset_fill=st.booleans(),
    offset_factor=st.floats(-4.0, 4.0),
    offset_units=st.sampled_from((0.0, 1.0, -3.5, 1e9, -1e12)) | st.floats(-1e4, 1e4),
    shade_model=st.sampled_from(ShadeModel),
    provoking_vertex=st.sampled_from(ProvokingVertex),
)
_distances = st.sampled_from((0.0, 1.0, 2.0, -1.0)) | st.floats(-4.0, 4.0)
fogs = st.builds(
    Fog,
    mode=st.sampled_from(FogMode),
    density=st.sampled_from((0.0, 1.0)) | st.floats(0.0, 5.0),
    start=_distances,
    end=_distances,
    color=colors,
    coordinate_source=st.sampled_from(FogCoordinateSource),
).filter(lambda fog: fog.start != fog.end)
lightings = st.builds(
    Lighting,
    lights=st.just((Light(position=(0.3, 0.2, 1.0, 0.0)),)),
    model_ambient=colors,
    two_side=st.booleans(),
    separate_specular_color=st.booleans(),
)


def scissors(width, height):
    """Boxes that may reach over the screen's border, or miss it."""
    return st.builds(
        Scissor,
        st.integers(-3, width),
        st.integers(-3, height),
        st.just(width) | st.integers(0, width + 5),
        st.just(height) | st.integers(0, height + 5),
    )


def viewports(width, height):
    """The whole framebuffer, or another rectangle, also with another depth range."""
    whole = st.just(Viewport())
    return (
        whole
        | whole
        | st.builds(
            Viewport,
            st.integers(-5, 5),
            st.integers(-5, 5),
            st.integers(1, 2 * width),
            st.integers(1, 2 * height),
            st.floats(0.0, 1.0),
            st.floats(0.0, 1.0),
        )
    )


_limits = st.sampled_from((0.0, 0.25, 1.0, 2.5, 300.0, 40000.0, 2.0**23, 2.0**25))
depth_clamps = st.builds(
    lambda limits, maximum, cull: DepthClamp(min(limits), max(limits) if maximum else None, cull),
    st.tuples(_limits, _limits),
    st.booleans(),
    st.booleans(),
)


@st.composite
def pass_states(draw, width, height, available, max_stages=2, nv2a=False):
    """Whole pass states; ``available`` are the textures that the units may read."""
    vertex = VertexState(
        viewport=draw(viewports(width, height)), lighting=draw(st.none() | st.none() | lightings)
    )
    combiners = None
    if draw(st.integers(0, 5)) > 0:
        combiners = draw(register_combiners(max_stages, 2, nv2a, nv2a))
    chosen = [draw(st.sampled_from(available)) for _ in range(2)]
    units = tuple(draw(st.none() | texture_units(texture)) for texture in chosen)
    if combiners is None:
        units = tuple(
            unit and replace(unit, environment=draw(texture_environments(texture.image)))
            for unit, texture in zip(units, chosen, strict=True)
        )
    return PassState(
        vertex=vertex,
        polygon=draw(polygons),
        texture_units=units,
        register_combiners=combiners,
        color_sum=draw(st.booleans()),
        fog=draw(maybe(fogs)),
        scissor=draw(st.none() | st.none() | st.none() | scissors(width, height)),
        alpha_test=draw(st.none() | st.none() | alpha_tests),
        stencil_test=draw(maybe(stencil_tests)),
        depth_test=draw(maybe(depth_tests)),
        blending=draw(maybe(blendings(nv2a))),
        logic_op=draw(st.none() | st.none() | st.sampled_from(LogicOperation)),
        color_mask=draw(color_masks),
        depth_clamp=draw(maybe(depth_clamps)) if nv2a else None,
        ycbcr_conversion=nv2a and draw(st.booleans()),
        w_buffering=nv2a and draw(st.booleans()),
    )


# ----------------------------------------------------------------------------------------------------- meshes


_COORDINATES = ("any", "aligned", "large", "grid", "constant", "projective", "zero")


def _positions(random, kind, count, width, height):
    """Clip coordinates [count, 4] on and around the screen, far outside it, behind the eye."""
    pixels = random.uniform(-0.5, 1.5, (count, 2)) * (width, height)
    if kind == "grid":
        pixels = np.round(pixels * 2.0) / 2.0
    elif kind == "huge":
        pixels = random.uniform(-1.0, 1.0, (count, 2)) * random.choice([20.0, 500.0, 30000.0], (count, 1))
    elif kind == "degenerate":
        pixels[:, 1] = pixels[:, 0] * height / width
    w = np.ones(count)
    if kind in ("perspective", "near"):
        w = np.exp(random.uniform(-2.0, 2.0, count))
    z = random.uniform(-1.0, 1.0, count)
    if kind == "near":
        z = random.uniform(-1.6, 1.6, count)
        w = np.where(random.random(count) < 0.3, -w, w)
    if kind == "grid":
        z = np.round(z * 4.0) / 4.0
    x, y = (2.0 * pixels / (width, height) - 1.0).T
    return np.stack([x * w, y * w, z * w, w], -1)


def _texture_coordinates(random, kind, positions, width, height):
    """(s, t, r, q): near the texture, repeated many times, on texel boundaries; q other than one for some.

    "aligned": so many texels a pixel along both axes, where lambda and texels have their ties.
    """
    count = len(positions)
    coordinates = random.uniform(-1.5, 1.5, (count, 4))
    if kind == "large":
        coordinates *= 40.0
    elif kind == "grid":
        coordinates = np.round(coordinates * 8.0) / 8.0
    elif kind == "constant":
        coordinates[:] = coordinates[:1]
    elif kind == "aligned":
        texels = random.choice([0.25, 0.5, 1.0, 2.0, 4.0, 2.0**0.5, 8.0**0.5], 2)
        pixels = (positions[:, :2] / positions[:, 3:] + 1.0) * (width / 2, height / 2)
        coordinates[:, :2] = pixels * texels / random.choice([1, 2, 4, 8])
    if kind == "zero":
        coordinates[:, 3] = random.choice([0.0, 1.0], count, p=[0.8, 0.2])
    elif kind != "projective":
        coordinates[:, 3] = 1.0
    return coordinates


@st.composite
def meshes(draw, width, height):
    """Triangles that share edges and vertices, on and across the screen's border and the near plane."""
    kind = draw(
        st.sampled_from(("any", "grid", "perspective", "near", "any", "perspective", "huge", "degenerate"))
    )
    random = np.random.default_rng(draw(seeds))
    primitive = draw(st.sampled_from(POLYGONS))
    count, indexed = draw(st.integers(3, 9)), draw(st.booleans())
    colors = (
        random.choice([0.0, 0.25, 0.5, 1.0], (count, 4)) if draw(st.booleans()) else random.random((count, 4))
    )
    if draw(st.integers(0, 3)) == 0:
        colors[:] = colors[:1]
    normals = random.uniform(-1.0, 1.0, (count, 3))
    positions = _positions(random, kind, count, width, height)
    if draw(st.sampled_from((True, True, False))):  # the first triangle covers most of the screen
        corners = np.array([[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]])[random.permutation(3)]
        moved = 0.0 if kind == "grid" else random.uniform(-0.2, 0.2, (3, 2))
        positions[:3, :2] = (corners + moved) * positions[:3, 3:]
    return Mesh(
        positions,
        primitive,
        indices=np.append([0, 1, 2], random.integers(0, count, draw(st.integers(0, 9)))) if indexed else None,
        colors=colors,
        secondary_colors=random.random((count, 4)),
        normals=normals,
        texture_coordinates=tuple(
            _texture_coordinates(random, draw(st.sampled_from(_COORDINATES)), positions, width, height)
            for _ in range(2)
        ),
        fog_coordinates=random.uniform(-2.0, 4.0, count),
    )


# ----------------------------------------------------------------------------------------------------- frames


def _clears(width, height):
    return st.builds(
        Clear,
        label=st.just("clear"),
        color=maybe(colors),
        depth=maybe(st.floats(0.0, 1.0)),
        stencil=maybe(_bytes),
        scissor=st.none() | st.none() | scissors(width, height),
        color_mask=color_masks,
        stencil_write_mask=st.just(255) | _bytes,
    )


@st.composite
def _copies(draw, width, height):
    """CopyTexImage of a rectangle with edges that are powers of two."""
    w, h = (1 << draw(st.integers(0, 2)) for _ in range(2))
    x, y = draw(st.integers(0, width - w)), draw(st.integers(0, height - h))
    return CopyTexImage(
        label="copy",
        texture="copied",
        target=TextureTarget.TEXTURE_1D if h == 1 and draw(st.booleans()) else TextureTarget.TEXTURE_2D,
        internal_format=draw(st.sampled_from(sorted(COMPONENT_BITS))),
        x=x,
        y=y,
        width=w,
        height=h,
        generate_mipmap=draw(st.booleans()),
    )


@st.composite
def _replacements(draw, width, height, texture):
    """CopyTexSubImage of a rectangle inside any level and face of a texture."""
    level = draw(st.integers(0, len(texture.image.levels) - 1))
    faces, rows, columns = texture.image.levels[level].shape[:3]
    w, h = draw(st.integers(0, min(columns, width))), draw(st.integers(0, min(rows, height)))
    return CopyTexSubImage(
        label="replace",
        texture=texture.name,
        x_offset=draw(st.integers(0, columns - w)),
        y_offset=draw(st.integers(0, rows - h)),
        x=draw(st.integers(0, width - w)),
        y=draw(st.integers(0, height - h)),
        width=w,
        height=h,
        level=level,
        face=draw(st.integers(0, faces - 1)),
        generate_mipmap=level == 0 and draw(st.booleans()),
    )


SHOW_TEXTURE = RegisterCombiners(
    final=FinalCombiner(
        a=CombinerInput(),
        b=CombinerInput(),
        c=CombinerInput(Register.TEXTURE0),
        g=CombinerInput(Register.TEXTURE0, usage=ComponentUsage.ALPHA),
    )
)


def _one_of(random, choices):
    """One of a sequence or of an enumeration's members."""
    choices = list(choices)
    return choices[random.integers(len(choices))]


def textured_frame(seed, width, height):
    """A texture under any sampler on a random mesh, shown as it is: every choice is equally frequent."""
    random = np.random.default_rng(seed)
    sizes, mipmaps = 1 << random.integers(0, 5, 2), random.random() < 0.8
    internal_format = _one_of(random, COMPONENT_BITS)
    target = _one_of(random, sorted(GEFORCE_256.textures.texture_targets))
    texels = random.integers(0, 256, (6, *sizes, 4), np.uint8)
    if target is TextureTarget.TEXTURE_1D:
        image = texture_1d(texels[0, 0], internal_format, mipmaps=mipmaps)
    elif target is TextureTarget.TEXTURE_2D:
        image = texture_2d(texels[0], internal_format, mipmaps=mipmaps)
    else:
        image = texture_cube_map(texels[:, : sizes.min(), : sizes.min()], internal_format, mipmaps=mipmaps)
    sampler = Sampler(
        min_filter=_one_of(random, TextureFilter if mipmaps else _UNMIPMAPPED),
        mag_filter=_one_of(random, _UNMIPMAPPED),
        wrap_s=_one_of(random, WrapMode),
        wrap_t=_one_of(random, WrapMode),
        border_color=tuple(random.random(4).tolist()),
        max_anisotropy=2.0 if target is TextureTarget.TEXTURE_2D and random.random() < 0.25 else 1.0,
    )
    bias = float(random.choice([0.0, 0.5, -0.5, 1.5, random.uniform(-4.0, 4.0)]))
    positions = _positions(random, _one_of(random, ("any", "grid", "perspective", "near")), 6, width, height)
    coordinates = _texture_coordinates(random, _one_of(random, _COORDINATES), positions, width, height)
    mesh = Mesh(positions, PrimitiveType.TRIANGLE_STRIP, texture_coordinates=(coordinates,))
    unit = TextureUnit("texture", sampler, lod_bias=bias)
    state = PassState(texture_units=(unit,), register_combiners=SHOW_TEXTURE)
    return (
        TexImage(label="texture", texture="texture", image=image),
        Draw(label="show the texture", mesh=mesh, state=state),
    )


def shaded_frame(seed, width, height):
    """Facing, shading, lighting, fog, depth and offset without textures: every choice is equally frequent."""
    random = np.random.default_rng(seed)
    kind = _one_of(random, ("any", "grid", "perspective", "near"))
    mesh = Mesh(
        _positions(random, kind, 7, width, height),
        _one_of(random, POLYGONS),
        colors=random.random((7, 4)),
        secondary_colors=random.random((7, 4)),
        normals=random.uniform(-1.0, 1.0, (7, 3)),
        fog_coordinates=random.uniform(-1.0, 2.0, 7),
    )
    light = Light(position=(*random.uniform(-1.0, 1.0, 3).tolist(), 0.0))
    lighting = Lighting(
        lights=(light,), two_side=bool(random.integers(2)), separate_specular_color=bool(random.integers(2))
    )
    fog = Fog(
        mode=_one_of(random, FogMode),
        color=tuple(random.random(4).tolist()),
        coordinate_source=_one_of(random, FogCoordinateSource),
    )
    state = PassState(
        vertex=VertexState(lighting=_one_of(random, (None, lighting, lighting))),
        polygon=PolygonState(
            cull_face=_one_of(random, (None, None, Face.FRONT, Face.BACK)),
            front_face=_one_of(random, FrontFace),
            offset_fill=bool(random.integers(2)),
            offset_factor=random.uniform(-2.0, 2.0),
            offset_units=random.uniform(-100.0, 100.0),
            shade_model=_one_of(random, ShadeModel),
            provoking_vertex=_one_of(random, ProvokingVertex),
        ),
        color_sum=bool(random.integers(2)),
        fog=_one_of(random, (None, fog)),
        depth_test=DepthTest(_one_of(random, (ComparisonFunction.LESS, ComparisonFunction.ALWAYS))),
    )
    return (Draw(label="shade", mesh=mesh, state=state),)


def stroked_frame(seed, width, height):
    """Points, lines and outlines of any size on a textured sprite unit, for the NV2A."""
    random = np.random.default_rng(seed)
    count = 8
    kind = _one_of(random, ("any", "grid", "perspective", "near"))
    positions = _positions(random, kind, count, width, height)
    coordinates = _texture_coordinates(random, _one_of(random, _COORDINATES), positions, width, height)
    mesh = Mesh(
        positions,
        _one_of(random, PrimitiveType),
        colors=random.random((count, 4)),
        texture_coordinates=(coordinates,),
        fog_coordinates=random.uniform(-1.0, 2.0, count),
        edge_flags=_one_of(random, (None, random.random(count) < 0.7)),
    )
    texels = random.integers(0, 256, (4, 8, 4), np.uint8)
    sampler = Sampler(_one_of(random, TextureFilter), _one_of(random, _UNMIPMAPPED))
    unit = TextureUnit("texture", sampler, coord_replace=bool(random.integers(2)))
    product = GeneralCombiner(
        rgb=RGBPortion(a=CombinerInput(Register.PRIMARY_COLOR), b=CombinerInput(Register.TEXTURE3))
    )
    parameters = PointParameters(
        tuple(random.choice([0.0, 0.25, 1.0], 3).tolist()),
        random.uniform(-0.5, 0.5),
        random.uniform(0.0, 9.0),
        0.5,
    )
    box = Scissor(*random.integers(-2, 6, 2).tolist(), *random.integers(0, 9, 2).tolist())
    state = PassState(
        polygon=PolygonState(
            cull_face=_one_of(random, (None, None, *Face)),
            front_face=_one_of(random, FrontFace),
            offset_fill=bool(random.integers(2)),
            offset_line=bool(random.integers(2)),
            offset_point=bool(random.integers(2)),
            offset_factor=random.uniform(-2.0, 2.0),
            offset_units=random.uniform(-100.0, 100.0),
            shade_model=_one_of(random, ShadeModel),
            provoking_vertex=_one_of(random, ProvokingVertex),
            front_mode=_one_of(random, PolygonMode),
            back_mode=_one_of(random, PolygonMode),
            stipple=_one_of(random, (None, random.integers(0, 256, 128, np.uint8).tobytes())),
        ),
        texture_units=(None, None, None, unit),
        register_combiners=RegisterCombiners(general=(product,)),
        fog=_one_of(random, (None, Fog(mode=FogMode.LINEAR))),
        depth_test=DepthTest(_one_of(random, (ComparisonFunction.LESS, ComparisonFunction.ALWAYS))),
        point=PointState(
            size=float(_one_of(random, (0.0, 1.0, 2.0, 3.5, random.uniform(0.0, 12.0)))),
            sprite=bool(random.integers(2)),
            parameters=_one_of(random, (None, parameters)),
        ),
        line=LineState(
            width=float(_one_of(random, (0.0, 1.0, 1.0, 3.0, random.uniform(0.0, 6.0)))),
            rasterization=_one_of(random, LineRasterization),
        ),
        window_clip=_one_of(random, (None, None, WindowClip((box, Scissor(1, 1, 3, 3)), bool(seed % 2)))),
    )
    image = texture_2d(texels, mipmaps=True)
    return (
        TexImage(label="texture", texture="texture", image=image),
        Draw(label="strokes", mesh=mesh, state=state),
    )


_COLOR_FORMATS = ("RGBA", "RGB", "RED", "GREEN", "BLUE", "ALPHA", "LUMINANCE", "LUMINANCE_ALPHA")
_READ_FORMATS = (*_COLOR_FORMATS, "DEPTH_COMPONENT", "STENCIL_INDEX")


@st.composite
def _reads(draw, width, height):
    x, y = draw(st.integers(0, width - 1)), draw(st.integers(0, height - 1))
    return ReadPixels(
        label="read",
        name="read",
        format=draw(st.sampled_from(_READ_FORMATS)),
        x=x,
        y=y,
        width=draw(st.integers(0, width - x)),
        height=draw(st.integers(0, height - y)),
    )


@st.composite
def _pbuffers(draw, width, height):
    return MakeCurrent(
        label="pbuffer",
        surface="pbuffer",
        width=width,
        height=height,
        color_format=draw(st.sampled_from(ColorFormat)),
        depth_bits=draw(st.sampled_from((16, 24))),
    )


@st.composite
def _bound(draw, surface):
    return BindTexImage(
        label="bind",
        texture="bound",
        surface=surface.surface,
        internal_format=draw(st.sampled_from(READABLE_AS[surface.color_format])),
        origin=draw(st.sampled_from(WindowOrigin)),
    )


def solid_texture(width, height, internal_format):
    """A black texture of that size and format."""
    return texture_2d(np.zeros((height, width, 4), np.uint8), internal_format)


@st.composite
def frames(draw, width, height, max_stages=2, nv2a=False):
    """Two textures, Clear, a Draw, copies into textures, a second Draw over the first, ReadPixels."""
    first, second = draw(textures("first")), draw(textures("second"))
    available = [first, second]

    def one_draw(label):
        state = draw(pass_states(width, height, available, max_stages, nv2a))
        return Draw(label=label, mesh=draw(meshes(width, height)), state=state)

    commands = [TexImage(label=t.name, texture=t.name, image=t.image) for t in available]
    surface = draw(_pbuffers(width, height)) if nv2a and draw(st.booleans()) else None
    commands += [surface] if surface else []
    commands += [draw(_clears(width, height)), one_draw("first draw")]
    if surface:
        commands.append(draw(_bound(surface)))
        available.append(NamedTexture("bound", solid_texture(width, height, commands[-1].internal_format)))
        commands += draw(st.sampled_from(([], [MakeCurrent(label="window")])))
    if draw(st.booleans()):
        copy = draw(_copies(width, height))
        commands.append(copy)
        image = solid_texture(copy.width, copy.height, copy.internal_format)
        available.append(NamedTexture("copied", image))
    if second.image.target is not TextureTarget.TEXTURE_1D and draw(st.booleans()):
        commands.append(draw(_replacements(width, height, second)))
    commands += [one_draw("second draw"), draw(_reads(width, height))]
    return tuple(commands)
