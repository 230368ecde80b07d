"""A draw call, whole: triangles, lines and points to pixels, one fragment at a time, in draw order."""

import math
from dataclasses import dataclass, field
from functools import partial
from itertools import product
from types import SimpleNamespace

from fixedpipe.pipeline.enums import (
    ColorFormat,
    ColorWeights,
    FogArithmetic,
    LineRasterization,
    ShadeModel,
    TextureCompareMode,
    TextureShaderOperation,
    TextureTarget,
)
from tests.reference import (
    color_key,
    combine,
    coverage,
    depth,
    fixed,
    fog,
    interpolate,
    per_fragment,
    roughness,
    sample,
    shadow,
    signed_formats,
    strokes,
    texel_words,
    texture_environment,
    texture_shader,
    w_slope,
)
from tests.reference.strokes import LINE, POINT, TRIANGLE

# Assumed: no real scene has such a 1/w; beyond it the products of docs/numbers.md section 4 would overflow.
SMALLEST_INVERSE_W, LARGEST_INVERSE_W = 2.0**-400, 2.0**400


@dataclass
class Target:
    """A framebuffer as nested lists, top row first: RGBA in units of 1/one, depth units, stencil; whether
    blending clamps to [0, 1].
    """

    width: int
    height: int
    depth_bits: int
    color: list = field(default_factory=list)
    depth: list = field(default_factory=list)
    stencil: list = field(default_factory=list)
    color_format: ColorFormat = ColorFormat.A8R8G8B8
    one: int = 255
    clamped: bool = True

    def __post_init__(self):
        """Zero color, the farthest depth, stencil zero. Assumed: OpenGL leaves a new buffer undefined."""
        if not self.color:
            self.color = [[[0, 0, 0, 0] for _ in range(self.width)] for _ in range(self.height)]
            self.depth = [[depth.full_scale(self.depth_bits)] * self.width for _ in range(self.height)]
            self.stencil = [[0] * self.width for _ in range(self.height)]


def plain(columns):
    """An array or nested sequence as lists of Python numbers. Assumed: nothing, the container changes."""
    return columns.tolist() if hasattr(columns, "tolist") else columns


def plain_texture(texture, fraction_bits=8):
    """A texture whose levels are nested lists. Assumed: nothing, only the container changes."""
    return SimpleNamespace(
        bits=getattr(texture, "bits", 8),
        fraction_bits=fraction_bits,
        target=texture.target,
        internal_format=texture.internal_format,
        levels=[plain(level) for level in texture.levels],
        border=getattr(texture, "border", 0),
    )


def vertex_colors(primitives, vertices, provoking, back, polygon):
    """Three vertices' eight color bytes. Source: OpenGL 1.2.1 sections 2.13.1 (two sides), 2.13.7 (flat)."""
    side = 1 if back and primitives.two_side else 0
    if polygon.shade_model == ShadeModel.FLAT:
        vertices = [provoking] * 3
    return [primitives.colors[v][side] for v in vertices]


def iterated_fog(v, weights, profile):
    """Fog at a pixel. Measured: as texture coordinates under TABLE (Fog_gen, 5797440 of 5797465 pixels)."""
    if profile.arithmetic.fog_arithmetic == FogArithmetic.TABLE:
        return interpolate.iterate_coordinate(v, weights)
    return interpolate.iterate(v, weights.b0, weights.b2)


def shade(primary, secondary, fog_coordinate, texels, state, textures, profile, bits=8):
    """A fragment's color after texturing: the register combiners, or texture environments, color sum and fog.

    Source: NV_register_combiners section 3.8.12; OpenGL 1.2.1 sections 3.8.9, 3.9, 3.10.
    """
    machine = combine.machine_of(profile, bits)
    texels = signed_formats.as_colors(texels, state, textures, profile)
    fog_color = fixed.color_codes(state.fog.color) if state.fog else [0, 0, 0, 0]
    factor = fog.fog_factor(fog_coordinate, state.fog, profile) if state.fog else machine.one
    if state.register_combiners is not None:
        fog_register = [*fog_color[:3], factor]
        registers = combine.initial_registers(primary, secondary, texels, fog_register, machine.one)
        return combine.combine(state.register_combiners, registers, machine)
    color = texture_environment.textured_color(primary, texels, state, textures, profile)
    lighting = state.vertex.lighting
    if state.color_sum or (lighting is not None and lighting.separate_specular_color):
        color = fog.add_secondary(color, secondary)
    return fog.blend_with_fog(color, fog_color, factor) if state.fog else color


