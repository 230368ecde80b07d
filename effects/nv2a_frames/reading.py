"""A file of the NV2A's words, vertices and memory as commands, which any engine draws."""

import struct
from dataclasses import dataclass, replace
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.conformance.texture_memory import WORD_BYTES, swizzled_places
from fixedpipe.effects.nv2a_frames import methods as M
from fixedpipe.effects.nv2a_frames.methods import Method
from fixedpipe.effects.refusal import Refusal, refusals
from fixedpipe.pipeline.commands import Clear, Command, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import LineRasterization, ProvokingVertex, TextureTarget, VertexStage
from fixedpipe.pipeline.enums import TextureShaderOperation as Op
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.notations import nv2a_registers
from fixedpipe.pipeline.notations.nv2a_dumps import METHODS
from fixedpipe.pipeline.notations.tokens import ProgramTextError
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.state import (
    AlphaTest,
    Blending,
    ColorMask,
    DepthTest,
    LineState,
    PassState,
    PointState,
    PolygonState,
    Sampler,
    Scissor,
    SignedComponents,
    StencilTest,
    TextureUnit,
    VertexState,
)
from fixedpipe.pipeline.textures.images import Texture
from fixedpipe.pipeline.textures.words import texture_of_words

MOST_BYTES = 256 << 20  # of a file, and of the memory that it fills
MOST_EDGE, MOST_COMMANDS = 4096, 100_000
_PROGRAM_RESULTS = VertexState(stage=VertexStage.PROGRAM_RESULTS)
_COMBINERS = {
    address + 4 * k: f"0x{address + 4 * k:04x}: 0x" for _, address, count, _ in METHODS for k in range(count)
}
_KNOWN = {int(method) for method in Method} | set(_COMBINERS)
_KNOWN |= {Method.POLYGON_STIPPLE_PATTERN + 4 * k for k in range(32)}
_KNOWN |= {Method.EYE_VECTOR + 4 * k for k in range(3)}
_KNOWN |= {Method.TEXTURE_BUMP_ENV_MAT + 4 * k for k in range(4)}
_KNOWN |= {
    known + M.UNIT_STRIDE * unit
    for known in tuple(_KNOWN)
    if 0x1B00 <= known < 0x1B00 + M.UNIT_STRIDE
    for unit in range(M.UNITS)
}
# Targets of lookups that a linear texture makes a rectangle's.
_RECTANGLES = {
    Op.TEXTURE_2D: Op.TEXTURE_RECTANGLE,
    Op.OFFSET_TEXTURE_2D: Op.OFFSET_TEXTURE_RECTANGLE,
    Op.OFFSET_TEXTURE_2D_SCALE: Op.OFFSET_TEXTURE_RECTANGLE_SCALE,
}


@dataclass(frozen=True, eq=False)
class Frame:
    """A frame: what to draw, on a window of ``width`` by ``height`` pixels with a depth buffer."""

    commands: tuple[Command, ...]
    width: int
    height: int
    depth_bits: int

    def image(self, threads: int | None = None) -> NDArray[np.uint8]:
        """The window as the NV2A leaves it, uint8 [height, width, 4], top row first. Raises UnsupportedState
        for what the NV2A lacks.
        """
        window = {"depth_bits": self.depth_bits, "threads": threads}
        return execute(self.commands, NV2A, self.width, self.height, **window).framebuffer.image()


def read_frame(data: bytes, name: str) -> Frame:
    """The Frame of a file. ``name``: of the file, for sentences. Raises Refusal."""
    if len(data) > MOST_BYTES:
        raise Refusal(f"{name} has {len(data)} bytes; at most {MOST_BYTES} are read.")
    if not data.startswith(M.MAGIC):
        raise Refusal(f"{name} is no frame of the NV2A's words: it does not begin with {M.MAGIC.decode()}.")
    with refusals():  # what a mesh or a texture cannot be
        return _Reader(data, name).frame()


