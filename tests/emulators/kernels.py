"""Random inputs of every rule in columns, and what our kernels make of them: for ``tests.emulators.fuzz``.

A rule's entry draws columns from a generator, in the order of the rule's inputs, and computes the result's
column. A column is int64 or float64, [n] or [n, k]; an input that is a name is the same for a whole batch.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from fixedpipe.effects.arithmetic.rules import RULES
from fixedpipe.pipeline import enums as E
from fixedpipe.pipeline.columns.combiners import arithmetic_of
from fixedpipe.pipeline.framebuffers.framebuffer import surface_word
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.state import Fog, FogRegisters
from fixedpipe.pipeline.textures.depth_words import DEPTH_WORDS
from fixedpipe.pipeline.textures.words import (
    compressed_texture,
    stored_texture,
    texels_of_words,
    ycbcr_to_rgb,
)
from fixedpipe.pipeline.vertices import chip_floats
from fixedpipe.pipeline.vertices.chip_floats import LIGHTING_BITS
from fixedpipe.pipeline.vertices.colors import color_byte
from fixedpipe.pipeline.vertices.fog import TABLE_SIZE, table, vertex_value
from fixedpipe.pipeline.vertices.projection import composite_coordinates, snap
from fixedpipe.pipeline.vertices.vertex_programs import vertex_program
from fixedpipe.raster import codes as C
from fixedpipe.raster.columns import combine, interpolate, per_fragment, sample, texture_shader
from fixedpipe.raster.columns.numbers import lerp, quotient, with_fog
from tests.emulators.slopes import slopes_of_w

CHIP = arithmetic_of(NV2A, 8)
INSIDE = (0, 1, 2, 126, 127, 128, 129, 254, 255)
OUTSIDE = (-256, -255, -129, -128, -127, -2, -1, *INSIDE)
SPECIAL = np.array(
    [0, 1 << 31, 0x3F800000, 0xBF800000, 0x00800000, 0x00080000, 0x7F7FFFFF, 0x7F800000], np.uint32
)


class Drawn:
    """Columns of ``count`` random numbers."""

    def __init__(self, random, count):
        self.random, self.count = random, count

    def _shape(self, width):
        return self.count if width is None else (self.count, width)

    def ints(self, low, high, width=None):
        """Whole numbers from low to high."""
        return self.random.integers(low, high + 1, self._shape(width))

    def near(self, low, high, special, width=None):
        """The same; a quarter of them special ones."""
        found = self.ints(low, high, width)
        chosen = self.random.random(found.shape) < 0.25
        return np.where(chosen, self.random.choice(np.array(special), found.shape), found)

    def bytes(self, width=None):
        """Bytes, of which a quarter are where arithmetic changes."""
        return self.near(0, 255, INSIDE, width)

    def registers(self, width=None):
        """What a combiner's register holds."""
        return self.near(-256, 255, OUTSIDE, width)

    def _singles(self, low, high, width):
        bits = self.random.integers(0, 1 << 23, self._shape(width), dtype=np.uint32)
        bits |= self.random.integers(low, high + 1, bits.shape, dtype=np.uint32) << np.uint32(23)
        return bits | self.random.integers(0, 2, bits.shape, dtype=np.uint32) << np.uint32(31)

    @staticmethod
    def _doubles(bits):
        return bits.view(np.float32).astype(np.float64)

    def ordinary(self, octaves, width=None, signed=True):
        """Singles of 2^-octaves to 2^octaves."""
        found = self._doubles(self._singles(127 - octaves, 126 + octaves, width))
        return found if signed else np.abs(found)

    def numbers(self, width=None, special=SPECIAL):
        """Singles: of any exponent, near one, and some special ones."""
        bits = self._singles(1, 254, width)
        kind = self.random.random(bits.shape)
        bits = np.where(kind < 0.5, self._singles(123, 130, width), bits)
        bits = np.where(kind > 0.95, self.random.choice(special, bits.shape), bits)
        return self._doubles(bits)

    def short(self, octaves=None):
        """Numbers of the lighting unit's 14 bits: of any exponent, or within octaves."""
        return chip_floats.to_lighting(self.numbers() if octaves is None else self.ordinary(octaves))

    def fractions(self):
        """Singles from 0 to 1."""
        return self.random.integers(0, (1 << 24) + 1, self.count) / (1 << 24)

    def one_of(self, names):
        """A name for the whole batch."""
        return names[self.random.integers(len(names))]


