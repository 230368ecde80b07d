"""A frame of commands as the words, vertices and memory that an emulator would log of it.

It writes what ``reading`` reads. A command or a state that the format lacks is refused, so that no file draws
anything else than its commands.
"""

import struct
from collections.abc import Iterable
from dataclasses import replace
from typing import Any, NoReturn

import numpy as np

from fixedpipe.effects.conformance.texture_memory import WORD_BYTES, swizzled_places
from fixedpipe.effects.nv2a_frames import methods as M
from fixedpipe.effects.nv2a_frames.methods import Method
from fixedpipe.effects.refusal import Refusal
from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    LineRasterization,
    PolygonMode,
    PrimitiveType,
    ProvokingVertex,
    TextureShaderOperation,
    TextureTarget,
    VertexStage,
)
from fixedpipe.pipeline.notations.nv2a_dumps import METHODS
from fixedpipe.pipeline.notations.nv2a_registers import format_registers
from fixedpipe.pipeline.state import (
    ColorMask,
    LineState,
    PassState,
    PointState,
    Sampler,
    TextureShaderStage,
    TextureUnit,
    VertexState,
)
from fixedpipe.pipeline.textures.images import Texture
from fixedpipe.pipeline.textures.words import internal_format_of, texture_of_words

_ADDRESSES = {name: address for name, address, _, _ in METHODS}
_PROGRAM_RESULTS = VertexState(stage=VertexStage.PROGRAM_RESULTS)
_LINES = {PrimitiveType.LINES, PrimitiveType.LINE_STRIP, PrimitiveType.LINE_LOOP}
_ALIGNMENT = 128  # bytes of a texture's place in memory
# The stages of units that sample without a texture shader, by their textures' targets.
_SAMPLES = {
    TextureTarget.TEXTURE_2D: TextureShaderOperation.TEXTURE_2D,
    TextureTarget.TEXTURE_RECTANGLE: TextureShaderOperation.TEXTURE_2D,
    TextureTarget.TEXTURE_3D: TextureShaderOperation.TEXTURE_3D,
    TextureTarget.TEXTURE_CUBE_MAP: TextureShaderOperation.TEXTURE_CUBE_MAP,
}


# Fields that have registers here. Others keep OpenGL's initial values.
_STATE = (
    *("vertex", "polygon", "texture_units", "register_combiners", "texture_shader", "alpha_test"),
    *("stencil_test", "depth_test", "blending", "color_mask", "point", "line"),
)
_SAMPLER = (
    *("min_filter", "mag_filter", "wrap_s", "wrap_t", "wrap_r", "border_color", "signed_components"),
    *("min_lod", "max_lod", "max_level", "max_anisotropy"),
)


class Unwritable(Refusal):
    """A command or a state has no words in the format; the message is a sentence."""


def refuse(what: str) -> NoReturn:
    """Raise Unwritable: ``what`` is no part of the format."""
    raise Unwritable(f"A frame of the NV2A's words has no {what}.")


def frame_bytes(commands: Iterable[Any], width: int, height: int, depth_bits: int) -> bytes:
    """The file of a frame on a window. Raises Unwritable for what the format lacks."""
    if depth_bits not in M.DEPTHS:
        refuse(f"depth buffer of {depth_bits}")
    writer = _Writer(width, height, depth_bits)
    for command in commands:
        handle = _COMMANDS.get(type(command))
        if handle is None:
            refuse(type(command).__name__)
        handle(writer, command)
    head = M.MAGIC + struct.pack("<3I", width, height, M.DEPTHS[depth_bits])
    return head + b"".join(writer.records)


def _bits(value: float) -> int:
    """A number's bits in single precision, which must hold it."""
    single = np.float32(value)
    if float(single) != float(value) and value == value:
        refuse(f"number {value!r}: single precision does not hold it")
    return int(single.view(np.uint32))


def _byte(value: float) -> int:
    byte = round(255 * value)
    if not 0 <= byte <= 255 or abs(byte - 255 * value) > 1e-9:
        refuse(f"colour of {value!r}, which is no byte")
    return byte