class _Reader:
    """Reads records in order, and keeps the registers and the memory that they fill."""

    def __init__(self, data, name):
        self._data, self._name, self._at = data, name, len(M.MAGIC)
        self.registers: dict[int, int] = {}
        self.memory: list[tuple[int, bytes]] = []
        self.commands: list[Any] = []
        self._textures: dict[Any, str] = {}
        self._primitive = None
        self._states: dict[Any, Any] = {}
        self._changed, self._filled = True, 0
        self.width, self.height, depth = self._words(3)
        if not (1 <= self.width <= MOST_EDGE and 1 <= self.height <= MOST_EDGE):
            self.wrong(f"has a window of {self.width}x{self.height}; give 1 to {MOST_EDGE} pixels an edge")
        self.depth_bits = M.kind_of(M.DEPTHS, depth)
        if self.depth_bits is None:
            self.wrong(f"has depth format {depth}; give 0 to {len(M.DEPTHS) - 1}")

    def wrong(self, what: str) -> NoReturn:
        """Raise Refusal, at the place that was read last."""
        raise Refusal(f"{self._name}, before byte {self._at}, {what}.")

    def _take(self, count):
        end = self._at + count
        if end > len(self._data):
            self.wrong(f"ends within a record; {end - len(self._data)} bytes are missing")
        taken = self._data[self._at : end]
        self._at = end
        return taken

    def _words(self, count):
        return struct.unpack(f"<{count}I", self._take(4 * count))

    def frame(self):
        """Everything, as a Frame."""
        while self._at < len(self._data):
            kind, place, count = self._words(3)
            handle = _RECORDS.get(kind)
            if handle is None:
                self.wrong(f"has a record of kind {kind}; there are {', '.join(map(str, _RECORDS))}")
            handle(self, place, count)
            if len(self.commands) > MOST_COMMANDS:
                self.wrong(f"has more than {MOST_COMMANDS} commands; cut the frame")
        if self._primitive is not None:
            self.wrong("ends before SET_BEGIN_END 0; end the primitive")
        return Frame(tuple(self.commands), self.width, self.height, int(self.depth_bits))

    # ------------------------------------------------------------------------------------------- records

    def words(self, method, count):
        """A run of registers, from ``method`` on."""
        for k, value in enumerate(self._words(count)):
            address = method + 4 * k
            if address not in _KNOWN:
                self.wrong(f"sets register 0x{address:04x}, which is no part of the format")
            self.registers[address] = value
            self._changed = True
            if address in _ACTIONS:
                _ACTIONS[address](self, value)

    def fill(self, address, count):
        """Bytes of memory."""
        self.memory.append((address, self._take(count)))
        self._take(-count % 4)
        self._filled += count
        if self._filled > MOST_BYTES:
            self.wrong(f"fills more than {MOST_BYTES} bytes of memory")
        self._changed = True

    def vertices(self, mask, count):
        """Vertices of the primitive that was begun."""
        if self._primitive is None:
            self.wrong("has vertices before SET_BEGIN_END; begin a primitive")
        slots = [slot for slot in range(M.SLOTS) if mask >> slot & 1]
        known = {M.POSITION, *M.ATTRIBUTES, *range(M.TEXTURE0, M.TEXTURE0 + M.UNITS)}
        if mask >> M.SLOTS or not known >= {*slots} or M.POSITION not in slots or not count:
            self.wrong(f"has {count} vertices with the attributes 0x{mask:x}; give slots 0, 3 to 12")
        data = self._take(16 * len(slots) * count)
        rows = np.frombuffer(data, "<f4").reshape(count, len(slots), 4).astype(np.float64)
        columns = {slot: rows[:, k] for k, slot in enumerate(slots)}
        positions = columns[M.POSITION].copy()
        positions[:, 1] = self.height - positions[:, 1]
        arrays = {name: columns[slot] for slot, name in M.ATTRIBUTES.items() if slot in columns}
        for name in ("fog_coordinates", "point_sizes"):
            if name in arrays:
                arrays[name] = arrays[name][:, 0]
        sets = [columns.get(M.TEXTURE0 + unit) for unit in range(M.UNITS)]
        while sets and sets[-1] is None:
            sets.pop()
        nothing = np.tile([0.0, 0.0, 0.0, 1.0], (count, 1))
        coordinates = tuple(nothing if each is None else each for each in sets)
        state = self.state()  # which may store textures first
        mesh = Mesh(positions, self._primitive, texture_coordinates=coordinates, **arrays)
        self.commands.append(Draw(label=f"draw {len(self.commands)}", mesh=mesh, state=state))

    # ------------------------------------------------------------------------------------------- actions

    def begin_end(self, value):
        """SET_BEGIN_END: a primitive, or 0."""
        primitive = M.kind_of(M.PRIMITIVES, value)
        if value and primitive is None:
            self.wrong(f"begins primitive {value}; there are 1 to {len(M.PRIMITIVES)}")
        if value and self._primitive is not None:
            self.wrong("begins a primitive within another; set SET_BEGIN_END to 0 first")
        self._primitive = primitive

    def clear(self, bits):
        """CLEAR_SURFACE."""
        stored = self.registers.get(Method.ZSTENCIL_CLEAR_VALUE, 0)
        narrow = abs(self.depth_bits) == 16
        depth = stored & 0xFFFF if narrow else stored >> 8
        color = bits & M.CLEAR_COLOR
        if color not in (0, M.CLEAR_COLOR):
            self.wrong(f"clears some of the colour's components, 0x{bits:x}; clear all or none")
        self.commands.append(
            Clear(
                label=f"clear {len(self.commands)}",
                color=self._color(Method.COLOR_CLEAR_VALUE) if color else None,
                depth=depth / ((1 << abs(self.depth_bits)) - 1) if bits & M.CLEAR_Z else None,
                stencil=stored & 0xFF if bits & M.CLEAR_STENCIL and not narrow else None,
                scissor=self._clear_box(),
            )
        )

    def _clear_box(self):
        across, down = (
            self.registers.get(method)
            for method in (Method.CLEAR_RECT_HORIZONTAL, Method.CLEAR_RECT_VERTICAL)
        )
        if across is None or down is None:
            return None
        left, right, top, bottom = across & 0xFFFF, across >> 16, down & 0xFFFF, down >> 16
        if not (left <= right < self.width and top <= bottom < self.height):
            self.wrong(f"clears the box {left}, {top} to {right}, {bottom}, outside the window")
        if (left, top, right, bottom) == (0, 0, self.width - 1, self.height - 1):
            return None
        return Scissor(left, self.height - 1 - bottom, right - left + 1, bottom - top + 1)

    # --------------------------------------------------------------------------------------------- state

    def get(self, method, default=0):
        """A register's word."""
        return self.registers.get(method, default)

    def member(self, table, method, default):
        """The member that a register names. Raises Refusal for a value that is none."""
        value = self.get(method)
        if method not in self.registers:
            return default
        found = M.kind_of(table, value)
        if found is None:
            self.wrong(f"sets 0x{int(method):04x} to 0x{value:x}, which is no {type(default).__name__}")
        return found

    def number(self, method, default=0.0):
        """A register's single-precision number."""
        if method not in self.registers:
            return default
        return struct.unpack("<f", struct.pack("<I", self.registers[method]))[0]

    def _color(self, method):
        word = self.get(method)
        return tuple((word >> shift & 0xFF) / 255.0 for shift in (16, 8, 0, 24))

    def state(self):
        """The state that the registers hold, and TexImages of the textures that it reads."""
        if not self._changed:
            return self._states[None]
        stages, combiners = self._programs()
        units = [self._unit(number) for number in range(M.UNITS)]
        while units and units[-1] is None:
            units.pop()
        if stages is not None:
            stages = self._with_registers(stages, units)
        blending = None
        if self.get(Method.BLEND_ENABLE):
            blending = Blending(
                self.member(M.FACTORS, Method.BLEND_FUNC_SFACTOR, M.BlendFactor.ONE),
                self.member(M.FACTORS, Method.BLEND_FUNC_DFACTOR, M.BlendFactor.ZERO),
                self.member(M.EQUATIONS, Method.BLEND_EQUATION, M.BlendEquation.FUNC_ADD),
                self._color(Method.BLEND_COLOR),
            )
        mask = self.get(Method.COLOR_MASK, 0x01010101)
        state = PassState(
            vertex=_PROGRAM_RESULTS,
            polygon=self._polygon(),
            texture_units=tuple(units),
            register_combiners=combiners,
            texture_shader=stages,
            blending=blending,
            color_mask=ColorMask(*(bool(mask >> shift & 1) for shift in (16, 8, 0, 24))),
            line=LineState(
                self.get(Method.LINE_WIDTH, 8) / 8.0,
                LineRasterization.RECTANGLE,
                smooth=bool(self.get(Method.LINE_SMOOTH_ENABLE)),
            ),
            point=PointState(self.get(Method.POINT_SIZE, 8) / 8.0),
            **self._tests(),
        )
        self._states[None], self._changed = state, False
        return state

    def _tests(self):
        always, keep = M.ComparisonFunction.ALWAYS, M.StencilOperation.KEEP
        alpha = depth = stencil = None
        if self.get(Method.ALPHA_TEST_ENABLE):
            function = self.member(M.COMPARISONS, Method.ALPHA_FUNC, always)
            alpha = AlphaTest(function, (self.get(Method.ALPHA_REF) & 0xFF) / 255.0)
        if self.get(Method.DEPTH_TEST_ENABLE):
            function = self.member(M.COMPARISONS, Method.DEPTH_FUNC, M.ComparisonFunction.LESS)
            depth = DepthTest(function, bool(self.get(Method.DEPTH_MASK, 1)))
        if self.get(Method.STENCIL_TEST_ENABLE):
            stencil = StencilTest(
                self.member(M.COMPARISONS, Method.STENCIL_FUNC, always),
                self.get(Method.STENCIL_FUNC_REF) & 0xFF,
                self.get(Method.STENCIL_FUNC_MASK, 0xFF) & 0xFF,
                *(self.member(M.STENCIL_OPERATIONS, Method.STENCIL_OP_FAIL + 4 * k, keep) for k in range(3)),
                self.get(Method.STENCIL_MASK, 0xFF) & 0xFF,
            )
        return {"alpha_test": alpha, "depth_test": depth, "stencil_test": stencil}

    def _polygon(self):
        stipple = None
        if self.get(Method.POLYGON_STIPPLE_ENABLE):
            rows = [self.get(Method.POLYGON_STIPPLE_PATTERN + 4 * k) for k in range(32)]
            stipple = struct.pack(">32I", *rows)
        culls = self.get(Method.CULL_FACE_ENABLE)
        first = self.get(Method.FLAT_SHADE_OP)
        return PolygonState(
            cull_face=self.member(M.FACES, Method.CULL_FACE, M.Face.BACK) if culls else None,
            front_face=self.member(M.FRONT_FACES, Method.FRONT_FACE, M.FrontFace.CCW),
            offset_fill=bool(self.get(Method.POLY_OFFSET_FILL_ENABLE)),
            offset_factor=self.number(Method.POLYGON_OFFSET_SCALE_FACTOR),
            offset_units=self.number(Method.POLYGON_OFFSET_BIAS),
            shade_model=self.member(M.SHADE_MODELS, Method.SHADE_MODE, M.ShadeModel.SMOOTH),
            provoking_vertex=ProvokingVertex.FIRST if first else ProvokingVertex.LAST,
            front_mode=self.member(M.POLYGON_MODES, Method.FRONT_POLYGON_MODE, M.PolygonMode.FILL),
            back_mode=self.member(M.POLYGON_MODES, Method.BACK_POLYGON_MODE, M.PolygonMode.FILL),
            offset_line=bool(self.get(Method.POLY_OFFSET_LINE_ENABLE)),
            offset_point=bool(self.get(Method.POLY_OFFSET_POINT_ENABLE)),
            stipple=stipple,
            smooth=bool(self.get(Method.POLY_SMOOTH_ENABLE)),
        )

    def _programs(self):
        """(texture shader stages or None, combiners) of the registers."""
        lines = [
            f"{_COMBINERS[address]}{value:08x}"
            for address, value in self.registers.items()
            if address in _COMBINERS
        ]
        if not lines:
            self.wrong("draws before it sets a register of the combiners; set SET_COMBINER_CONTROL")
        try:
            stages, combiners, _, _ = nv2a_registers.parse("\n".join(lines) + "\n")
        except ProgramTextError as error:
            self.wrong(f"has registers of the combiners that fit no program: {error}")
        if combiners is None:
            self.wrong("draws without general combiners; set SET_COMBINER_CONTROL")
        return stages, combiners

    def _with_registers(self, stages, units):
        """Stages with the numbers of their units' registers; None where each unit only samples."""
        sampled = [self._sampled(number) for number in range(len(stages))]
        if [stage.operation for stage in stages] == sampled:
            return None
        made = []
        last = max(k for k, stage in enumerate(stages) if stage.operation is not Op.NONE)
        units += [None] * (last + 1 - len(units))
        for number, stage in enumerate(stages[: last + 1]):
            if units[number] is None and stage.operation is not Op.NONE:
                units[number] = TextureUnit(None, coordinates=number)  # a stage without a texture
            at = M.UNIT_STRIDE * number
            a1, a2, a4, a3 = (
                self.number(Method.TEXTURE_BUMP_ENV_MAT + at + 4 * k, float(k in (0, 2))) for k in range(4)
            )
            eye = tuple(self.number(Method.EYE_VECTOR + 4 * k, (0.0, 0.0, -1.0)[k]) for k in range(3))
            unit = units[number]
            linear = unit is not None and unit.texture is not None and self._linear(number)
            made.append(
                replace(
                    stage,
                    operation=_RECTANGLES.get(stage.operation, stage.operation)
                    if linear
                    else stage.operation,
                    offset_texture_matrix=(a1, a2, a3, a4),
                    offset_texture_scale=self.number(Method.TEXTURE_BUMP_ENV_SCALE + at, 1.0),
                    offset_texture_bias=self.number(Method.TEXTURE_BUMP_ENV_OFFSET + at, 0.0),
                    constant_eye=eye,
                )
            )
        return tuple(made)

    # ------------------------------------------------------------------------------------------ textures

    def _code(self, number):
        return self.get(Method.TEXTURE_FORMAT + M.UNIT_STRIDE * number) >> M.COLOR & 0xFF

    def _linear(self, number):
        code = self._code(number)
        return code in M.TEXELS_OF and M.TEXELS_OF[code][1]

    def _sampled(self, number):
        """What a unit's stage does where it only samples: the operation of its texture's own target."""
        at = M.UNIT_STRIDE * number
        if not self.get(Method.TEXTURE_CONTROL0 + at) >> M.ENABLED & 1:
            return Op.NONE
        word = self.get(Method.TEXTURE_FORMAT + at)
        if word >> M.CUBE_MAP & 1:
            return Op.TEXTURE_CUBE_MAP
        return Op.TEXTURE_3D if word >> M.DIMENSIONS & 0xF == 3 else Op.TEXTURE_2D

    def _unit(self, number):
        at = M.UNIT_STRIDE * number
        control = self.get(Method.TEXTURE_CONTROL0 + at)
        if not control >> M.ENABLED & 1:
            return None
        name = self._stored(number)
        address, filters = self.get(Method.TEXTURE_ADDRESS + at), self.get(Method.TEXTURE_FILTER + at)
        wraps = [M.kind_of(M.WRAPS, address >> 8 * k & 0xF) for k in range(3)]
        least, most = (M.kind_of(M.FILTERS, filters >> shift & 0xF) for shift in (M.MIN_FILTER, M.MAG_FILTER))
        if None in (*wraps, least, most):
            self.wrong(
                f"has address modes 0x{address:x} and filters 0x{filters:x}, which are none, of unit {number}"
            )
        field = (1 << M.LOD_BITS) - 1
        low, high = ((control >> shift & field) / 256.0 for shift in (M.MIN_LOD, M.MAX_LOD))
        bias = filters & ((1 << M.BIAS_BITS) - 1)
        bias -= (bias >> (M.BIAS_BITS - 1)) << M.BIAS_BITS
        sampler = Sampler(
            least,
            most,
            wraps[0],
            wraps[1],
            self._color(Method.TEXTURE_BORDER_COLOR + at),
            wrap_r=wraps[2],
            min_lod=low,
            max_lod=high,
            max_level=max(1, self.get(Method.TEXTURE_FORMAT + at) >> M.LEVELS & 0xF) - 1,
            signed_components=SignedComponents(*(bool(filters >> shift & 1) for shift in M.SIGNED)),
            max_anisotropy=float(1 << (control >> 4 & 3)),
        )
        around = (*(bool(address >> (8 * k + 4) & 1) for k in range(3)), False)
        return TextureUnit(name, sampler, bias / 256.0, number, cylinder_wrap=around)

    def _stored(self, number):
        """The name of a unit's texture, which a TexImage stores where it is new."""
        at = M.UNIT_STRIDE * number
        words = [
            self.get(method + at)
            for method in (
                *(Method.TEXTURE_OFFSET, Method.TEXTURE_FORMAT, Method.TEXTURE_CONTROL1),
                Method.TEXTURE_IMAGE_RECT,
            )
        ]
        key = (*words, len(self.memory))
        if key not in self._textures:
            name = self._textures[key] = f"texture {len(self._textures)}"
            image = self._image(number, *words)
            self.commands.append(TexImage(label=name, texture=name, image=image))
        return self._textures[key]

    def _image(self, number, offset, word, pitch, rect) -> Texture:
        code = word >> M.COLOR & 0xFF
        if code not in M.TEXELS_OF:
            self.wrong(f"has texture format 0x{code:02x} in unit {number}, which is no part of the format")
        kind, linear = M.TEXELS_OF[code]
        size = WORD_BYTES[kind]
        if linear:
            width, height, pitch = rect >> 16, rect & 0xFFFF, pitch >> 16
            if pitch * height > MOST_BYTES:
                self.wrong(f"has a texture of {pitch * height} bytes; at most {MOST_BYTES} are read")
            if not (
                width and height and pitch >= width * size and width <= MOST_EDGE and height <= MOST_EDGE
            ):
                self.wrong(f"has a texture of {width}x{height} with a pitch of {pitch} in unit {number}")
            rows = self._bytes(offset, pitch * height).reshape(height, pitch)[:, : width * size]
            words = np.ascontiguousarray(rows).view(f"<u{size}").astype(np.int64)
            return texture_of_words(words, kind, TextureTarget.TEXTURE_RECTANGLE)
        width, height, depth = (1 << (word >> shift & 0xF) for shift in M.SIZES)
        cube, solid = word >> M.CUBE_MAP & 1, (word >> M.DIMENSIONS & 0xF) == 3
        if max(width, height, depth) > MOST_EDGE or width * height * depth > MOST_EDGE**2 or (cube and solid):
            self.wrong(f"has a texture of {width}x{height}x{depth} in unit {number}")
        levels = max(1, min(word >> M.LEVELS & 0xF, max(width, height, depth).bit_length()))
        target = TextureTarget.TEXTURE_2D
        if cube or solid:
            target = TextureTarget.TEXTURE_CUBE_MAP if cube else TextureTarget.TEXTURE_3D
        faces: list[list[Any]] = [[] for _ in range(levels)]
        for _ in range(6 if cube else 1):
            for level in range(levels):
                shape = tuple(max(1, edge >> level) for edge in (depth if solid else 1, height, width))
                count = shape[0] * shape[1] * shape[2]
                stored = self._bytes(offset, count * size).view(f"<u{size}").astype(np.int64)
                faces[level].append(stored[swizzled_places(shape[2], shape[1], shape[0])])
                offset += count * size
            offset += -offset % 128 if cube else 0
        return texture_of_words([np.concatenate(each) for each in faces], kind, target)

    def _bytes(self, address, count):
        """Memory as it is filled now; what nothing filled is 0."""
        found = np.zeros(count, np.uint8)
        for start, data in self.memory:
            first, last = max(start, address), min(start + len(data), address + count)
            if first < last:
                part = np.frombuffer(data, np.uint8)[first - start : last - start]
                found[first - address : last - address] = part
        return found


_RECORDS = {M.WORDS: _Reader.words, M.MEMORY: _Reader.fill, M.VERTICES: _Reader.vertices}
_ACTIONS = {Method.BEGIN_END: _Reader.begin_end, Method.CLEAR_SURFACE: _Reader.clear}
