"""Two pictures of one frame: which pixels differ by more than correct machines may, and why they may.

A *deviation* is how far a machine's number may lie from the real number that OpenGL's equations give, in
units of 1/255 (colours) or of the depth buffer; two machines may differ by the sum of theirs.
"""

import inspect
from dataclasses import dataclass, is_dataclass, replace
from itertools import combinations, product

import numpy as np

from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    CombineFunction,
    CombineOperand,
    CombineSource,
    PrimitiveType,
    ShadeModel,
    TextureEnvironmentMode,
    TextureFilter,
)
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.state import AlphaTest
from fixedpipe.pipeline.vertices import stage

ROUNDING = 0.5  # rounding to the nearest byte
# What single precision adds: sums of a few terms of 2^-24 relative error, times 255, after three divisions.
SINGLE = 0.01
# Of a lit vertex's colour: a power is taken by a logarithm of single precision.
_LIT = 0.05


@dataclass(frozen=True)
class Deviation:
    """Of a colour's red, green and blue (the largest), and of its alpha; bytes."""

    rgb: float
    alpha: float

    def rounded(self, amount=ROUNDING):
        """The same after one more rounding."""
        return Deviation(self.rgb + amount, self.alpha + amount)


NOTHING = Deviation(0.0, 0.0)


def _are_bytes(colors):
    scaled = np.asarray(colors) * 255.0
    return bool((np.abs(scaled - np.round(scaled)) < 1e-4).all())


def _iterated(mesh, colors, state):
    """How often a vertex colour is rounded on its way to fragments: to a byte at the vertex, where it is
    none, and again between vertices that differ.
    """
    if colors is None:
        return 0.0
    alike = state.polygon.shade_model is ShadeModel.FLAT or (colors == colors[:1]).all()
    return float(not _are_bytes(colors)) + float(not alike)


_LINEAR = (TextureFilter.LINEAR, TextureFilter.LINEAR_MIPMAP_NEAREST, TextureFilter.LINEAR_MIPMAP_LINEAR)
_BETWEEN_LEVELS = (TextureFilter.NEAREST_MIPMAP_LINEAR, TextureFilter.LINEAR_MIPMAP_LINEAR)


def texel(unit, ours):
    """The deviation of what a unit's filter gives.

    NEAREST: a texel's bytes. LINEAR, ours: along each of two axes the weight is cut to 8 bits, which moves
    the result by up to 255/256, and the result is rounded; so it is between two levels. Mesa's filters are of
    single precision.
    """
    filters, one = (unit.sampler.mag_filter, unit.sampler.min_filter), 0.0
    if any(f in _LINEAR for f in filters):
        one += 2 * (1.0 + ROUNDING) if ours else SINGLE
    if any(f in _BETWEEN_LEVELS for f in filters):
        one += 1.0 + ROUNDING if ours else SINGLE
    return Deviation(one, one)