@dataclass(frozen=True)
class Fuzzed:
    """How a rule is fuzzed: ``draw`` makes columns, so many in a batch, and ``compute`` their result."""

    draw: Any
    compute: Any
    batch: int = 1 << 17


FUZZED: dict[str, Fuzzed] = {}


def _add(id_, draw, compute, **rest):
    FUZZED[id_] = Fuzzed(draw, compute, **rest)


# ------------------------------------------------------------------------------------------------- vertices


def _instruction(name, kinds):
    scalar = kinds[0] == "single"
    read = ", ".join(f"v[{i}]" + (".x" if scalar else "") for i in range(len(kinds)))
    program = vertex_program(f"{name} o[COL0], {read};")

    def compute(*operands):
        return program.run({i: v[:, None] if scalar else v for i, v in enumerate(operands)})["COL0"]

    return compute


for _id, _rule in RULES.items():
    if _id.startswith("vertex-") and _id != "vertex-arl":
        _kinds = tuple(_rule.inputs.values())
        _width = None if _kinds[0] == "single" else 4
        _add(
            _id,
            lambda d, kinds=_kinds, width=_width: tuple(d.numbers(width) for _ in kinds),
            _instruction(_id.removeprefix("vertex-").upper(), _kinds),
        )
_add("vertex-arl", lambda d: (d.ordinary(20),), np.floor)
_NORMAL = np.array(
    [0, 1 << 31, 0x3F800000, 0xBF800000, 0x00800000, 0x7F7FFFFF, 0x7F800000, 0xFF800000], np.uint32
)
for _id, _function in (
    ("reciprocal", chip_floats.transform_reciprocal),
    ("inverse-square-root", chip_floats.transform_inverse_root),
):
    _add(_id, lambda d: (d.numbers(special=_NORMAL),), _function)
for _id, _function in (
    ("lighting-reciprocal", chip_floats.lighting_reciprocal),
    ("lighting-inverse-square-root", chip_floats.lighting_inverse_root),
):
    _add(_id, lambda d: (chip_floats.to_lighting(d.numbers(special=_NORMAL)),), _function)
_add("enter-lighting", lambda d: (d.numbers(),), chip_floats.to_lighting)
_FLAT = np.array([0, 0x3F800000, 0x7F800000, 0xFF800000], np.uint32)
_add(
    "lighting-product",
    lambda d: tuple(chip_floats.to_lighting(d.numbers(special=_FLAT)) for _ in "ab"),
    lambda a, b: chip_floats.product(a, b, LIGHTING_BITS),
)
_add(
    "lighting-sum",
    lambda d: tuple(d.short(12) for _ in "abc"),
    lambda a, b, c: chip_floats.total((a, b, c), LIGHTING_BITS),
)
for _id, _function in (
    ("lighting-multiply-add", chip_floats.multiply_add),
    ("lighting-add-product", chip_floats.add_product),
):
    _add(
        _id,
        lambda d: tuple(d.short(16) for _ in "abc"),
        lambda a, b, c, f=_function: f(a, b, c, LIGHTING_BITS),
    )
_add(
    "window-coordinate",
    lambda d: (d.ordinary(10), d.ordinary(4, signed=False), d.ordinary(4)),
    lambda x, w, o: composite_coordinates((x, x, x, w), (o, o, o), 0.0)[0],
)
_add(
    "snapped-coordinate",
    lambda d: (d.ordinary(24), np.full(d.count, d.random.integers(1, 4097))),
    lambda x, extent: snap(x, extent[0], NV2A),
)
_add(
    "color-to-byte", lambda d: (d.fractions(),), lambda v: color_byte(v, NV2A.arithmetic.color_mantissa_bits)
)

# -------------------------------------------------------------------------------------------- rasterization

_BOX = 12  # pixels along an edge of what a triangle's coverage is asked of