class Access:
    """A fragment's texture accesses: at a unit's own coordinates, in units of 1/one, or at those that a
    texture shader made, in bytes.

    Source: OpenGL 1.2.1 section 3.8; NV_texture_shader.
    """

    def __init__(self, state, triangles, pixel, weights, textures, profile, one):
        self.state, self.triangles, self.pixel = state, triangles, pixel
        self.weights, self.textures, self.profile, self.one = weights, textures, profile, one

    def __call__(self, i, made, operation, rough=None):
        """Unit i's texel, four numbers; ``rough``: the lookup's Jacobian and deviations.

        Source: docs/numbers.md sections 6, 7 and 12.
        """
        unit = self.state.texture_units[i]
        texture, unit = shadow.as_colors(
            self.textures[unit.texture], unit, self.state.register_combiners, self.profile
        )
        texture = color_key.left(texture, unit)
        foreign = texture.target != TextureTarget.TEXTURE_CUBE_MAP
        if foreign and operation == TextureShaderOperation.TEXTURE_CUBE_MAP:
            made = sample.iterate_coordinates(self.triangles[i].coordinates, self.weights)
        triangle = self.triangles[i]
        if unit.sampler.compare_mode != TextureCompareMode.NONE:
            own = sample.iterate_coordinates(triangle.coordinates, self.weights)
            divided = made is None and triangle.divided
            mode, depth_format = unit.sampler.compare_mode, texture.internal_format
            word = shadow.reference_word(own, divided, depth_format, mode, self.profile)
            texture, unit = shadow.compared(texture, unit, word, self.profile)
        if rough is not None:
            found = roughness.footprint(
                self.triangles, i, operation, self.pixel, *rough, texture, unit.sampler
            )
            texel = roughness.sample_rough(made[:2], found, texture, unit, operation, self.profile)
            return sample.to_register(texel, unit.sampler)
        if made is not None:
            texel = texture_shader.sample_made(made, texture, unit.sampler, operation, self.profile)
            return sample.to_register(texel, unit.sampler)
        return self._own(i, texture, unit)

    def ends(self, i):
        """Whether unit i's color key ends the fragment. Source: as color_key.ends."""
        unit = self.state.texture_units[i]
        return self._own(i, *color_key.ends(self.textures[unit.texture], unit))[0] == 0

    def _own(self, i, texture, unit):
        """A texel at the unit's own coordinates. Source: OpenGL 1.2.1 section 3.8."""
        texel = sample.sample_texture(
            self.triangles[i], *self.pixel, self.weights, texture, unit.sampler, unit.lod_bias, self.profile
        )
        return [fixed.converted(c, 2 ** getattr(texture, "bits", 8) - 1, self.one) for c in texel]


def triangle_of(primitives, vertices):
    """The triangle of three vertices. Source: OpenGL 1.2.1 section 3.5.1."""
    behind = tuple(primitives.inverse_w[v] < 0 for v in vertices)
    return coverage.make_triangle(*((primitives.x[v], primitives.y[v]) for v in vertices), behind)


def offset_of(primitives, vertices, state, target, fraction):
    """The depth offset of the polygon that a row is, or came from. Source: OpenGL 1.2.1 section 3.5.5; with W
    buffering docs/numbers.md N5.9.
    """
    polygon = state.polygon
    depths = depth.vertex_depths(primitives, vertices, state, target.depth_bits, state.vertex.depth_units)
    triangle = triangle_of(primitives, vertices)
    if state.w_buffering:
        if not polygon.offset_factor:
            return depth.limited_offset(polygon.offset_units)
        columns, rows = coverage.polygon_rows_and_columns(state, target.width, target.height)
        inverse_w = tuple(primitives.inverse_w[v] for v in vertices)
        steep = polygon.offset_factor * w_slope.slope(triangle, depths, inverse_w, columns, rows)
        return depth.limited_offset(polygon.offset_units + steep)
    return depth.primitive_offset(triangle, depths, polygon, target.depth_bits, fraction)


def converted(state, i, texel):
    """Unit i's register of Y, Cb and Cr as RGB, if it has a texel. Measured: 1213620 of 1213620 pixels
    (BumpMap_UYVY_L and three captures like it); Assumed: units without one, and what is below 0.
    """
    unit, shader = state.texture_units[i], state.texture_shader
    operation = shader[i].operation if shader is not None and i < len(shader) else TextureShaderOperation.NONE
    if unit is None or unit.texture is None:
        return texel
    if shader is not None and operation in texture_shader.WITHOUT_ACCESS:
        return texel
    return [*texel_words.texel_of_ycbcr(*(max(component, 0) for component in texel[:3]))[:3], texel[3]]