def environment(unit, previous, primary, texels, ours):
    """The deviation of a unit's result, from those of the colour that reaches it, the primary colour and all
    units' ``texels``.

    A product deviates by its factors' sum, a mixture by the most of what is mixed and by its weight's; ours
    is rounded, then scaled. What a texture's base format leaves alone keeps its deviation.
    """
    given, mode = unit.environment, unit.environment.mode
    rounding = ROUNDING if ours else SINGLE
    here = texels[unit.texture]
    if mode in (TextureEnvironmentMode.COMBINE, TextureEnvironmentMode.COMBINE4):

        def half(half, alpha):
            four = mode is TextureEnvironmentMode.COMBINE4
            values = []
            for source, operand in zip(half.sources, half.operands, strict=False):
                color = {
                    CombineSource.TEXTURE: here,
                    CombineSource.PREVIOUS: previous,
                    CombineSource.PRIMARY_COLOR: primary,
                    CombineSource.CONSTANT: NOTHING,
                    CombineSource.ZERO: NOTHING,
                }.get(source)
                if color is None:
                    color = texels.get(f"texture {source - CombineSource.TEXTURE0}", NOTHING)
                of_alpha = alpha or operand in (CombineOperand.SRC_ALPHA, CombineOperand.ONE_MINUS_SRC_ALPHA)
                values.append(color.alpha if of_alpha else color.rgb)
            return half.scale * combined(half.function, values, four, rounding, ours)

        rgb = half(given.rgb, False)
        return Deviation(
            rgb,
            given.alpha.scale / given.rgb.scale * rgb
            if given.rgb.function is CombineFunction.DOT3_RGBA
            else half(given.alpha, True),
        )

    def conventional(p, t, weight):
        """Of one channel; ``weight``: the deviation of DECAL's, the texel's alpha."""
        return {
            TextureEnvironmentMode.MODULATE: p + t + rounding,
            TextureEnvironmentMode.REPLACE: t,
            TextureEnvironmentMode.DECAL: max(p, t) + weight + rounding,
            TextureEnvironmentMode.BLEND: p + t + rounding,
            TextureEnvironmentMode.ADD: p + t,
        }[mode]

    rgb = max(previous.rgb, conventional(previous.rgb, here.rgb, here.alpha))
    alpha = previous.alpha
    if mode is not TextureEnvironmentMode.DECAL:
        # Multiplied, but in REPLACE, and an INTENSITY texture's in BLEND and ADD: sums deviate less.
        product = previous.alpha + here.alpha + rounding
        alpha = max(alpha, here.alpha if mode is TextureEnvironmentMode.REPLACE else product)
    return Deviation(rgb, alpha)


def combined(function, values, four, rounding, ours):
    """The deviation of a COMBINE function before its scale, from its arguments'.

    Ours has 128/255 for one half: ADD_SIGNED is half a unit lower, and each factor 2 a - 1 of a dot product
    is one unit lower and deviates by twice its byte's. Mesa's sum of ADD_SIGNED lies half way between two
    bytes, also where all arguments are bytes, so it is not exact: it will be rounded.
    """
    half = ROUNDING if ours else 0.0
    signed = ROUNDING if ours else SINGLE
    if four:
        total = sum(values[:4]) + rounding
        return total + signed if function is CombineFunction.ADD_SIGNED else total
    if function in (CombineFunction.DOT3_RGB, CombineFunction.DOT3_RGBA):
        return 3 * (2 * values[0] + 2 * values[1] + 2 * (2 * half)) + rounding
    return {
        CombineFunction.REPLACE: values[0],
        CombineFunction.MODULATE: values[0] + sum(values[1:2]) + rounding,
        CombineFunction.ADD: values[0] + sum(values[1:2]),
        CombineFunction.ADD_SIGNED: values[0] + sum(values[1:2]) + signed,
        CombineFunction.INTERPOLATE: max(values[:2]) + sum(values[2:3]) + rounding,
        CombineFunction.SUBTRACT: values[0] + sum(values[1:2]),
    }[function]


def source(draw, ours):
    """The deviation of a fragment's colour before blending.

    ``ours``: of our machine, which rounds after every stage; Mesa's shaders compute in single precision.
    """
    rounding = ROUNDING if ours else SINGLE
    mesh, state = draw.mesh, draw.state
    varies, lit = _iterated(mesh, mesh.colors, state), state.vertex.lighting
    if lit is not None:
        varies = 2.0 if ours else _LIT / SINGLE  # a byte at the vertex, and one between vertices
    color = primary = Deviation(rounding * varies, rounding * varies)
    units = [unit for unit in state.texture_units if unit is not None]
    texels = {unit.texture: texel(unit, ours) for unit in units}
    for unit in units:
        color = environment(unit, color, primary, texels, ours)
    if lit is not None and lit.separate_specular_color:
        color = replace(color, rgb=color.rgb + rounding * varies)
    elif state.color_sum:
        rgb = color.rgb + rounding * _iterated(mesh, mesh.secondary_colors, state)
        color = replace(color, rgb=rgb)
    if state.fog is not None:
        # f C + (1 - f) Cf: a factor that is off by a rounding moves the colour at most that far, since C and
        # Cf are at most one apart. The sum is rounded again.
        color = replace(color, rgb=color.rgb + 2 * rounding)
    return color