def _coverage_inputs(d):
    count = max(1, d.count // (_BOX * _BOX))
    corners = np.repeat(d.random.integers(-64, 193, (count, 6)), _BOX * _BOX, axis=0)
    py, px = (np.tile(g.ravel(), count) for g in np.mgrid[:_BOX, :_BOX])
    return corners[:, :3], corners[:, 3:], px, py


def _covered(x, y, px, py):
    found = np.zeros(len(x), np.int64)
    for k in range(0, len(x), _BOX * _BOX):
        inside = interpolate.covered_pixels(x[k].tolist(), y[k].tolist(), (1.0,) * 3, (0, 0, _BOX, _BOX), 4)
        found[k + inside[1] * _BOX + inside[0]] = 1
    return found


_add("coverage", _coverage_inputs, _covered)


def _edges(d):
    return np.concatenate([d.ints(0, (1 << 20) - 1, 2), d.ints(1, 1 << 20, 1)], axis=1)


def _inverse_w(d):
    flat = d.random.random((d.count, 1)) < 0.25
    return np.where(flat, 1.0, d.ordinary(3, 3, signed=False))


def _weights(n, inverse_w):
    return interpolate.iteration_weights(tuple(n.T), inverse_w)


_add(
    "weight-reciprocal", lambda d: (d.ints(1 << 23, (1 << 24) - 1).astype(float),), interpolate.reciprocal_24
)
_add(
    "iteration-weights",
    lambda d: (_edges(d), _inverse_w(d)),
    lambda n, w: np.stack(_weights(n, w), axis=1),
)
_add(
    "iterated-color",
    lambda d: (_edges(d), _inverse_w(d), d.bytes(3)),
    lambda n, w, c: interpolate.iterate_colors(*_weights(n, w), c[:, :, None], 8)[:, 0],
)
_add(
    "iterated-coordinate",
    lambda d: (_edges(d), _inverse_w(d), d.ordinary(2, 3)),
    lambda n, w, v: interpolate.iterate_coordinates(*_weights(n, w), v[:, :, None])[0][:, 0],
)
_add(
    "divided-coordinate",
    lambda d: (d.numbers(), d.numbers()),
    lambda c, q: interpolate.times_reciprocal_of_q(np.stack([c, c, c, q], axis=1))[:, 0],
)
_DEPTHS = lambda d: d.ints(0, (1 << 24) - 1, 3).astype(np.float64)  # noqa: E731
_add("depth", lambda d: (_edges(d), _DEPTHS(d)), lambda n, z: interpolate.iterate_depth(tuple(n.T), z))
_add(
    "depth-of-w",
    lambda d: (_edges(d), d.ordinary(3, 3, signed=False)),
    lambda n, w: interpolate.iterate_w(*_weights(n, 1.0 / w), w),
)


def _slope(x, y, v, factor):
    area = (x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (x[:, 2] - x[:, 0]) * (y[:, 1] - y[:, 0])
    return interpolate.depth_slope(x, y, area, v, factor, 4)


_add(
    "polygon-offset-slope",
    lambda d: (d.ints(0, 10239, 3), d.ints(0, 10239, 3), _DEPTHS(d), d.ordinary(2)),
    _slope,
)
_add(
    "slope-of-w",
    lambda d: (
        d.ints(-160, 800, 3),
        d.ints(-160, 800, 3),
        d.ordinary(3, 3, signed=False),
        np.concatenate([d.ints(0, 7, 2), d.ints(9, 39, 2)], axis=1),
    ),
    slopes_of_w,
)


def _depth_word(depth_format):
    words = DEPTH_WORDS[depth_format]

    def draw(d):
        if words.form is None:
            return (words.largest * (1.25 * d.fractions() - 0.125),)
        return (np.abs(d.numbers()) if depth_format == E.DepthFormat.FLOAT_24 else d.ordinary(12),)

    return draw, lambda z: interpolate.depth_words(z, 0.0, words.farthest, words.farthest, words.form)[0]


for _name in ("FIXED_16", "FIXED_24", "FLOAT_16", "FLOAT_24"):
    _add(f"depth-word-{_name.lower().replace('_', '-')}", *_depth_word(E.DepthFormat[_name]))

# ------------------------------------------------------------------------------------------------- textures

for _id in RULES:
    if _id.startswith("texel-"):
        _kind = E.TexelWord[_id.removeprefix("texel-").upper()]
        _add(_id, lambda d: (d.ints(0, 65535),), lambda w, kind=_kind: texels_of_words(w, kind))
_add("signed-texel", lambda d: (d.ints(0, 255),), lambda b: 2 * texture_shader.signed(b, 8))
_add("ycbcr", lambda d: tuple(d.ints(0, 255) for _ in "ybr"), lambda *v: np.stack(ycbcr_to_rgb(*v), axis=1))


def _blocks(name, size):
    across = 256  # blocks

    def compute(words):
        data = np.ascontiguousarray(words.astype("<u4")).tobytes()
        down = len(words) // across
        texture = compressed_texture(
            data, E.InternalFormat[f"COMPRESSED_RGBA_S3TC_{name}"], 4 * across, 4 * down
        )
        image = stored_texture(texture, NV2A).levels[0][0]
        rows = image.reshape(down, 4, across, 4, 4).swapaxes(1, 2)
        return np.ascontiguousarray(rows).view("<u4").reshape(len(words), 16).astype(np.int64)

    return lambda d: (d.ints(0, (1 << 32) - 1, size // 4),), compute


for _name, _size in (("DXT1", 8), ("DXT3", 16), ("DXT5", 16)):
    _add(_name.lower(), *_blocks(_name, _size))


def _place(d):
    size, wrap = int(1 << d.random.integers(0, 9)), d.one_of([w.name for w in E.WrapMode])
    return d.ints(-2 * size * 4096, 3 * size * 4096) / 4096.0, size, wrap


def _border(found):
    index, outside = found
    return index if outside is None else np.where(outside, -1, index)


def _nearest(t, size, wrap):
    return _border(sample.along(t, E.WrapMode[wrap], size, False, 8)[0][0])


def _linear(t, size, wrap):
    pair, weight = sample.along(t, E.WrapMode[wrap], size, True, 8)
    return np.stack([*map(_border, pair), weight], axis=1)


def _bilinear(p00, p10, p01, p11, a, b):
    level = np.stack([np.stack([p00, p01], axis=1).ravel(), np.stack([p10, p11], axis=1).ravel()], axis=1)
    up = 2.0 * np.arange(len(a)) + 0.5 + b / 256.0
    modes = (C.WRAP_CLAMP_TO_EDGE,) * 3
    return sample.filter_level(
        level[None, :, :, None],
        (0.5 + a / 256.0, up, None),
        None,
        modes,
        True,
        C.TARGET_2D,
        np.array([0]),
        8,
        None,
    )[:, 0]


_add("nearest-texel", _place, _nearest, batch=1 << 12)
_add("linear-texels", _place, _linear, batch=1 << 12)
_add("filter-step", lambda d: (d.bytes(), d.bytes(), d.ints(0, 255)), lambda p, q, f: lerp(p, q, f, 8))
_add("bilinear", lambda d: (*(d.bytes() for _ in range(4)), d.ints(0, 255), d.ints(0, 255)), _bilinear)
_add("lambda", lambda d: (d.ordinary(30) ** 2,), interpolate.log2_q7)


def _directions(d):
    s, t, r = d.ordinary(3), d.ordinary(3), d.ordinary(3)
    return np.where(d.random.random(d.count) < 0.1, r, s), np.where(d.random.random(d.count) < 0.1, -r, t), r


def _on_face(s, t, r):
    direction = np.stack([s, t, r, np.ones_like(s)], axis=1)
    return np.stack(sample.positions(direction, C.TARGET_CUBE_MAP, False, (64, 64, 6))[0][:2], axis=1)


_add("cube-face", _directions, lambda s, t, r: interpolate.major_axis(np.stack([s, t, r], axis=1)))
_add("cube-texel", _directions, _on_face)

# ------------------------------------------------------------------------------------------ texture shaders

for _id in RULES:
    if _id.startswith("dot-mapping-"):
        _kind = E.DotProductMapping[_id.removeprefix("dot-mapping-").upper().replace("-", "_")]
        _add(
            _id,
            lambda d: (d.bytes(4),),
            lambda t, kind=_kind: np.stack(
                [np.broadcast_to(v, len(t)) for v in texture_shader.vector(t, kind, 8)], axis=1
            ),
        )
_add("shader-result-byte", lambda d: (d.numbers(),), lambda v: texture_shader.real_texel(v, 8))
_add(
    "offset-texture",
    lambda d: (d.ordinary(3, 2), d.bytes(4), np.repeat(Drawn(d.random, 1).ordinary(3, 4), d.count, axis=0)),
    lambda st, texel, matrix: np.stack(texture_shader.offset(st, texel, matrix[0], 8), axis=1),
    batch=1 << 12,
)
_add(
    "offset-luminance",
    lambda d: (d.bytes(4), d.bytes(), *(np.repeat(Drawn(d.random, 1).ordinary(2), d.count) for _ in "sb")),
    lambda texel, m, scale, bias: texture_shader.scaled(texel, 8, m, 8, scale[0], bias[0]),
    batch=1 << 12,
)
_add(
    "reflection",
    lambda d: (d.ordinary(3, 3), d.ordinary(3, 3)),
    lambda n, e: np.stack(texture_shader.reflected(tuple(n.T), tuple(e.T)), axis=1),
)


def _replaced(a, b):
    word, inside = texture_shader.replaced_depth(a, b, 1.0, 0xFFFFFF)
    return np.where(inside, word, -1)


_add("depth-replace", lambda d: (d.ordinary(14), d.ordinary(14)), _replaced)
_add(
    "cull-fragment",
    lambda d: (d.numbers(4), [d.one_of([m.name for m in E.CullMode]) for _ in range(4)]),
    lambda v, modes: texture_shader.kept(v, [E.CullMode[m] for m in modes]).astype(np.int64),
    batch=1 << 14,
)

# ------------------------------------------------------------------------------------------------ combiners

for _id in RULES:
    if _id.startswith("mapping-"):
        _kind = E.Mapping[_id.removeprefix("mapping-").upper().replace("-", "_")]
        _add(_id, lambda d: (d.registers(),), lambda x, kind=_kind: combine.map_input(x, kind, CHIP))


def _output(*products, scale="NONE", bias="NONE"):
    return combine.output(list(products), E.CombinerScale[scale], bool(E.CombinerBias[bias]), CHIP)


_add("rn", lambda d: (d.ints(-(1 << 19), 1 << 19),), lambda n: quotient(n, 255))
_add("product", lambda d: (d.registers(), d.registers()), lambda a, b: _output(a * b))
_add(
    "sum-of-products",
    lambda d: tuple(d.registers() for _ in "abcd"),
    lambda a, b, c, d: _output(a * b, c * d),
)
_add(
    "dot-product",
    lambda d: (d.registers(3), d.registers(3)),
    lambda a, b: _output(*(a[:, k] * b[:, k] for k in range(3))),
)
_SCALES = [
    *((scale.name, "NONE") for scale in E.CombinerScale),
    ("NONE", "BIAS_BY_NEGATIVE_ONE_HALF"),
    ("SCALE_BY_TWO", "BIAS_BY_NEGATIVE_ONE_HALF"),
]
_add(
    "scale-and-bias",
    lambda d: (d.ints(-1024, 1024), *d.one_of(_SCALES)),
    lambda x, scale, bias: _output(255 * x, scale=scale, bias=bias),
    batch=1 << 14,
)
_add("general-clamp", lambda d: (d.ints(-2048, 2048),), lambda x: _output(255 * x))
_add(
    "mux-takes-cd",
    lambda d: (d.registers(), d.one_of(("MSB", "LSB"))),
    lambda a, select: combine.takes_cd(a, select == "LSB", CHIP).astype(np.int64),
    batch=1 << 14,
)
_add(
    "final-mapping",
    lambda d: (d.ints(-256, 510), d.one_of(("UNSIGNED_IDENTITY", "UNSIGNED_INVERT"))),
    lambda x, mapping: combine.map_final(x, mapping == "UNSIGNED_INVERT", CHIP),
    batch=1 << 14,
)
_add("final-product", lambda d: (d.bytes(), d.bytes()), lambda e, f: combine.product(e * f, CHIP))


def _final(a, b, c, d):
    return combine.final_color(*(v[None] for v in (a, b, c, d)), np.zeros((1, len(a)), np.int64), CHIP)[0]


_add("final-lerp", lambda d: tuple(d.near(0, 510, INSIDE) for _ in "abcd"), _final)

# ------------------------------------------------------------------------------- fog, fragments and blending

for _id, _mode, _folded in (
    ("linear", E.FogMode.LINEAR, False),
    ("exp", E.FogMode.EXP, False),
    ("exp-abs", E.FogMode.EXP, True),
    ("exp2", E.FogMode.EXP2, True),
):
    _add(
        f"fog-factor-{_id}",
        lambda d: (d.ints(0, TABLE_SIZE - 1),),
        lambda n, key=(_mode, _folded): table(*key)[n].astype(np.int64),
    )


def _fog_line(mode, bias, multiplier, c):
    fog = Fog(E.FogMode[mode], registers=FogRegisters(bias=float(bias[0]), multiplier=float(multiplier[0])))
    return vertex_value(fog, c)


_add(
    "fog-line",
    lambda d: (
        d.one_of(("LINEAR", "EXP", "EXP2")),
        *(np.repeat(Drawn(d.random, 1).ordinary(k), d.count) for k in (3, 6)),
        d.numbers(),
    ),
    _fog_line,
    batch=1 << 12,
)
_add(
    "fog-blend", lambda d: tuple(d.bytes() for _ in "fcg"), lambda f, color, fog: with_fog(color, fog, f, 255)
)
_add(
    "alpha-test",
    lambda d: (d.bytes(), d.one_of([f.name for f in E.ComparisonFunction]), d.bytes()),
    lambda a, f, b: per_fragment.compare(E.ComparisonFunction[f], a, b).astype(np.int64),
    batch=1 << 14,
)
_add(
    "stencil-operation",
    lambda d: (
        d.one_of([o.name for o in E.StencilOperation]),
        d.bytes(),
        np.repeat(d.ints(0, 255)[:1], d.count),
    ),
    lambda o, stored, reference: per_fragment.stencil_result(
        E.StencilOperation[o], stored, int(reference[0])
    ),
    batch=1 << 12,
)


def _factor(factor):
    def compute(s, d, constant):
        return np.broadcast_to(per_fragment.blend_factor(factor, s, d, constant[0], 255), s.shape)

    return compute


def _constant(d):
    return np.repeat(Drawn(d.random, 1).bytes(4), d.count, axis=0)


def _equation(equation):
    def compute(s, fs, d, fd):
        zero = np.zeros_like(s)
        source, destination = np.stack([s, zero, zero, fd], axis=1), np.stack([d, zero, zero, zero], axis=1)
        factors = (E.BlendFactor.CONSTANT_COLOR, E.BlendFactor.SRC_ALPHA)
        constant = np.array([fs[0], 0, 0, 0])
        return np.clip(per_fragment.blend(equation, factors, source, destination, constant, 8)[:, 0], 0, 255)

    return compute


for _id in RULES:
    if _id.startswith("blend-factor-"):
        _kind = E.BlendFactor[_id.removeprefix("blend-factor-").upper().replace("-", "_")]
        _add(_id, lambda d: (d.bytes(4), d.bytes(4), _constant(d)), _factor(_kind), batch=1 << 12)
    elif _id.startswith("blend-"):
        _kind = E.BlendEquation[_id.removeprefix("blend-").upper().replace("-", "_")]
        _add(
            _id,
            lambda d: (d.bytes(), np.repeat(d.bytes()[:1], d.count), d.bytes(), d.bytes()),
            _equation(_kind),
            batch=1 << 12,
        )
    elif _id.startswith("surface-"):
        _kind = E.ColorFormat[_id.removeprefix("surface-").upper().replace("-", "_")]
        _add(_id, lambda d: (d.bytes(4),), lambda c, kind=_kind: surface_word(tuple(c.T), kind))
_add(
    "logic-operation",
    lambda d: (d.one_of([o.name for o in E.LogicOperation]), d.bytes(), d.bytes()),
    lambda o, s, d: per_fragment.logic(E.LogicOperation[o], s, d, 255),
    batch=1 << 14,
)