def shape_of(primitives, vertices, kind, state, profile):
    """(what has a row's edge values, whether it draws a pixel). Source: docs/numbers.md sections 3, 11."""
    if kind == LINE:
        b, a = ((primitives.x[v], primitives.y[v]) for v in vertices[:2])
        if profile.arithmetic.diamond_exit_lines:
            line = strokes.DiamondLine(a, b, max(1, math.floor(state.line.width + 0.5)))
            return line, line.covers
        line = strokes.Line(a, b, math.floor(8 * state.line.width), state.line.rasterization)
        return line, line.covers
    triangle = triangle_of(primitives, vertices)
    if kind == POINT:
        return triangle, partial(strokes.point_covers, triangle.vertices)
    return triangle, partial(coverage.covers, triangle)


def places_of(kind, state, profile, place):
    """The places of a pixel by which a kind of primitive is asked for what it covers; None: its middle alone.

    Source: OpenGL 1.2.1 sections 3.4.4, 3.5.2 (smooth lines and polygons); Measured: Swath_width
    (multisampled surfaces).
    """
    if place is not None:
        in_steps = kind == LINE and state.line.rasterization == LineRasterization.STEPS
        return None if in_steps or kind == POINT else (place,)
    smooth = {TRIANGLE: state.polygon.smooth, LINE: state.line.smooth, POINT: False}[kind]
    return profile.primitives.smoothing_samples if smooth else None


def moved_by(primitives, x, y):
    """The same primitives elsewhere. Assumed: nothing, the frame of reference changes."""
    moved = {"x": [v + x for v in primitives.x], "y": [v + y for v in primitives.y]}
    return SimpleNamespace(**moved, inverse_w=primitives.inverse_w)


def has_weights(n, inverse_w):
    """Whether a pixel's weights have sums that can be divided by. Assumed: others are left out."""
    e = interpolate.weighed_edges(n, interpolate.weight_factors(inverse_w))
    whole = interpolate.denominator(interpolate.perspective_terms(n, inverse_w))
    return whole > 0 and interpolate.weight_sum(e) > 0