def blended(color, stored, blending, ours):
    """The deviation of what blending writes, from the fragment's and from what the buffer held.

    A product of two numbers up to one deviates by at most the sum of its factors'. Ours is rounded once,
    after the sum; Mesa's are rounded one by one where its framebuffer arithmetic is of bytes (llvmpipe).
    """
    if blending is None:
        return color if ours else color.rounded()

    def factor(which, alpha):
        own, there = (color.alpha, stored.alpha) if alpha else (color.rgb, stored.rgb)
        return {
            BlendFactor.SRC_COLOR: own,
            BlendFactor.ONE_MINUS_SRC_COLOR: own,
            BlendFactor.DST_COLOR: there,
            BlendFactor.ONE_MINUS_DST_COLOR: there,
            BlendFactor.SRC_ALPHA: color.alpha,
            BlendFactor.ONE_MINUS_SRC_ALPHA: color.alpha,
            BlendFactor.DST_ALPHA: stored.alpha,
            BlendFactor.ONE_MINUS_DST_ALPHA: stored.alpha,
            BlendFactor.SRC_ALPHA_SATURATE: 0.0 if alpha else max(color.alpha, stored.alpha),
        }.get(which, 0.0)

    def channel(own, there, alpha):
        if blending.equation in (BlendEquation.MIN, BlendEquation.MAX):
            return max(own, there) + (0.0 if ours else ROUNDING)
        total, products = 0.0, 0
        for value, which in ((own, blending.source), (there, blending.destination)):
            if which is BlendFactor.ZERO:
                continue
            total += value
            if which is not BlendFactor.ONE:
                total += factor(which, alpha)
                products += 1
        return total + (ROUNDING if ours else ROUNDING * max(products, 1))

    if not ours and color != NOTHING:
        color = color.rounded()  # to the bytes that llvmpipe blends
    return Deviation(channel(color.rgb, stored.rgb, False), channel(color.alpha, stored.alpha, True))


def color_bounds(commands, layers):
    """How far two pictures' colours may differ, int64 [h, w, 4]; ``layers``: for each Draw, int64 [h, w], how
    many of its fragments fell on each pixel.
    """
    bounds = [_deviations(commands, layers, ours) for ours in (True, False)]
    return np.floor(sum(bounds) + 1e-9).astype(int)


def _deviations(commands, layers, ours):
    shape = layers[0].shape
    held = np.zeros((*shape, 2))
    for draw, counts in zip((c for c in commands if isinstance(c, Draw)), layers, strict=True):
        color = source(draw, ours)
        remaining = counts.copy()
        exact = color == NOTHING and draw.state.blending is None
        while (remaining > 0).any():
            for rgb, alpha in np.unique(held[remaining > 0], axis=0):
                here = (remaining > 0) & (held[..., 0] == rgb) & (held[..., 1] == alpha)
                stored = Deviation(rgb, alpha)
                new = NOTHING if exact else blended(color, stored, draw.state.blending, ours)
                # A fragment that fails a test, or a mask, leaves what was there.
                held[here] = max(new.rgb, rgb), max(new.alpha, alpha)
                remaining = np.where(here, -remaining, remaining)
            remaining = np.abs(remaining) - 1
    return np.concatenate([np.repeat(held[..., :1], 3, -1), held[..., 1:]], -1)


# ------------------------------------------------------------------------------------------------------ depth

# Mesa's plane equations of depth are of single precision: each of the products that give the slopes, and each
# of the terms of the sum, is off by 2^-24 of itself, that is by one unit of a 24-bit depth of one.
# Measured: the largest was 2.2 times that sum, in 4 x 10^4 pixels.
_TERMS = 3.0


