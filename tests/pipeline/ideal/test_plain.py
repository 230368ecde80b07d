"""The ideal's kernels against one fragment at a time in plain Python floats: every bit, of random states."""

import math
import random
from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    ComparisonFunction,
    InternalFormat,
    Register,
    TextureFilter,
    WrapMode,
)
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.ideal.weights import PIXEL
from fixedpipe.pipeline.native.coverage import rasterize
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.state import (
    AlphaPortion,
    AlphaTest,
    Blending,
    ColorMask,
    DepthTest,
    GeneralCombiner,
    PassState,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.vertices.stage import process
from tests.pipeline.ideal.test_evaluate import random_final, random_portion, scalar_combine, scalar_factor
from tests.reference.sample import projected

WIDTH, HEIGHT = 23, 17
TAU = 2.0**-24


# ------------------------------------------------------------------------------------------- one fragment


class Fragment:
    """A pixel of a triangle: docs/numbers.md, sections 3 to 6, in whole numbers and Python's floats."""

    def __init__(self, primitives, t, px, py):
        self.p = primitives
        self.v = [int(v) for v in primitives.triangles[t, :3]]
        x, y = ([int(column[v]) for v in self.v] for column in (primitives.x, primitives.y))
        self.x10, self.x20, self.y10, self.y20 = x[1] - x[0], x[2] - x[0], y[1] - y[0], y[2] - y[0]
        dx, dy = 16 * px + 8 - x[0], 16 * py + 8 - y[0]
        self.area = self.x10 * self.y20 - self.x20 * self.y10
        self.sign = -1 if self.area < 0 else 1
        n1 = self.sign * (dx * self.y20 - self.x20 * dy)
        n2 = self.sign * (self.x10 * dy - dx * self.y10)
        self.n = [float(abs(self.area) - n1 - n2), float(n1), float(n2)]
        w = [float(primitives.inverse_w[v]) for v in self.v]
        self.w = [1.0] * 3 if w[0] == w[1] == w[2] else w
        self.e = [n * w for n, w in zip(self.n, self.w, strict=True)]
        self.total = (self.e[0] + self.e[1]) + self.e[2]
        self.weights = [e / self.total for e in self.e]

    def iterated(self, values, weights=None):
        v0, v1, v2 = (float(values[v]) for v in self.v)
        w = self.weights if weights is None else weights
        return ((v0 - v1) * w[0] + v1) + (v2 - v1) * w[2]

    def depth(self):
        z = self.iterated(self.p.z, [n / float(abs(self.area)) for n in self.n])
        return min(max(z, 0.0), 1.0)

    def color(self, first):
        return [self.iterated(self.p.colors[:, 0, first + c]) for c in range(4)]

    def change(self, values, steps):
        """How an iterated number changes where the edge functions change by ``steps``."""
        d = [16.0 * (self.sign * step) * w for step, w in zip(steps, self.w, strict=True)]
        change = (d[0] + d[1]) + d[2]
        d0, d2 = ((d[k] - self.weights[k] * change) / self.total for k in (0, 2))
        v0, v1, v2 = (float(values[v]) for v in self.v)
        return d0 * (v0 - v1) + d2 * (v2 - v1)

    def cut_weights(self):
        """The machines' q0 and q2."""
        inverse = cut(1.0 / self.total)
        q = [cut(e * inverse) for e in self.e]
        c = [(value >= 0.5) + (value >= 0.25) for value in q]
        first = c[0] >= c[1] and c[0] > c[2]
        last = c[2] >= c[0] and (c[2] > c[1] or (c[2] == c[1] and c[0] == c[1]))
        return rest_of(q[1], q[2]) if first else q[0], rest_of(q[0], q[1]) if last else q[2]

    def as_machines(self, values):
        """An iterated number by section 6, and the unit of its terms."""
        v0, v1, v2 = (float(values[v]) for v in self.v)
        q0, q2 = self.cut_weights()
        terms = [v1, q0 * (v0 - v1), q2 * (v2 - v1)]
        unit = math.ldexp(1.0, math.frexp(max(*map(abs, terms), 2.0**-100))[1] - 24)
        return sum(math.trunc(term / unit) for term in terms) * unit, unit


def rest_of(a, b):
    """What two weights leave of one."""
    return cut((2**25 - math.trunc(a * 2**25) - math.trunc(b * 2**25)) / 2**25)


def cut(value):
    """24 significant bits, toward zero."""
    mantissa, exponent = math.frexp(value)
    return math.ldexp(math.trunc(math.ldexp(mantissa, 24)), exponent - 24)


# ------------------------------------------------------------------------------------------------- texels


def along(texel, size, wrap, linear):
    """(indices, None for the border; the fraction between them) along an axis: section 3.8.4."""
    if wrap is WrapMode.REPEAT:
        texel = texel % float(size)
    elif wrap is WrapMode.MIRRORED_REPEAT:
        texel = texel % (2.0 * size)
        texel = min(texel, 2.0 * size - texel)
    else:
        beside = {WrapMode.CLAMP: 0.0, WrapMode.CLAMP_TO_EDGE: 0.5, WrapMode.CLAMP_TO_BORDER: -0.5}[wrap]
        texel = min(max(texel, beside), size - beside)
    below = math.floor(texel - 0.5) if linear else math.floor(texel)
    bordered = wrap is WrapMode.CLAMP_TO_BORDER or (wrap is WrapMode.CLAMP and linear)

    def index(k):
        if wrap is WrapMode.REPEAT:
            return k % size
        return None if bordered and not 0 <= k < size else min(max(k, 0), size - 1)

    return (index(below), index(below + 1)), texel - 0.5 - below


def filtered(level, position, slip, bias, sampler, linear):
    """A level's texel, as the sampler filters it."""
    height, width = level.shape[:2]
    at = []
    for p, s, size, wrap in zip(
        position, slip, (width, height), (sampler.wrap_s, sampler.wrap_t), strict=True
    ):
        texel = p * size
        if not linear:
            texel += TAU if s * size + bias >= 0.0 else -TAU
        at.append(along(texel, size, wrap, linear))
    (columns, across), (rows, up) = at

    def texel(row, column, c):
        return sampler.border_color[c] if row is None or column is None else float(level[row, column, c])

    if not linear:
        return [texel(rows[0], columns[0], c) for c in range(4)]
    color = []
    for c in range(4):
        lines = []
        for row in rows:
            left, right = (texel(row, column, c) for column in columns)
            lines.append(left + (right - left) * across)
        color.append(lines[0] + (lines[1] - lines[0]) * up)
    return color


def sampled(fragment, texture, unit, number):
    """A unit's texel."""
    columns, sampler = fragment.p.coordinates[:, number].T, unit.sampler
    s, t, _, q = (fragment.iterated(column) for column in columns)
    divisor = 1.0 if q == 0.0 else q
    position = s / divisor, t / divisor
    divided = any(float(columns[3][v]) != 1.0 for v in fragment.v)
    slip, machine_q = [], fragment.as_machines(columns[3])[0]
    for column, place in zip(columns[:2], position, strict=True):
        value, unit_of = fragment.as_machines(column)
        if divided:
            value = projected((value, 0.0, 0.0, machine_q), True)[0]
            unit_of = abs(value) * 2.0**-24
        value -= place
        slip.append(0.0 if abs(value) < unit_of / 2 else value)
    given = position, slip, 0.0, sampler
    levels = [level[0] for level in texture.ideal]
    if sampler.min_filter is sampler.mag_filter:
        return filtered(levels[0], *given, sampler.mag_filter.is_linear)
    squares, f, sizes = [], fragment, (texture.width, texture.height)
    for steps in ((f.y10 - f.y20, f.y20, -f.y10), (f.x20 - f.x10, -f.x20, f.x10)):
        of_q = f.change(columns[3], steps)
        edges = [
            (f.change(column, steps) - place * of_q) / divisor * size
            for column, place, size in zip(columns[:2], position, sizes, strict=True)
        ]
        squares.append(edges[0] * edges[0] + edges[1] * edges[1])
    # NumPy's logarithm, whose last bit is not every library's.
    lod = 0.5 * float(np.log2(max(squares))) + unit.lod_bias
    lod = min(max(lod, sampler.min_lod), sampler.max_lod)
    if lod <= 0.0:
        return filtered(levels[0], *given, sampler.mag_filter.is_linear)
    lod, linear = min(lod, float(len(levels) - 1)), sampler.min_filter.is_linear
    if sampler.min_filter in (TextureFilter.LINEAR_MIPMAP_NEAREST, TextureFilter.NEAREST_MIPMAP_NEAREST):
        return filtered(levels[math.ceil(lod + 0.5) - 1], *given, linear)
    lower = math.floor(lod)
    share, color = lod - lower, filtered(levels[lower], *given, linear)
    color = [(1.0 - share) * value for value in color]
    if share > 0.0:
        upper = filtered(levels[lower + 1], *given, linear)
        color = [a + share * b for a, b in zip(color, upper, strict=True)]
    return color


# ------------------------------------------------------------------------------------------- random states

FILTERS = (
    (TextureFilter.LINEAR, TextureFilter.LINEAR),
    (TextureFilter.NEAREST, TextureFilter.NEAREST),
    (TextureFilter.NEAREST_MIPMAP_LINEAR, TextureFilter.LINEAR),
    (TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.LINEAR),
    (TextureFilter.LINEAR_MIPMAP_NEAREST, TextureFilter.NEAREST),
)
COMPARE = {
    ComparisonFunction.LESS: lambda a, b: a < b,
    ComparisonFunction.LEQUAL: lambda a, b: a <= b,
    ComparisonFunction.GREATER: lambda a, b: a > b,
    ComparisonFunction.NOTEQUAL: lambda a, b: a != b,
}


def without_fog(portion):
    """A portion that reads no fog factor, which general combiners have not."""
    read = {name: getattr(portion, name) for name in "abcd"}
    other = {n: replace(v, register=Register.SPARE1) for n, v in read.items() if v.register is Register.FOG}
    return replace(portion, **other)


def random_frame(rng):
    """Textures and a Draw of some triangles, in perspective."""
    units, textures = [], {}
    for k in range(2):
        smallest, largest = rng.choice(FILTERS)
        sampler = Sampler(
            smallest,
            largest,
            rng.choice(list(WrapMode)),
            rng.choice(list(WrapMode)),
            tuple(rng.random() for _ in range(4)),
        )
        units.append(TextureUnit(f"t{k}", sampler, lod_bias=rng.choice((0.0, -0.5, 1.0))))
        texels = np.random.default_rng(rng.getrandbits(32)).random((8, 16, 4))
        textures[f"t{k}"] = texture_2d(texels, InternalFormat.RGBA8, mipmaps=True)
    combiners = RegisterCombiners(
        general=tuple(
            GeneralCombiner(*(without_fog(random_portion(rng, kind)) for kind in (RGBPortion, AlphaPortion)))
            for _ in range(rng.randint(1, 2))
        ),
        final=random_final(rng),
        constant_color0=tuple(rng.random() for _ in range(4)),
        constant_color1=tuple(rng.random() for _ in range(4)),
    )
    blending = Blending(
        rng.choice(list(BlendFactor)),
        rng.choice(list(BlendFactor)),
        rng.choice(sorted(IDEAL.fragments.blend_equations)),
        tuple(rng.random() for _ in range(4)),
    )
    state = PassState(
        texture_units=tuple(units),
        register_combiners=combiners,
        blending=rng.choice((None, blending)),
        depth_test=rng.choice((None, DepthTest(rng.choice(list(COMPARE))))),
        alpha_test=rng.choice((None, AlphaTest(rng.choice(list(COMPARE)), 0.4))),
        color_mask=rng.choice((ColorMask(), ColorMask(True, False, True, True))),
    )
    numbers = np.random.default_rng(rng.getrandbits(32))
    w = numbers.uniform(0.5, 3.0, (9, 1)) if rng.random() < 0.7 else np.ones((9, 1))
    x_y, z = numbers.uniform(-1.2, 1.2, (9, 2)), numbers.uniform(-1, 1, (9, 1))
    positions = np.concatenate([x_y, z, np.ones((9, 1))], axis=1)
    coordinates = numbers.uniform(-2.0, 2.0, (2, 9, 4))
    coordinates[:, :, 3] = numbers.uniform(0.5, 2.0, (2, 9)) if rng.random() < 0.5 else 1.0
    if rng.random() < 0.3:  # exact boundaries
        coordinates[:, :, :2] = np.round(4 * coordinates[:, :, :2]) / 4
    mesh = Mesh(
        positions=positions * w,
        colors=numbers.random((9, 4)),
        secondary_colors=numbers.random((9, 3)),
        texture_coordinates=tuple(coordinates),
    )
    return textures, Draw(label="d", mesh=mesh, state=state)


def blended(blending, s, d):
    out = []
    for c in range(4):
        x = s[c] * scalar_factor(blending.source, s, d, blending.color, c)
        y = d[c] * scalar_factor(blending.destination, s, d, blending.color, c)
        out.append(
            {
                BlendEquation.FUNC_ADD: x + y,
                BlendEquation.FUNC_SUBTRACT: x - y,
                BlendEquation.FUNC_REVERSE_SUBTRACT: y - x,
                BlendEquation.MIN: min(s[c], d[c]),
                BlendEquation.MAX: max(s[c], d[c]),
            }[blending.equation]
        )
    return out


def drawn(textures, draw):
    """The framebuffer's colours and depths after a Draw, one fragment after the other."""
    state = draw.state
    primitives = process(draw.mesh, state, IDEAL, WIDTH, HEIGHT)
    bytes_alone = replace(primitives, colors=np.zeros(primitives.colors.shape, np.uint8))
    record = rasterize(bytes_alone, IDEAL, state.polygon, None, WIDTH, HEIGHT)
    colors, depths = np.zeros((HEIGHT, WIDTH, 4)), np.ones((HEIGHT, WIDTH))
    for t, x, y in zip(record.triangle.tolist(), record.x.tolist(), record.y.tolist(), strict=True):
        fragment = Fragment(primitives, t, x, y)
        registers = {
            Register.FOG: [0.0, 0.0, 0.0, 1.0],
            Register.PRIMARY_COLOR: fragment.color(0),
            Register.SECONDARY_COLOR: fragment.color(4),
            Register.SPARE1: [0.0] * 4,
            Register.TEXTURE2: [0.0, 0.0, 0.0, 1.0],
            Register.TEXTURE3: [0.0, 0.0, 0.0, 1.0],
        }
        for k, unit in enumerate(state.texture_units):
            registers[Register.TEXTURE0 + k] = sampled(fragment, textures[unit.texture], unit, k)
        registers[Register.SPARE0] = [0.0, 0.0, 0.0, registers[Register.TEXTURE0][3]]
        color = scalar_combine(state.register_combiners, registers)
        test = state.alpha_test
        if test is not None and not COMPARE[test.function](color[3], test.reference):
            continue
        if state.depth_test is not None:
            z = fragment.depth()
            if not COMPARE[state.depth_test.function](z, depths[y, x]):
                continue
            depths[y, x] = z
        stored = [float(value) for value in colors[y, x]]
        if state.blending is not None:
            color = blended(state.blending, color, stored)
        mask = state.color_mask
        for c, writes in enumerate((mask.red, mask.green, mask.blue, mask.alpha)):
            if writes:
                colors[y, x, c] = color[c]
    return colors, depths, len(record.triangle)


def test_the_ideals_subpixels_are_those_of_the_kernels():
    subpixels = 1 << IDEAL.arithmetic.subpixel_bits
    assert subpixels == PIXEL


@pytest.mark.parametrize("seed", range(24))
def test_every_bit_is_plain_pythons(seed):
    textures, draw = random_frame(random.Random(seed))
    loads = tuple(TexImage(label=name, texture=name, image=image) for name, image in textures.items())
    colors, depths, made = drawn(textures, draw)
    assert made > 20
    found = execute_ideal((*loads, draw), WIDTH, HEIGHT)
    np.testing.assert_array_equal(found.color, colors)
    np.testing.assert_array_equal(found.depth, depths)