def _argb(color: Any) -> int:
    red, green, blue, alpha = map(_byte, color)
    return alpha << 24 | red << 16 | green << 8 | blue


class _Writer:
    """What was written so far: words that have not changed are not written again."""

    def __init__(self, width, height, depth_bits):
        self.size, self.depth_bits = (width, height), depth_bits
        self.records: list[bytes] = []
        self.textures: dict[str, tuple[Texture, int, int, bool]] = {}
        self._written: dict[int, int] = {}
        self._end = _ALIGNMENT

    def word(self, method, value, again=False):
        """A register's word, where it is not there already; ``again``: always, as it does something."""
        if again or self._written.get(method) != value:
            self.records.append(struct.pack("<4I", M.WORDS, method, 1, value))
            self._written[method] = value

    # ------------------------------------------------------------------------------------------ commands

    def clear(self, command):
        if command.accumulation is not None or command.color_mask != ColorMask():
            refuse("Clear with a mask or of an accumulation buffer")
        width, height = self.size
        box = command.scissor
        left, right, top, bottom = 0, width - 1, 0, height - 1
        if box is not None:
            left, right = box.x, box.x + box.width - 1
            top, bottom = height - box.y - box.height, height - box.y - 1
            if not (0 <= left <= right < width and 0 <= top <= bottom < height):
                refuse("Clear of a box outside the window")
        bits = 0
        if command.color is not None:
            bits |= M.CLEAR_COLOR
            self.word(Method.COLOR_CLEAR_VALUE, _argb(command.color))
        largest = (1 << abs(self.depth_bits)) - 1
        stored = depth = 0
        if command.depth is not None:
            bits |= M.CLEAR_Z
            stored = depth = int(np.floor(command.depth * largest + 0.5))
        if command.stencil is not None and abs(self.depth_bits) != 16:
            bits |= M.CLEAR_STENCIL
            if command.stencil_write_mask != 0xFF:
                refuse("Clear with a stencil mask")
        if abs(self.depth_bits) != 16:
            stored = depth << 8 | (command.stencil or 0)
        self.word(Method.ZSTENCIL_CLEAR_VALUE, stored)
        self.word(Method.CLEAR_RECT_HORIZONTAL, right << 16 | left)
        self.word(Method.CLEAR_RECT_VERTICAL, bottom << 16 | top)
        self.word(Method.CLEAR_SURFACE, bits, again=True)

    def tex_image(self, command):
        texture = command.image
        if texture is None:
            refuse("TexImage of pixels in client memory")
        if texture.bits != 8 or texture.border:
            refuse("texture with a border, or with wide components")
        linear = texture.target is TextureTarget.TEXTURE_RECTANGLE
        memory, code = _memory_of(texture, linear)
        address = self._end
        self._end += -(-len(memory) // _ALIGNMENT) * _ALIGNMENT
        padded = memory + bytes(-len(memory) % 4)
        self.records.append(struct.pack("<3I", M.MEMORY, address, len(memory)) + padded)
        self.textures[command.texture] = texture, address, code, linear

    def draw(self, command):
        self.state(command.state)
        modes = command.state.polygon.front_mode, command.state.polygon.back_mode
        if _LINES & {command.mesh.primitive} or PolygonMode.LINE in modes:
            self._lines(command.state.line)
        self.vertices(command.mesh)

    # --------------------------------------------------------------------------------------------- state

    def state(self, state):
        """The words of a state. Raises Unwritable for a field that has none here."""
        plain = PassState(**{name: getattr(state, name) for name in _STATE})
        if state != plain:
            odd = [n for n in PassState.__slots__ if getattr(state, n) != getattr(plain, n)]
            refuse(f"{' or '.join(odd)} other than OpenGL's initial state")
        if state.vertex != _PROGRAM_RESULTS:
            refuse("vertex state but a vertex program's results")
        if state.register_combiners is None:
            refuse("pass without register combiners")
        stages = self._stages(state)
        for line in format_registers(state.register_combiners, stages).splitlines():
            name, _, value = line.partition(" = ")
            name, _, index = name.removeprefix("NV097_").partition("[")
            self.word(_ADDRESSES[name] + 4 * int(index.rstrip("]") or 0), int(value, 16))
        self._polygon(state.polygon)
        self._fragments(state)
        if (
            replace(state.point, size=1.0) != PointState()
            or int(8 * state.point.size) != 8 * state.point.size
        ):
            refuse("points with parameters, sprites, or sizes that are no eighths")
        self.word(Method.POINT_SIZE, int(8 * state.point.size))

    def _lines(self, line):
        """Lines are rectangles of whole eighths of a pixel."""
        rectangle = LineState(line.width, LineRasterization.RECTANGLE, smooth=line.smooth)
        if line != rectangle or int(8 * line.width) != 8 * line.width:
            refuse("lines but rectangles of whole eighths without a stipple")
        self.word(Method.LINE_WIDTH, int(8 * line.width))
        self.word(Method.LINE_SMOOTH_ENABLE, int(line.smooth))

    def _stages(self, state):
        units = state.texture_units
        for number in range(M.UNITS):
            unit = units[number] if number < len(units) else None
            self._unit(number, None if unit is None or unit.texture is None else unit)
        if len(units) > M.UNITS:
            refuse(f"texture unit {M.UNITS}")
        if state.texture_shader is None:
            return [
                TextureShaderStage(
                    TextureShaderOperation.NONE
                    if unit is None or unit.texture is None
                    else _SAMPLES[self._texture(unit)[0].target]
                )
                for unit in units
            ]
        for number, stage in enumerate(state.texture_shader):
            at = M.UNIT_STRIDE * number
            a1, a2, a3, a4 = stage.offset_texture_matrix
            for k, value in enumerate((a1, a2, a4, a3)):
                self.word(Method.TEXTURE_BUMP_ENV_MAT + at + 4 * k, _bits(value))
            self.word(Method.TEXTURE_BUMP_ENV_SCALE + at, _bits(stage.offset_texture_scale))
            self.word(Method.TEXTURE_BUMP_ENV_OFFSET + at, _bits(stage.offset_texture_bias))
            if stage.operation is TextureShaderOperation.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP:
                for k, value in enumerate(stage.constant_eye):
                    self.word(Method.EYE_VECTOR + 4 * k, _bits(value))
        return state.texture_shader

    def _texture(self, unit):
        if unit.texture not in self.textures:
            refuse(f"texture {unit.texture!r} that another command than TexImage made")
        return self.textures[unit.texture]

    def _unit(self, number, unit):
        at = M.UNIT_STRIDE * number
        if unit is None:
            self.word(Method.TEXTURE_CONTROL0 + at, 0)
            return
        texture, address, code, linear = self._texture(unit)
        if unit.coordinates != number:
            refuse(f"texture unit {number} with coordinates of unit {unit.coordinates}")
        plain = TextureUnit(
            *(unit.texture, unit.sampler, unit.lod_bias, unit.coordinates),
            cylinder_wrap=unit.cylinder_wrap,
            environment=unit.environment,
        )
        if unit != plain or unit.cylinder_wrap[3]:
            refuse("texture unit with generated coordinates, a matrix, sprites, tables or keys")
        sampler = unit.sampler
        if sampler != Sampler(**{name: getattr(sampler, name) for name in _SAMPLER}):
            refuse("sampler that compares, probes or has a base level")
        levels = min(len(texture.levels), sampler.max_level + 1)
        _, height, width = texture.levels[0].shape[:3]
        depth = texture.depth
        kind = 3 if texture.target is TextureTarget.TEXTURE_3D else 2
        word = 1 | kind << M.DIMENSIONS | code << M.COLOR | levels << M.LEVELS | 1 << M.BORDER_COLOR
        word |= (texture.target is TextureTarget.TEXTURE_CUBE_MAP) << M.CUBE_MAP
        if linear:
            self.word(Method.TEXTURE_IMAGE_RECT + at, width << 16 | height)
            self.word(Method.TEXTURE_CONTROL1 + at, width * WORD_BYTES[M.TEXELS_OF[code][0]] << 16)
        else:
            for shift, size in zip(M.SIZES, (width, height, depth), strict=True):
                word |= (size.bit_length() - 1) << shift
        self.word(Method.TEXTURE_OFFSET + at, address)
        self.word(Method.TEXTURE_FORMAT + at, word)
        wraps = sampler.wrap_s, sampler.wrap_t, sampler.wrap_r
        self.word(
            Method.TEXTURE_ADDRESS + at,
            sum(
                (M.WRAPS[wrap] | around << 4) << 8 * k
                for k, (wrap, around) in enumerate(zip(wraps, unit.cylinder_wrap[:3], strict=True))
            ),
        )
        most = (1 << M.LOD_BITS) - 1
        low, high = (int(min(max(256 * lod, 0), most)) for lod in (sampler.min_lod, sampler.max_lod))
        anisotropy = int(sampler.max_anisotropy).bit_length() - 1
        if sampler.max_anisotropy != 1 << anisotropy:
            refuse(f"anisotropy of {sampler.max_anisotropy}")
        control = 1 << M.ENABLED | high << M.MAX_LOD | low << M.MIN_LOD | anisotropy << 4
        self.word(Method.TEXTURE_CONTROL0 + at, control)
        signed = sampler.signed_components
        signs = (signed.red, signed.green, signed.blue, signed.alpha)
        bias = int(256 * unit.lod_bias) & ((1 << M.BIAS_BITS) - 1)
        filters = (
            M.FILTERS[sampler.min_filter] << M.MIN_FILTER | M.FILTERS[sampler.mag_filter] << M.MAG_FILTER
        )
        filters |= sum(sign << shift for sign, shift in zip(signs, M.SIGNED, strict=True))
        self.word(Method.TEXTURE_FILTER + at, filters | bias)
        self.word(Method.TEXTURE_BORDER_COLOR + at, _argb(sampler.border_color))

    def _polygon(self, polygon):
        self.word(Method.CULL_FACE_ENABLE, int(polygon.cull_face is not None))
        if polygon.cull_face is not None:
            self.word(Method.CULL_FACE, M.FACES[polygon.cull_face])
        self.word(Method.FRONT_FACE, M.FRONT_FACES[polygon.front_face])
        self.word(Method.FRONT_POLYGON_MODE, M.POLYGON_MODES[polygon.front_mode])
        self.word(Method.BACK_POLYGON_MODE, M.POLYGON_MODES[polygon.back_mode])
        self.word(Method.SHADE_MODE, M.SHADE_MODELS[polygon.shade_model])
        self.word(Method.FLAT_SHADE_OP, int(polygon.provoking_vertex is ProvokingVertex.FIRST))
        self.word(Method.POLY_OFFSET_FILL_ENABLE, int(polygon.offset_fill))
        self.word(Method.POLY_OFFSET_LINE_ENABLE, int(polygon.offset_line))
        self.word(Method.POLY_OFFSET_POINT_ENABLE, int(polygon.offset_point))
        self.word(Method.POLYGON_OFFSET_SCALE_FACTOR, _bits(polygon.offset_factor))
        self.word(Method.POLYGON_OFFSET_BIAS, _bits(polygon.offset_units))
        self.word(Method.POLY_SMOOTH_ENABLE, int(polygon.smooth))
        self.word(Method.POLYGON_STIPPLE_ENABLE, int(polygon.stipple is not None))
        if polygon.stipple is not None:
            for k, word in enumerate(struct.unpack(">32I", polygon.stipple)):
                self.word(Method.POLYGON_STIPPLE_PATTERN + 4 * k, word)

    def _fragments(self, state):
        mask = state.color_mask
        self.word(Method.COLOR_MASK, mask.alpha << 24 | mask.red << 16 | mask.green << 8 | int(mask.blue))
        self.word(Method.ALPHA_TEST_ENABLE, int(state.alpha_test is not None))
        if state.alpha_test is not None:
            self.word(Method.ALPHA_FUNC, M.COMPARISONS[state.alpha_test.function])
            self.word(Method.ALPHA_REF, _byte(state.alpha_test.reference))
        self.word(Method.DEPTH_TEST_ENABLE, int(state.depth_test is not None))
        if state.depth_test is not None:
            self.word(Method.DEPTH_FUNC, M.COMPARISONS[state.depth_test.function])
            self.word(Method.DEPTH_MASK, int(state.depth_test.write))
        self.word(Method.STENCIL_TEST_ENABLE, int(state.stencil_test is not None))
        if (test := state.stencil_test) is not None:
            self.word(Method.STENCIL_FUNC, M.COMPARISONS[test.function])
            self.word(Method.STENCIL_FUNC_REF, test.reference & 0xFF)
            self.word(Method.STENCIL_FUNC_MASK, test.mask)
            self.word(Method.STENCIL_MASK, test.write_mask)
            operations = test.fail, test.depth_fail, test.depth_pass
            for k, operation in enumerate(operations):
                self.word(Method.STENCIL_OP_FAIL + 4 * k, M.STENCIL_OPERATIONS[operation])
        self.word(Method.BLEND_ENABLE, int(state.blending is not None))
        if (blending := state.blending) is not None:
            self.word(Method.BLEND_FUNC_SFACTOR, M.FACTORS[blending.source])
            self.word(Method.BLEND_FUNC_DFACTOR, M.FACTORS[blending.destination])
            self.word(Method.BLEND_EQUATION, M.EQUATIONS[blending.equation])
            self.word(Method.BLEND_COLOR, _argb(blending.color))

    # ------------------------------------------------------------------------------------------ vertices

    def vertices(self, mesh: Mesh):
        """A Begin, the vertices of each run, and an End."""
        if mesh.normals is not None or mesh.weights is not None or mesh.edge_flags is not None:
            refuse("mesh with normals, weights or edge flags")
        if len(mesh.texture_coordinates) > M.UNITS:
            refuse(f"mesh with more than {M.UNITS} sets of texture coordinates")
        slots = {M.POSITION: self._positions(mesh.positions)}
        for slot, name in M.ATTRIBUTES.items():
            if (values := getattr(mesh, name)) is not None:
                slots[slot] = _four(values)
        for number, values in enumerate(mesh.texture_coordinates):
            slots[M.TEXTURE0 + number] = _four(values)
        rows = np.stack([slots[slot] for slot in sorted(slots)], axis=1)
        order = np.arange(len(rows)) if mesh.indices is None else mesh.indices
        start = 0
        for count in mesh.counts or (len(order),):
            self.word(Method.BEGIN_END, M.PRIMITIVES[mesh.primitive], again=True)
            run = np.ascontiguousarray(rows[order[start : start + count]], "<u4")
            mask = sum(1 << slot for slot in slots)
            self.records.append(struct.pack("<3I", M.VERTICES, mask, len(run)) + run.tobytes())
            self.word(Method.BEGIN_END, 0, again=True)
            start += count

    def _positions(self, positions):
        place = np.zeros((len(positions), 4))
        place[:, 3] = 1.0
        place[:, : positions.shape[1]] = positions
        place[:, 1] = self.size[1] - place[:, 1]
        return _singles(place)


def _singles(values):
    """The bits of numbers that single precision holds, uint32 of the same shape."""
    with np.errstate(invalid="ignore", over="ignore"):
        singles = values.astype(np.float32)
    if not np.array_equal(singles.astype(np.float64), values, equal_nan=True):
        refuse("vertex whose numbers single precision does not hold")
    return singles.view(np.uint32)


def _four(values):
    """Attributes [n] or [n, 1..4] as bits [n, 4]; what is missing is 0, and the fourth 1."""
    values = values.reshape(len(values), -1)
    filled = np.zeros((len(values), 4))
    filled[:, 3] = 1.0
    filled[:, : values.shape[1]] = values
    return _singles(filled)


def _packed(texels, word):
    """Words of register bytes [..., 4] in a layout."""
    red, green, blue, alpha = (texels[..., k].astype(np.uint32) for k in range(4))
    if word not in _PACKING:
        refuse(f"texture of words {word.name}")
    return _PACKING[word](red, green, blue, alpha)


_PACKING = {
    M.TexelWord.A8R8G8B8: lambda r, g, b, a: a << 24 | r << 16 | g << 8 | b,
    M.TexelWord.X8R8G8B8: lambda r, g, b, a: a << 24 | r << 16 | g << 8 | b,
    M.TexelWord.R5G6B5: lambda r, g, b, a: r >> 3 << 11 | g >> 2 << 5 | b >> 3,
    M.TexelWord.A1R5G5B5: lambda r, g, b, a: a >> 7 << 15 | r >> 3 << 10 | g >> 3 << 5 | b >> 3,
    M.TexelWord.X1R5G5B5: lambda r, g, b, a: r >> 3 << 10 | g >> 3 << 5 | b >> 3,
    M.TexelWord.A4R4G4B4: lambda r, g, b, a: a >> 4 << 12 | r >> 4 << 8 | g >> 4 << 4 | b >> 4,
    M.TexelWord.R6G5B5: lambda r, g, b, a: r >> 2 << 10 | g >> 3 << 5 | b >> 3,
    M.TexelWord.Y8: lambda r, g, b, a: r,
    M.TexelWord.AY8: lambda r, g, b, a: a,
    M.TexelWord.A8: lambda r, g, b, a: a,
    M.TexelWord.A8Y8: lambda r, g, b, a: a << 8 | r,
    M.TexelWord.G8B8: lambda r, g, b, a: g << 8 | b,
    M.TexelWord.R8B8: lambda r, g, b, a: r << 8 | b,
}


def _memory_of(texture, linear):
    """(the bytes of a texture in memory, its colour format). Raises Unwritable for texels without words."""
    wanted = texture.internal_format
    words = [M.STORED_AS[wanted]] if wanted in M.STORED_AS else list(_PACKING)
    word = next((w for w in words if wanted in (internal_format_of(w), *M.STORED_AS)), None)
    if word is None:
        refuse(f"texture of format {wanted.name}")
    if linear and len(texture.levels) > 1:
        refuse("rectangle texture with several levels")
    size, faces = WORD_BYTES[word], []
    layered = texture.target is TextureTarget.TEXTURE_3D
    for face in range(1 if layered else len(texture.levels[0])):
        memory = b""
        for level in texture.levels:
            texels = level if layered else level[face : face + 1]
            packed = _packed(texels, word)
            again = texture_of_words(packed.astype(np.int64), word, texture.target).levels[0]
            if not np.array_equal(again, texels):
                refuse(f"texture of format {wanted.name} whose texels are no words {word.name}")
            memory += _placed(packed, linear, size)
        faces.append(memory + bytes(-len(memory) % _ALIGNMENT if len(texture.levels[0]) > 1 else 0))
    return b"".join(faces), M.TEXEL_FORMATS[word][linear]


def _placed(words, linear, size):
    """Words [layers, rows, columns] in the order of memory."""
    if linear:
        return words.astype(f"<u{size}").tobytes()
    layers, height, width = words.shape
    if any(edge & (edge - 1) for edge in (layers, height, width)):
        refuse(f"swizzled texture of {width}x{height}x{layers} texels")
    out = np.empty(words.size, f"<u{size}")
    out[swizzled_places(width, height, layers).reshape(-1)] = words.reshape(-1)
    return out.tobytes()


_COMMANDS = {Clear: _Writer.clear, TexImage: _Writer.tex_image, Draw: _Writer.draw}