def depth_bounds(commands, profile, width, height):
    """How far two pictures' depths may differ, float64 [h, w], units of 24 bits.

    One for the roundings, of Clear too, and what single precision loses in a triangle's plane equation, from
    its slopes before anything cancels.
    """
    bounds = np.ones((height, width))
    for draw in (c for c in commands if isinstance(c, Draw)):
        primitives = stage.process(draw.mesh, draw.state, profile, width, height)
        for corners in primitives.triangles[:, :3]:
            x, y = primitives.x[corners] / 16.0, primitives.y[corners] / 16.0
            z = primitives.z[corners]
            dx, dy, dz = (np.abs(v[1:] - v[0]) for v in (x, y, z))
            area = abs((x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]))
            if area == 0:
                continue
            along = (dz[0] * dy[1] + dz[1] * dy[0]) / area
            up = (dz[0] * dx[1] + dz[1] * dx[0]) / area
            lost = 1.0 + along * np.abs(x).max() + up * np.abs(y).max()
            if draw.state.polygon.offset_fill:
                lost += abs(draw.state.polygon.offset_factor) * max(along, up) + 1.0
            rows = slice(max(int(y.min()), 0), max(int(y.max()) + 1, 0))
            columns = slice(max(int(x.min()), 0), max(int(x.max()) + 1, 0))
            bounds[rows, columns] = np.maximum(bounds[rows, columns], 1.0 + _TERMS * lost)
    return bounds


# ---------------------------------------------------------------------------------------------------- whole


@dataclass(frozen=True)
class Comparison:
    """``wrong``: bool [h, w]. ``undecided``: pixels that agree only where a test's comparison, which was a
    tie to within the bounds, is decided the other way. ``differences``: int64 [h, w, 4].
    """

    ours: object
    wrong: np.ndarray
    undecided: np.ndarray
    differences: np.ndarray
    bounds: np.ndarray


def _layers(commands, profile, width, height):
    """For each Draw how many fragments fall on each pixel, passed or not."""
    result = execute(commands, profile, width, height, threads=1, record=True)
    layers = []
    for record in result.records:
        counts = np.zeros((height, width), int)
        np.add.at(counts, (record.y, record.x), 1)
        layers.append(counts)
    return result.framebuffer, layers


def _agree(framebuffer, picture, color, depth):
    difference = np.abs(framebuffer.color.astype(int) - picture["color"])
    close = (difference <= color).all(-1)
    close &= np.abs(framebuffer.depth.astype(float) - picture["depth"]) <= depth
    return close & (framebuffer.stencil == picture["stencil"]), difference


_MOST_UNITS = 12
_SEEDS = 16


# A centre on the boundary of two texels may read either.
_TEXELS = (1e-4, 1e-4), (-1e-4, 1e-4), (1e-4, -1e-4), (-1e-4, -1e-4)
_UNMOVED = (0.0, 0.0)


def _moves(commands, bound):
    """How vertices' depths and texture coordinates are moved: (units of 24 bits, seed, texture coordinates).

    Depths: all alike, by every unit and by the bound; and each up or down as a seed has it, which decides
    between the primitives of one mesh: of every Draw alike, so that what is drawn twice stays equal, or of
    each differently.
    """
    yield 0.0, None, _UNMOVED
    states = [command.state for command in commands if isinstance(command, Draw)]
    if any(unit for state in states for unit in state.texture_units):
        for texels in _TEXELS:
            yield 0.0, None, texels
    if not any(state.depth_test for state in states):
        return
    for units in (*range(1, min(int(np.ceil(bound)), _MOST_UNITS) + 1), bound):
        yield units, None, _UNMOVED
        yield -units, None, _UNMOVED
    for seed in range(_SEEDS):
        yield bound, seed, _UNMOVED


def _shifted(unit, texels):
    """A unit whose coordinates s and t are moved by that much."""
    if unit is None:
        return None
    s, t, r, q = unit.matrix
    s, t = (
        tuple(a + by * b for a, b in zip(row, q, strict=True)) for row, by in zip((s, t), texels, strict=True)
    )
    return replace(unit, matrix=(s, t, r, q))