def draw_primitive(target, primitives, corners, stroke, state, textures, profile, place, bits):
    """One row of ``triangles``, ``corners``, and of ``strokes``, ``stroke`` (None: a triangle); ``place``:
    the place in a pixel of a multisampled window that draws it, or None; ``bits``: as ``draw`` has them.

    Source: OpenGL 1.2.1 chapters 3, 4.
    """
    state, one = signed_formats.with_signs(state, textures), 2**bits - 1
    *vertices, provoking = corners
    kind, back, *source, _, _, counter = (TRIANGLE, False, -1, -1, -1, 0, 0, 0) if stroke is None else stroke
    shape, covers = shape_of(primitives, vertices, kind, state, profile)
    polygon = state.polygon
    if kind == TRIANGLE:
        if shape.area == 0:
            return
        front = coverage.is_front_facing(shape, polygon.front_face)
        if coverage.is_culled(front, polygon.cull_face):
            return
        back, source = not front, vertices
    enabled = {TRIANGLE: polygon.offset_fill, LINE: polygon.offset_line, POINT: polygon.offset_point}[kind]
    inverse_w = tuple(primitives.inverse_w[v] for v in vertices)
    sizes = [abs(w) if kind == TRIANGLE else w for w in inverse_w]
    if min(sizes) < SMALLEST_INVERSE_W or max(sizes) > LARGEST_INVERSE_W:
        return
    colors = vertex_colors(primitives, vertices, provoking, back, state.polygon)
    units = [
        sample.TexturedTriangle(
            shape, inverse_w, tuple(primitives.coordinates[v][i] for v in vertices), primitives.divided[i]
        )
        for i in range(len(state.texture_units))
    ]
    in_units = state.vertex.depth_units
    depths = depth.vertex_depths(primitives, vertices, state, target.depth_bits, in_units)
    by_w = state.w_buffering and depth.matters(state)
    offset = 0.0
    if enabled and source[0] >= 0:
        offset = offset_of(primitives, source, state, target, profile.arithmetic.offset_fraction)
    size = target.width, target.height
    if kind == TRIANGLE:
        columns, rows = coverage.polygon_rows_and_columns(state, *size)
    else:
        columns, rows = coverage.scissor_rows_and_columns(state.scissor, *size)
    places = places_of(kind, state, profile, place)
    if kind == TRIANGLE and places is None:
        columns, rows = coverage.spanned(shape, columns, rows)
    if places is not None:
        pictures = {
            (-right, up): shape_of(moved_by(primitives, -right, up), vertices, kind, state, profile)[1]
            for right, up in places
        }
    for px, py in product(columns, rows):
        covered = 1
        if kind == LINE and not shape.reaches(px, py):
            continue
        if places is None:
            covered = covers(px, py)
        else:
            covered = coverage.covered_samples(places, lambda *by, at=(px, py): pictures[by](*at))
        if not covered or strokes.clipped_away(state.window_clip, px, py, target.height):
            continue
        if kind == TRIANGLE and strokes.stippled_away(polygon.stipple, px, py, target.height):
            continue
        n = coverage.edge_values(shape, *(shape.pixel_of(px, py) if kind == LINE else (px, py)))
        if kind == LINE and strokes.stippled_line(state.line.stipple, shape, counter, px, py):
            continue
        if places is not None and not has_weights(n, inverse_w):
            continue
        weights = interpolate.weights(n, inverse_w)
        color_weights = interpolate.color_weights(weights, bits)
        color = [
            interpolate.exact_color_channel(n, inverse_w, [c[k] for c in colors], one)
            if profile.arithmetic.color_weights == ColorWeights.EXACT
            else interpolate.iterate_color_channel(color_weights, [c[k] for c in colors], bits)
            for k in range(8)
        ]
        # A line's row is its second vertex, then its first.
        order = slice(None, None, -1 if kind == LINE else 1)
        z = depth.iterate_w(weights, depths) if by_w else depth.iterate(n[order], depths[order])
        z = depth.word(depth.kept(z) + offset, target.depth_bits, state.depth_clamp)
        access = Access(state, units, (px, py), weights, textures, profile, one)
        alive = True
        if state.texture_shader is None:
            texels = [
                [0, 0, 0, one] if unit is None else access(i, None, None)
                for i, unit in enumerate(state.texture_units)
            ]
        else:
            full = depth.full_scale(target.depth_bits)
            stages = texture_shader.Stages(state, units, weights, access, full, profile)
            texels, alive, new_depth = stages.run()
            z = z if new_depth is None else new_depth
        if state.ycbcr_conversion:
            texels = [converted(state, i, texel) for i, texel in enumerate(texels)]
        fog_coordinate = iterated_fog([primitives.fog[v] for v in vertices], weights, profile)
        shaded = shade(color[:4], color[4:], fog_coordinate, texels, state, textures, profile, bits)
        shaded = [fixed.converted(c, one, target.one) for c in shaded]
        if places is not None:
            shaded = [*shaded[:3], shaded[3] * covered // len(places)]
        if alive and not any(access.ends(i) for i in color_key.killing(state)):
            per_fragment.write_fragment(target, px, py, shaded, z, state)


def draw(target, primitives, state, textures, profile, place=None, bits=8):
    """Draw window primitives into the target, in order. ``textures``: name to texture, for the enabled units;
    ``place``: as ``draw_primitive`` has it. ``bits``: of the primitives' colors and of what shades them.

    Source: OpenGL 1.2.1 section 2.1 (fragments of a primitive are drawn before the next primitive's).
    """
    if bits != 8 and (state.register_combiners is None or state.texture_shader or state.fog):
        raise ValueError("Texture environments, texture shaders and fog are specified in bytes alone.")
    columns = SimpleNamespace(
        two_side=primitives.two_side,
        **{
            name: plain(getattr(primitives, name))
            for name in ("x", "y", "z", "inverse_w", "colors", "coordinates", "fog", "triangles", "strokes")
        },
    )
    columns.divided = [
        not sample.has_unit_q([vertex[i] for vertex in columns.coordinates])
        for i in range(len(state.texture_units))
    ]
    names = {unit.texture for unit in state.texture_units if unit is not None} - {None}
    fraction = profile.arithmetic.filter_fraction_bits
    used = {name: plain_texture(textures[name], fraction) for name in names}
    for i, corners in enumerate(columns.triangles):
        stroke = columns.strokes[i] if columns.strokes else None
        draw_primitive(target, columns, corners, stroke, state, used, profile, place, bits)