def perturbed(commands, references, units, seed, texels):
    """The same frame with alpha references moved by so many bytes, each command's, vertices' depths by units,
    and texture coordinates s and t. A vertex between the near and the far plane stays between them: beyond
    one, its primitive would be clipped, and another stencil value would stay.
    """
    moved = []
    for number, (command, reference) in enumerate(zip(commands, references, strict=True)):
        if isinstance(command, Draw):
            state, mesh = command.state, command.mesh
            if state.alpha_test is not None and reference:
                test = state.alpha_test
                state = replace(
                    state, alpha_test=AlphaTest(test.function, test.reference + reference / 255.0)
                )
            if state.depth_test is not None and units:
                positions = mesh.positions.copy()
                signs = 1.0
                if seed is not None:
                    random = np.random.default_rng((seed, number if seed % 2 else 0))
                    signs = random.choice([-1.0, 1.0], len(positions))
                z, w = positions[:, 2], positions[:, 3]
                to = z + 2.0 * units / (2**24 - 1) * signs * w
                positions[:, 2] = np.where(np.abs(z) <= w, np.clip(to, -np.abs(w), np.abs(w)), to)
                mesh = replace(mesh, positions=positions)
            if any(texels):
                shifted = tuple(_shifted(unit, texels) for unit in state.texture_units)
                state = replace(state, texture_units=shifted)
            command = replace(command, mesh=mesh, state=state)
        moved.append(command)
    return tuple(moved)


def edge_pixels(commands, profile, width, height, within):
    """Bool [h, w]: pixels whose centre lies within so many pixels of a primitive's edge; 0: exactly on it."""
    found = np.zeros((height, width), bool)
    px, py = np.meshgrid(16 * np.arange(width) + 8, 16 * np.arange(height) + 8)
    for draw in (c for c in commands if isinstance(c, Draw)):
        primitives = stage.process(draw.mesh, draw.state, profile, width, height)
        rows = primitives.triangles[:, :3]
        if draw.mesh.primitive in (PrimitiveType.QUADS, PrimitiveType.QUAD_STRIP):
            rows = rows.reshape(-1, 6)  # two triangles of a quad: either diagonal may be an edge
        for a, b in {tuple(sorted(pair)) for row in rows.tolist() for pair in combinations(row, 2)}:
            x, y = int(primitives.x[a]), int(primitives.y[a])
            dx, dy = int(primitives.x[b]) - x, int(primitives.y[b]) - y
            found |= np.abs((px - x) * dy - (py - y) * dx) <= 16 * within * np.hypot(dx, dy)
    return found


def fold_pixels(commands, profile, width, height):
    """Bool [h, w]: pixels whose centre lies exactly on an edge that two triangles of a Draw have in common,
    both on the same side of it. Both have the edge's depth there, so rounding alone orders them.
    """
    found = np.zeros((height, width), bool)
    px, py = np.meshgrid(16 * np.arange(width) + 8, 16 * np.arange(height) + 8)
    for draw in (c for c in commands if isinstance(c, Draw)):
        primitives = stage.process(draw.mesh, draw.state, profile, width, height)
        sides = {}
        for corners in primitives.triangles[:, :3]:
            points = [(int(primitives.x[k]), int(primitives.y[k]), float(primitives.z[k])) for k in corners]
            for a, b, c in (points, points[1:] + points[:1], points[2:] + points[:2]):
                (ax, ay, _), (bx, by, _) = edge = tuple(sorted((a, b)))
                side = np.sign((bx - ax) * (c[1] - ay) - (by - ay) * (c[0] - ax))
                if side and side in sides.setdefault(edge, set()):
                    on_line = (px - ax) * (by - ay) == (py - ay) * (bx - ax)
                    found |= on_line & (px >= ax) & (px <= bx) & (py >= min(ay, by)) & (py <= max(ay, by))
                sides.setdefault(edge, set()).add(side)
    return found


def diamond_ties(commands, profile, width, height):
    """Pixels, bool [h, w], whose centre a line passes at half a pixel, to within 1/128: llvmpipe draws a line
    as a quadrilateral with corners on 1/256 pixels.
    """
    found = np.zeros((height, width), bool)
    px, py = np.meshgrid(16 * np.arange(width) + 8, 16 * np.arange(height) + 8)
    for draw in (c for c in commands if isinstance(c, Draw)):
        primitives = stage.process(draw.mesh, draw.state, profile, width, height)
        for b, a in primitives.triangles[:, :2].tolist():
            x, y = int(primitives.x[a]), int(primitives.y[a])
            dx, dy = int(primitives.x[b]) - x, int(primitives.y[b]) - y
            longer = max(abs(dx), abs(dy))
            found |= np.abs(2 * np.abs((px - x) * dy - (py - y) * dx) - 16 * longer) <= longer // 4
    return found


def compare(commands, picture, profile, width, height, ignored=None):
    """Draw the frame here and compare it with Mesa's ``picture``.

    ``ignored``: bool [h, w], pixels left out.
    """
    framebuffer, layers = _layers(commands, profile, width, height)
    color = color_bounds(commands, layers)
    depth = depth_bounds(commands, profile, width, height)
    agree, difference = _agree(framebuffer, picture, color, depth)
    if ignored is not None:
        agree |= ignored
    plain = agree.copy()
    references = product(*map(_alpha_steps, commands))
    for moved, (units, seed, texels) in product(references, _moves(commands, depth.max())):
        if agree.all():
            break
        other = perturbed(commands, moved, units, seed, texels)
        result = execute(other, profile, width, height, threads=1).framebuffer
        agree |= _agree(result, picture, color, depth + abs(units))[0]
    return Comparison(framebuffer, ~agree, agree & ~plain, difference, color)


def _alpha_steps(command):
    """How many bytes a command's alpha reference is to be moved: none, or all by which two machines' alphas
    may differ.
    """
    if not isinstance(command, Draw) or command.state.alpha_test is None:
        return (0,)
    apart = source(command, True).alpha + source(command, False).alpha
    if command.state.polygon.shade_model is ShadeModel.SMOOTH:
        # Mesa multiplies by an interpolated w what it divided by each vertex's, equal alphas too.
        apart += SINGLE
    steps = int(np.ceil(apart))
    return (0, *(sign * step for step in range(1, steps + 1) for sign in (-1, 1)))


# --------------------------------------------------------------------------------------------------- examples


def spelled(value):
    """What to write to make ``value`` again, without the fields that have their defaults."""
    if isinstance(value, tuple):
        return f"({', '.join(spelled(v) for v in value)}{',' if len(value) == 1 else ''})"
    if isinstance(value, np.ndarray):
        return f"np.array({value.tolist()})"
    if not is_dataclass(value):
        return f"{type(value).__name__}.{value.name}" if hasattr(value, "name") else repr(value)
    said = []
    for name, parameter in inspect.signature(type(value)).parameters.items():
        given = getattr(value, name)
        if isinstance(given, np.ndarray) or given != parameter.default:
            said.append(f"{name}={spelled(given)}")
    return f"{type(value).__name__}({', '.join(said)})"


def example(commands, picture, comparison):
    """A sentence about the first wrong pixel, and the frame as Python."""
    rows, columns = np.nonzero(comparison.wrong)
    at = rows[0], columns[0]
    ours = comparison.ours
    return "\n".join(
        [
            f"{len(rows)} pixels differ; at column {at[1]}, row {at[0]} from the top: "
            f"ours {ours.color[at].tolist()}, depth {ours.depth[at]}, stencil {ours.stencil[at]}; "
            f"Mesa {picture['color'][at].tolist()}, depth {picture['depth'][at]}, "
            f"stencil {picture['stencil'][at]}; "
            f"colours may differ by {comparison.bounds[at].tolist()}.",
            *map(spelled, commands),
        ]
    )
