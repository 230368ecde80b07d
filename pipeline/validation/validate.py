"""What a machine refuses, and why: every command is checked before any is executed.

``validate`` walks the commands in order, knows which textures exist when each is reached, and raises
``UnsupportedState`` at the first thing that the profile could not hold or that no machine could mean. Every
sentence names the command, what was given, what the machine allows, and what to do about it.

Source: the errors of OpenGL 1.2.1, NV_register_combiners and 2, EXT_texture_cube_map, NV_texgen_reflection,
EXT_texture_lod_bias, EXT_stencil_wrap, EXT_fog_coord, NV_texture_shader, EXT_point_parameters,
NV_point_sprite, ARB_texture_env_combine and _dot3, NV_texture_env_combine4. Where OpenGL clamps silently
(clear colours, constant colours, alpha and stencil references) so do the stages that follow, and nothing is
refused; where it calls the result undefined (pixels read outside the framebuffer, an incomplete texture) this
module refuses.
"""

import math
from dataclasses import fields, is_dataclass, replace
from enum import Enum
from functools import cache
from numbers import Integral, Real
from types import NoneType, UnionType
from typing import NamedTuple, get_args, get_origin
from weakref import WeakKeyDictionary, WeakSet

import numpy as np

from pipeline.columns import invert_upper_left
from pipeline.commands import (
    Accum,
    BindTexImage,
    Bitmap,
    Clear,
    CopyPixels,
    CopyTexImage,
    CopyTexSubImage,
    Draw,
    DrawPixels,
    HostStep,
    MakeCurrent,
    Mesh,
    ReadPixels,
    ResetHistogram,
    ResetMinmax,
    Saturate,
    TexImage,
    kind_of,
    vertex_of,
)
from pipeline.enums import (
    AccumOperation,
    BaseFormat,
    ColorBuffer,
    ColorFormat,
    DepthFormat,
    FogCoordinateSource,
    FogMode,
    InternalFormat,
    LightingArithmetic,
    PixelCopyType,
    PolygonMode,
    PrimitiveType,
    TexGenMode,
    TextureCompareMode,
    TextureFilter,
    TextureShaderOperation,
    TextureTarget,
    VertexStage,
    WrapMode,
)
from pipeline.framebuffer import DEPTH_READABLE_AS, READ_FORMATS, READABLE_AS
from pipeline.pixel_transfer import PixelMaps, PixelTransfer
from pipeline.profile import NATIVE_SUBPIXEL_BITS
from pipeline.programs.combiner_rules import TEXTURE_REGISTERS, combiner_problems, nv2a_flag, registers_named
from pipeline.programs.future import future_problem
from pipeline.programs.texture_environment import environment_problem, texture_format
from pipeline.programs.texture_shader_rules import (
    DEPENDENT,
    SCALING,
    TARGETS_READ,
    WITHOUT_TEXTURE,
    shader_stages,
    stage_problem,
    stage_width_problem,
)
from pipeline.state import (
    ColorTable,
    Light,
    Lighting,
    Material,
    PassState,
    RegisterCombiners,
    SignedComponents,
    TextureUnit,
    VertexState,
    needs_normals,
)
from pipeline.strokes import line_problem
from pipeline.textures import COMPONENT_BITS, DEPTH_TEXELS, TWELVE_BIT_FORMATS, Texture, stored_widths
from pipeline.transfer import (
    DEPTH_FORMAT,
    IMAGE_FORMATS,
    READ_TYPES,
    PixelStatistics,
    has_sink,
    transferred_size,
)
from pipeline.validation.rectangles import bits_problem, pixel_texture_problem, rectangle_problem
from pipeline.validation.sampling import probes_problem, shadow_problem
from pipeline.validation.transfer import color_table_problem, pixel_image_problem, transfer_problem

_FIXED_DEPTHS = (InternalFormat.DEPTH_COMPONENT16, InternalFormat.DEPTH_COMPONENT24)
_READ_FORMATS = (*READ_FORMATS, "DEPTH_COMPONENT", "STENCIL_INDEX")


class UnsupportedState(ValueError):  # noqa: N818 (it names what was asked for)
    """A command that the machine could not execute; the message is a sentence that says what to do."""


# ----------------------------------------------------------------------------- what was found right before


class _Remembered(dict):
    """Objects that were found right, by their identity and what else the finding depends on.

    By identity, because equal states may differ in what is checked (1, 1.0 and True are equal). An object is
    held as long as it is remembered, so its identity is nobody else's; all are forgotten when there are
    ``most``.
    """

    def __init__(self, most=4096):
        super().__init__()
        self.most = most

    def add(self, value, *beside, finding=True):
        if len(self) >= self.most:
            self.clear()
        self[(id(value), *beside) if beside else id(value)] = value, finding


# Parts that many states share, because dataclasses.replace keeps them.
_SHARED_PARTS = (VertexState, TextureUnit, RegisterCombiners, PixelTransfer, PixelMaps, ColorTable)


# ------------------------------------------------------------------------------- types of state fields


class _Wrong(NamedTuple):
    """What is wrong with a value: the fields that lead to it, and the sentence's predicate."""

    path: str
    predicate: str

    def below(self, field):
        return _Wrong(field + self.path, self.predicate)


def _shown(value):
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."


def _enum_check(kind):
    example = f"{kind.__name__}.{next(iter(kind)).name}"

    def check(value):
        if isinstance(value, kind):
            return None
        if isinstance(value, str) and value.upper() in kind.__members__:
            return _Wrong("", f"is the string {value!r}; give the member {kind.__name__}.{value.upper()}")
        return _Wrong("", f"is {_shown(value)}; it takes a member of {kind.__name__}, {example} for instance")

    return check


def _check_bool(value):
    if isinstance(value, bool | np.bool_):
        return None
    return _Wrong("", f"is {_shown(value)}; it is a switch: give True or False")


def _check_int(value):
    if isinstance(value, Integral) and not isinstance(value, bool):
        if -(2**31) <= value < 2**31:
            return None
        return _Wrong("", f"is {value}; OpenGL's integers have 32 bits: give one from -2**31 to 2**31 - 1")
    return _Wrong("", f"is {_shown(value)}; give an integer")


def _check_float(value):
    if type(value) is float and math.isfinite(value):
        return None
    if isinstance(value, Real) and not isinstance(value, bool):
        try:
            finite = math.isfinite(value)
        except OverflowError:  # an integer beyond every float
            finite = False
        return None if finite else _Wrong("", f"is {_shown(value)}; give a finite number")
    return _Wrong("", f"is {_shown(value)}; give a number")


def _check_str(value):
    if not isinstance(value, str):
        return _Wrong("", f"is {_shown(value)}; give a string")
    return None if value.strip() else _Wrong("", "is empty; give it a name")


def _fixed_tuple_check(kinds):
    checks = [_type_check(kind) for kind in kinds]
    n, all_floats = len(kinds), all(kind is float for kind in kinds)

    def check(value):
        if not isinstance(value, tuple):
            return _Wrong("", f"is {_shown(value)}; give a tuple of {n}")
        if len(value) != n:
            return _Wrong("", f"has {len(value)} elements; give {n}")
        if all_floats and all(type(v) is float for v in value) and math.isfinite(sum(value)):
            return None
        for i, v in enumerate(value):
            if wrong := checks[i](v):
                return wrong.below(f"[{i}]")
        return None

    return check


def _long_tuple_check(kind):
    check_one = _type_check(kind)

    def check(value):
        if not isinstance(value, tuple):
            return _Wrong("", f"is {_shown(value)}; give a tuple")
        for i, v in enumerate(value):
            if wrong := check_one(v):
                return wrong.below(f"[{i}]")
        return None

    return check


def _dataclass_check(kind):
    checks = [(f.name, _type_check(f.type)) for f in fields(kind)]

    def check(value):
        if not isinstance(value, kind):
            return _Wrong("", f"is {_shown(value)}; give a value of type {kind.__name__}")
        for name, check_field in checks:
            if wrong := check_field(getattr(value, name)):
                return wrong.below(f".{name}")
        return None

    return _remembering(check) if kind in _SHARED_PARTS else check


def _remembering(check):
    """The same check, which looks at an object once."""
    right = _Remembered()

    def check_once(value):
        if id(value) in right:
            return None
        if wrong := check(value):
            return wrong
        right.add(value)
        return None

    return check_once


def _optional_check(kind):
    check_present = _type_check(kind)

    def check(value):
        return None if value is None else check_present(value)

    return check


def _check_bytes(value):
    return None if isinstance(value, bytes) else _Wrong("", f"is {_shown(value)}; give bytes")


_LEAVES = {
    bool: _check_bool,
    int: _check_int,
    float: _check_float,
    str: _check_str,
    bytes: _check_bytes,
}


@cache
def _type_check(annotation):
    """A function from a value to None, or to what is wrong with it, made once for each annotation."""
    if annotation in _LEAVES:
        return _LEAVES[annotation]
    if get_origin(annotation) is UnionType:
        (present,) = (a for a in get_args(annotation) if a is not NoneType)
        return _optional_check(present)
    if get_origin(annotation) is tuple:
        inner = get_args(annotation)
        return _long_tuple_check(inner[0]) if inner[-1] is Ellipsis else _fixed_tuple_check(inner)
    if issubclass(annotation, Enum):
        return _enum_check(annotation)
    if is_dataclass(annotation) and annotation not in (Mesh, Texture):
        return _dataclass_check(annotation)

    def check(value):
        if isinstance(value, annotation):
            return None
        return _Wrong("", f"is {_shown(value)}; give a value of type {annotation.__name__}")

    return check


# ------------------------------------------------------------------------------------ meshes, textures

_checked_meshes = WeakSet()
_checked_textures = WeakSet()

_MESH_ARRAYS = (
    ("positions", (2, 4)),
    ("colors", (3, 4)),
    ("secondary_colors", (3, 4)),
    ("back_colors", (3, 4)),
    ("back_secondary_colors", (3, 4)),
    ("normals", (3, 3)),
)


def _array_problem(name, array, vertices, low, high):
    """What is wrong with a vertex array [vertices, low..high], or None."""
    components = str(low) if low == high else f"{low} to {high}"
    if array.ndim != 2 or not low <= array.shape[1] <= high:
        return f"{name} has shape {array.shape}; give [vertices, {components}]."
    if len(array) != vertices:
        return f"{name} has {len(array)} vertices but positions has {vertices}; give one row for each vertex."
    return _finite_problem(name, array)


def _finite_problem(name, array):
    finite = np.isfinite(array)
    if finite.all():
        return None
    bad = np.argwhere(~finite)[0]
    value = array[tuple(bad)]
    return (
        f"{name} of vertex {bad[0]} holds {value}; the machine has no meaning for it. Give finite numbers, "
        "and drop vertices that have none."
    )


def _mesh_problem(mesh):
    if wrong := _type_check(PrimitiveType)(mesh.primitive):
        return f"the mesh's primitive {wrong.predicate}."
    vertices = len(mesh.positions) if mesh.positions.ndim else 0
    for name in ("fog_coordinates", "point_sizes", "edge_flags"):
        array = getattr(mesh, name)
        if array is not None and array.ndim != 1:
            return f"the mesh's {name} has shape {array.shape}; give [vertices]."
        if array is not None and (
            problem := _array_problem(f"the mesh's {name}", array[:, None], vertices, 1, 1)
        ):
            return problem
    for name, (low, high) in _MESH_ARRAYS:
        array = getattr(mesh, name)
        if array is not None and (
            problem := _array_problem(f"the mesh's {name}", array, vertices, low, high)
        ):
            return problem
    for i, array in enumerate(mesh.texture_coordinates):
        if problem := _array_problem(f"the mesh's texture coordinate set {i}", array, vertices, 1, 4):
            return problem
    drawn = vertices
    if mesh.indices is not None:
        if mesh.indices.ndim != 1:
            return f"the mesh's indices has shape {mesh.indices.shape}; give one list of vertex numbers."
        drawn = len(mesh.indices)
        if drawn and not 0 <= mesh.indices.min() <= mesh.indices.max() < vertices:
            at = int(np.argmax((mesh.indices < 0) | (mesh.indices >= vertices)))
            return (
                f"index {at} of the mesh is vertex {mesh.indices[at]}, but it has {vertices} vertices; give "
                f"numbers from 0 to {vertices - 1}."
            )
    return _counts_problem(mesh.counts, drawn)


def _counts_problem(counts, drawn):
    if counts is None:
        return None
    try:
        given = [int(c) for c in counts if not _check_int(c)]
        wrong = len(given) != len(counts)
    except TypeError:
        wrong = True
    if wrong or any(c < 0 for c in given):
        return f"the mesh's counts is {_shown(counts)}; give a tuple of integers, none negative."
    if sum(given) != drawn:
        return (
            f"the mesh's counts add up to {sum(given)} but it draws {drawn} vertices; give counts that take "
            "every vertex exactly once."
        )
    return None


def complete_levels(width, height):
    """How many levels a complete mipmap of a width x height texture has (OpenGL 1.2.1, section 3.8.5)."""
    return max(width, height).bit_length()


_PARTS = {
    TextureTarget.TEXTURE_CUBE_MAP: ("cube map", "faces"),
    TextureTarget.TEXTURE_3D: ("3D texture", "layers"),
}
_LOD_LIMIT = 1000.0  # the initial limits of table 3.17


def _faces(image, level):
    """How many images level ``level`` of a texture has: faces or layers."""
    if image.target is TextureTarget.TEXTURE_3D:
        return max(1, image.depth >> level)
    return 6 if image.target is TextureTarget.TEXTURE_CUBE_MAP else 1


def _texture_problem(image):
    """What no machine could hold in a Texture, or None."""
    for name, kind in (("target", TextureTarget), ("internal_format", InternalFormat)):
        if wrong := _type_check(kind)(getattr(image, name)):
            return f"the texture's {name} {wrong.predicate}."
    if not isinstance(image.levels, tuple) or not image.levels:
        return "the texture has no level 0; make textures with texture_1d, texture_2d or texture_cube_map."
    bits = image.bits
    if isinstance(bits, bool) or not isinstance(bits, Integral) or not 4 <= bits <= 16:
        return f"the texture's components have {bits!r} bits; give 4 to 16."
    dtype = np.dtype(np.uint8 if bits == 8 else np.uint16)
    for level, array in enumerate(image.levels):
        if (
            not isinstance(array, np.ndarray)
            or array.dtype != dtype
            or array.ndim != 4
            or array.shape[3] != 4
        ):
            return (
                f"level {level} of the texture is not {dtype} [faces, height, width, 4]; make textures with "
                "texture_2d."
            )
        if array.size and int(array.max()) >= 1 << bits:
            return f"level {level} of the texture holds {int(array.max())}; one is {(1 << bits) - 1}."
        faces = _faces(image, level)
        if array.shape[0] != faces:
            given = _count(array.shape[0], _PARTS.get(image.target, ("", "faces"))[1].removesuffix("s"))
            return f"level {level} of a {image.target.name} has {given}; it takes {faces}."
        height, width = array.shape[1:3]
        if not height or not width:
            return f"level {level} of the texture is {width}x{height} texels; a texture needs at least 1x1."
        expected = (max(1, image.height >> level), max(1, image.width >> level))
        if (height, width) != expected:
            return (
                f"level {level} of a {image.width}x{image.height} texture is {width}x{height}; it takes "
                f"{expected[1]}x{expected[0]}. Build the levels with mipmaps=True."
            )
    if len(image.levels) > complete_levels(image.width, max(image.height, image.depth)):
        return (
            f"the texture has {len(image.levels)} levels but a {image.width}x{image.height} image ends at "
            "1x1 before."
        )
    if image.target is TextureTarget.TEXTURE_CUBE_MAP and image.width != image.height:
        return f"the cube map's faces are {image.width}x{image.height}; they must be square."
    if image.target is TextureTarget.TEXTURE_RECTANGLE and len(image.levels) > 1:
        return f"the TEXTURE_RECTANGLE has {len(image.levels)} levels; it has level 0 alone."
    if image.target is TextureTarget.TEXTURE_1D and image.height != 1:
        return f"the 1D texture is {image.height} texels high; give one row, or use texture_2d."
    if image.ideal is not None:
        if [a.shape for a in image.ideal] != [a.shape for a in image.levels]:
            return "the texture's ideal levels do not have its levels' shapes; give the same, or None."
        if not all(np.isfinite(a).all() for a in image.ideal):
            return "the texture's ideal levels hold NaN or infinity; give finite texels."
    return None


class _Surface(NamedTuple):
    """What validation remembers of a pbuffer: everything that it keeps from its first MakeCurrent on."""

    width: int
    height: int
    color_format: ColorFormat
    depth_bits: int

    def __str__(self):
        depth = _depth_words(self.depth_bits)
        return f"{self.width}x{self.height} {self.color_format.name} with {depth}"


class _Known(NamedTuple):
    """What validation remembers of a texture object: (width, height) of every level, and how many faces or
    layers it has.
    """

    target: TextureTarget
    internal_format: InternalFormat
    sizes: tuple[tuple[int, int], ...]
    faces: tuple[int, ...]

    @classmethod
    def of(cls, image):
        sizes = tuple((level.shape[2], level.shape[1]) for level in image.levels)
        return cls(image.target, image.internal_format, sizes, tuple(len(level) for level in image.levels))


# -------------------------------------------------------------------------------------------- the walk


class _Taken:
    """What a profile was found to take: parts of states, whole states with what they were drawn beside, and
    texture objects as what validation remembers of them.
    """

    def __init__(self):
        self.parts, self.states, self.textures = _Remembered(), _Remembered(), WeakKeyDictionary()


_taken = _Remembered(16)


def _taken_by(profile):
    _, found = _taken.get(id(profile), (None, None))
    if found is None:
        found = _Taken()
        _taken.add(profile, finding=found)
    return found


class _Beside(NamedTuple):
    """What a Draw's state was checked beside."""

    names: tuple[str, ...]
    textures: tuple[_Known | None, ...]
    coordinate_sets: int
    primitive: PrimitiveType


class _Walk:
    """One pass over the commands; ``where`` is the command at hand."""

    def __init__(self, profile, width, height, depth_bits, textures, surfaces, statistics, read=()):
        self.profile, self.width, self.height, self.depth_bits = profile, width, height, depth_bits
        self.taken = _taken_by(profile)
        self.window = width, height, depth_bits
        self.in_window = True
        self.surfaces = {
            name: _Surface(f.width, f.height, f.color_format, f.depth_format) for name, f in surfaces.items()
        }
        self.textures = {}
        for name, image in textures.items():
            self.where = f"Texture {name!r}, which the machine holds"
            self.store(name, image)
        self.read, self.given = set(read), set(read)  # names; those that a histogram's sink left pixels of
        self.histograms, self.minmaxes = set(statistics.histograms), set(statistics.minmaxes)

    def refuse(self, sentence):
        raise UnsupportedState(f"{self.where}: {sentence}")

    def once(self, check, value, *beside):
        """``check(value, *beside)``, unless this machine was found to take the value beside these hashable
        ones.
        """
        key = (id(value), check.__name__, *beside)
        if key not in self.taken.parts:
            check(value, *beside)
            self.taken.parts.add(value, *key[1:])

    def takes(self, command):
        """Whether the command is known to be right here: a Clear that was checked before, or a Draw of a
        state that was, with the same textures.
        """
        kind = type(command)
        if kind is Clear:
            return id(command) in self.taken.states
        if kind is not Draw or type(command.label) is not str or not command.label.strip():
            return False
        found = self.taken.states.get(id(command.state))
        return found is not None and found[1] == self.beside(command.mesh, found[1].names)

    def beside(self, mesh, names):
        """What the finding on a state that names these textures depends on; None for a mesh not checked."""
        if mesh not in _checked_meshes:
            return None
        textures = tuple([self.textures.get(name) for name in names])
        return _Beside(names, textures, len(mesh.texture_coordinates), mesh.primitive)

    def command(self, command):
        if wrong := _type_check(type(command))(command):
            self.refuse(f"{wrong.path.lstrip('.')} {wrong.predicate}.")
        _HANDLERS[type(command)](self, command)

    # ------------------------------------------------------------------------------ whole commands

    def clear(self, command):
        if command.depth is not None and not 0 <= command.depth <= 1:
            self.refuse(
                f"the clear depth is {command.depth}; depths run from 0 (near) to 1 (far). Give one of these."
            )
        if command.stencil is not None:
            self.stencil_buffer("clears the stencil buffer")
            self.stencil_value("the clear value of the stencil buffer", command.stencil)
        self.stencil_value("stencil_write_mask", command.stencil_write_mask)
        if command.scissor is not None:
            self.scissor(command.scissor)
        if command.accumulation is not None:
            self.accumulation_buffer()
            if not all(-1 <= component <= 1 for component in command.accumulation):
                self.refuse(
                    f"the clear value of the accumulation buffer is {command.accumulation}; it holds -1 to 1."
                )
        self.color_buffer(command.draw_buffer)
        if command.accumulation is None and command.draw_buffer is ColorBuffer.BACK:
            self.taken.states.add(command)

    def accumulation_buffer(self):
        if self.profile.accumulation_bits == 0:
            self.refuse(
                f"{self.profile.name} has no accumulation buffer; add up by blending with ONE, ONE instead."
            )
        if not self.in_window:
            self.refuse("a pbuffer has no accumulation buffer; make the window current first.")

    def color_buffer(self, which):
        most = self.profile.auxiliary_buffers
        if which > most:
            self.refuse(
                f"{self.profile.name} has {_count(most, 'auxiliary buffer')} and so no {which.name}; use "
                "BACK and keep what is still needed as a texture."
            )
        if which is not ColorBuffer.BACK and not self.in_window:
            self.refuse(f"a pbuffer has no {which.name}; make the window current first.")

    def accum(self, command):
        self.accumulation_buffer()
        if command.scissor is not None:
            self.scissor(command.scissor)
        if command.operation is AccumOperation.RETURN:
            self.color_buffer(command.draw_buffer)
        elif command.operation in (AccumOperation.LOAD, AccumOperation.ACCUM):
            self.color_buffer(command.read_buffer)

    def draw(self, command):
        mesh, state = command.mesh, command.state
        if mesh not in _checked_meshes:
            if problem := _mesh_problem(mesh):
                self.refuse(problem)
            _checked_meshes.add(mesh)
        self.pass_state(state, mesh)
        self.points_and_lines(state, mesh)
        if state.polygon.stipple is not None and len(state.polygon.stipple) != 128:
            self.refuse(
                f"polygon.stipple has {len(state.polygon.stipple)} bytes; give 32 rows of 4, 128 in all."
            )
        if state.draw_buffer is ColorBuffer.BACK:
            names = tuple(u.texture for u in state.texture_units if u is not None and u.texture is not None)
            self.taken.states.add(state, finding=self.beside(mesh, names))

    def pass_state(self, state, mesh):
        """What a Draw and a rectangle of pixels have in common; ``mesh``: whose vertices have coordinates."""
        self.once(self.vertex, state.vertex)
        self.texture_units(state, mesh)
        self.normals(state)
        combiners = state.register_combiners
        if combiners is not None:
            self.once(self.register_combiners, combiners)
        if state.color_sum and not self.profile.color_sum:
            self.refuse(f"{self.profile.name} has no color sum; add the secondary color in a second pass.")
        if not state.perspective_correction and not self.profile.perspective_hint:
            self.refuse(
                f"{self.profile.name} always corrects for perspective; leave perspective_correction on, or "
                "give every vertex the same w."
            )
        if state.fog is not None:
            self.fog(state.fog)
        if state.scissor is not None:
            self.scissor(state.scissor)
        if state.window_clip is not None:
            self.window_clip(state.window_clip)
        if state.stencil_test is not None:
            self.stencil_test(state.stencil_test)
        if state.blending is not None:
            self.blending(state.blending)
        if state.logic_op is not None and not self.profile.logic_op:
            self.refuse(f"{self.profile.name} has no logic operations on colors; use blending.")
        if state.depth_clamp is not None:
            self.depth_clamp(state.depth_clamp)
        if state.w_buffering and not self.profile.w_buffering:
            self.refuse(f"{self.profile.name} has no W buffering; leave w_buffering False.")
        self.color_buffer(state.draw_buffer)
        if problem := future_problem(state, self.profile):
            self.refuse(problem)

    def tex_image(self, command):
        if (command.image is None) == (command.pixels is None):
            has = "neither an image nor" if command.image is None else "an image and"
            self.refuse(f"it has {has} pixels; give a Texture as image, or a PixelImage as pixels.")
        if command.image is not None:
            self.store(command.texture, command.image)
            return
        target, internal_format = command.target, command.internal_format
        deep = internal_format in _FIXED_DEPTHS
        self.copied_format(internal_format)
        axes = 3 if target in _PARTS else 2
        formats = (DEPTH_FORMAT,) if deep else (*IMAGE_FORMATS, "COLOR_INDEX")
        if problem := pixel_image_problem(command.pixels, formats, axes):
            self.refuse(problem)
        layers, height, width = ((1,) * (3 - axes) + command.pixels.values.shape)[:3]
        if target is TextureTarget.TEXTURE_CUBE_MAP and layers != 6:
            self.refuse(f"the image has {layers} layers; a TEXTURE_CUBE_MAP takes 6 faces.")
        if axes == 3 and deep:
            self.refuse(f"{internal_format.name} makes 1D and 2D textures; give TEXTURE_2D.")
        dimensions = {TextureTarget.TEXTURE_1D: 1, TextureTarget.TEXTURE_3D: 3}.get(target, 2)
        width, height = self.transferred(command, width, height, dimensions, deep)
        layers = layers if target is TextureTarget.TEXTURE_3D else 1
        self.define(command, width, height, layers)

    def define(self, command, width, height, layers=1):
        """A texture of one level, or of all, that TexImage makes from pixels, or CopyTexImage."""
        target, internal_format = command.target, command.internal_format
        if target is TextureTarget.TEXTURE_1D and height != 1:
            self.refuse(f"a TEXTURE_1D has one row of texels; this rectangle has {height}. Give height 1.")
        if target is TextureTarget.TEXTURE_CUBE_MAP and width != height:
            self.refuse(f"the cube map's faces are {width}x{height}; they must be square.")
        self.texture_storage(target, internal_format, width, height, layers)
        if command.generate_mipmap and internal_format in DEPTH_TEXELS:
            self.refuse(
                f"mipmaps of a {target.name} of {internal_format.name} are not generated; set "
                "generate_mipmap to False."
            )
        sizes = ((width, height),)
        if command.generate_mipmap:
            sizes = self.mipmap_sizes(width, height, layers)
        faces = tuple(max(1, layers >> k) for k in range(len(sizes)))
        if target is TextureTarget.TEXTURE_CUBE_MAP:
            faces = (6,) * len(sizes)
        if not has_sink(command.transfer):
            self.textures[command.texture] = _Known(target, internal_format, sizes, faces)

    def transferred(self, command, width, height, dimensions=2, deep=False):
        """Width and height that pixels have once they went through the command's pixel transfer."""
        transfer = command.transfer
        if problem := transfer_problem(transfer, self.profile, width, height, dimensions):
            self.refuse(problem)
        for table, known in ((transfer.histogram, self.histograms), (transfer.minmax, self.minmaxes)):
            if table is not None:
                known.add(table.name)
        return (width, height) if deep else transferred_size(width, height, transfer, dimensions)

    def saturate(self, command):
        self.color_buffer(command.draw_buffer)
        if command.scissor is not None:
            self.scissor(command.scissor)

    def reset_histogram(self, command):
        self.known_table("histogram", command.name, self.histograms)

    def reset_minmax(self, command):
        self.known_table("minmax", command.name, self.minmaxes)

    def known_table(self, what, name, known):
        if name not in known:
            made = ", ".join(map(repr, sorted(known))) or "none"
            self.refuse(
                f"there is no {what} {name!r} yet (counted so far: {made}); name it in a pixel transfer "
                "before."
            )

    def store(self, name, image):
        if wrong := _type_check(Texture)(image):
            self.refuse(f"it {wrong.predicate}.")
        if known := self.taken.textures.get(image):
            self.textures[name] = known
            return
        if image not in _checked_textures:
            if problem := _texture_problem(image):
                self.refuse(problem)
            _checked_textures.add(image)
        self.texture_storage(image.target, image.internal_format, image.width, image.height, image.depth)
        self.textures[name] = self.taken.textures[image] = _Known.of(image)

    def draw_pixels(self, command):
        if problem := pixel_image_problem(command.image):
            self.refuse(problem)
        height, width = command.image.values.shape[:2]
        self.pixels(command, width, height)

    def copy_pixels(self, command):
        width, height = self.framebuffer_rectangle(command)
        self.color_buffer(command.read_buffer)
        self.pixels(command, width, height)

    def pixels(self, command, width, height):
        """What DrawPixels and CopyPixels have in common."""
        kind = kind_of(command)
        if kind is PixelCopyType.STENCIL:
            self.stencil_buffer("writes the stencil buffer")
        self.transferred(command, width, height, deep=kind is not PixelCopyType.COLOR)
        units = command.state.texture_units
        if command.pixel_texture is None:
            self.rectangle_of_pixels(command, command.position)
            return
        # Coordinates come from the groups, and so from no vertex.
        sets = max((unit.coordinates + 1 for unit in units if unit is not None), default=0)
        made = ((0.0, 0.0, 0.0, 1.0),) * min(max(sets, 0), 8)
        self.rectangle_of_pixels(command, replace(command.position, texture_coordinates=made))
        known = [(i, self.textures[u.texture]) for i, u in enumerate(units) if u is not None]
        textures = [(i, texture.target, texture.faces[0]) for i, texture in known]
        if problem := pixel_texture_problem(
            command.pixel_texture, kind, command.state, textures, self.profile
        ):
            self.refuse(problem)

    def bitmap(self, command):
        if problem := bits_problem(command.bits):
            self.refuse(problem)
        self.rectangle_of_pixels(command, command.position)

    def rectangle_of_pixels(self, command, position):
        if problem := rectangle_problem(command, self.profile):
            self.refuse(problem)
        self.pass_state(command.state, vertex_of(position))

    def copy_tex_image(self, command):
        width, height = self.framebuffer_rectangle(command)
        self.color_buffer(command.read_buffer)
        self.copied_format(command.internal_format)
        self.fixed_depths(command.internal_format in DEPTH_TEXELS, "copies depths")
        if command.target in (TextureTarget.TEXTURE_CUBE_MAP, TextureTarget.TEXTURE_3D):
            what, parts = _PARTS[command.target]
            self.refuse(
                f"CopyTexImage defines 1D and 2D textures; define a {what} with TexImage and fill its "
                f"{parts} with CopyTexSubImage."
            )
        dimensions = 1 if command.target is TextureTarget.TEXTURE_1D else 2
        deep = command.internal_format in DEPTH_TEXELS
        self.define(command, *self.transferred(command, width, height, dimensions, deep))

    def copied_format(self, internal_format):
        if internal_format not in {*COMPONENT_BITS, *TWELVE_BIT_FORMATS, *_FIXED_DEPTHS}:
            self.refuse(
                f"{internal_format.name} is not made from pixels; define it with TexImage and a Texture, or "
                f"give one of {_names({*COMPONENT_BITS, *TWELVE_BIT_FORMATS, *_FIXED_DEPTHS})}."
            )

    def fixed_depths(self, read, what):
        """Refuse what computes with depths that are floats."""
        if read and self.depth_bits < 0:
            self.refuse(
                f"it {what} of {_depth_words(self.depth_bits)}; only fixed-point depths go through pixel "
                "transfer. Give the depth buffer a fixed format."
            )

    def mipmap_sizes(self, width, height, layers=1):
        """Sizes of every level that generation makes from level 0."""
        if width & (width - 1) or height & (height - 1) or layers & (layers - 1):
            size = f"{width}x{height}" + (f"x{layers}" if layers > 1 else "")
            self.refuse(f"mipmaps cannot be generated of {size} texels; give edges that are powers of two.")
        levels = max(width, height, layers).bit_length()
        return tuple((max(1, width >> k), max(1, height >> k)) for k in range(levels))

    def copy_tex_sub_image(self, command):
        known = self.known_texture(command.texture)
        self.copied_format(known.internal_format)
        if command.generate_mipmap:
            if known.target is TextureTarget.TEXTURE_3D:
                self.refuse("mipmaps of a 3D texture are not generated; give its levels with TexImage.")
            if command.level != 0:
                self.refuse(
                    f"mipmaps are generated from level 0, not from level {command.level}; copy into level "
                    "0, or set generate_mipmap to False."
                )
            sizes = self.mipmap_sizes(*known.sizes[0])
            faces = known.faces[:1] * len(sizes)
            self.textures[command.texture] = _Known(known.target, known.internal_format, sizes, faces)
        if not 0 <= command.level < len(known.sizes):
            self.refuse(
                f"level {command.level} of {command.texture!r} does not exist; it has {len(known.sizes)}. "
                f"Give a level from 0 to {len(known.sizes) - 1}."
            )
        faces = known.faces[command.level]
        if not 0 <= command.face < faces:
            self.refuse(
                f"face {command.face} of {command.texture!r} does not exist; a {known.target.name} has "
                f"{f'faces 0 to {faces - 1}' if faces > 1 else 'face 0 only'}."
            )
        width, height = self.framebuffer_rectangle(command)
        self.color_buffer(command.read_buffer)
        deep = known.internal_format in DEPTH_TEXELS
        self.fixed_depths(deep, "copies depths")
        dimensions = 1 if known.target is TextureTarget.TEXTURE_1D else 2
        width, height = self.transferred(command, width, height, dimensions, deep)
        self.rectangle(
            f"level {command.level} of {command.texture!r}",
            (command.x_offset, command.y_offset, width, height),
            *known.sizes[command.level],
        )

    def read_pixels(self, command):
        if command.format not in _READ_FORMATS:
            self.refuse(
                f"ReadPixels knows no format {command.format!r}; give one of {', '.join(_READ_FORMATS)}."
            )
        if command.format == "STENCIL_INDEX":
            self.stencil_buffer("reads the stencil buffer")
        if command.name in self.read:
            self.refuse(
                f"an earlier ReadPixels already has the name {command.name!r}; give this one another."
            )
        self.read.add(command.name)
        if not has_sink(command.transfer):
            self.given.add(command.name)
        size = self.framebuffer_rectangle(command)
        self.color_buffer(command.read_buffer)
        colors = command.format in READ_FORMATS
        if command.type not in READ_TYPES:
            self.refuse(f"ReadPixels knows no type {command.type!r}; give one of {', '.join(READ_TYPES)}.")
        if not colors and command.type != "UNSIGNED_BYTE":
            self.refuse(
                f"{command.format} is read in the buffer's own units whatever the type; leave type alone."
            )
        self.transferred(command, *size, deep=not colors)
        scale = command.transfer.depth_scale, command.transfer.depth_bias
        self.fixed_depths(command.format == DEPTH_FORMAT and scale != (1.0, 0.0), "scales depths")

    def host_step(self, command):
        if not self.in_window:
            self.refuse("a pbuffer is current; make the window current first, which the host draws to.")
        if missing := [name for name in command.reads if name not in self.given]:
            names = ", ".join(map(repr, sorted(self.given))) or "none"
            self.refuse(
                f"nothing has read {missing[0]!r} before (read so far: {names}); put a ReadPixels of this "
                "name before it."
            )

    def make_current(self, command):
        name = command.surface
        if name is None:
            if command.width is not None or command.height is not None:
                self.refuse("the window has its size; give width and height to pbuffers only.")
            self.width, self.height, self.depth_bits = self.window
            self.in_window = True
            return
        if not self.profile.surface_formats:
            self.refuse(f"{self.profile.name} has no pbuffers; draw to the window and use CopyTexImage.")
        if command.color_format not in self.profile.surface_formats:
            self.refuse(
                f"{self.profile.name} has no surface format {command.color_format.name}; it has "
                f"{_names(self.profile.surface_formats)}."
            )
        if command.width is None or command.height is None:
            self.refuse(f"pbuffer {name!r} has no width or no height; give both.")
        asked = _Surface(command.width, command.height, command.color_format, command.depth_bits)
        made = self.surfaces.setdefault(name, asked)
        if made != asked:
            self.refuse(
                f"pbuffer {name!r} is {made} since it was made, and this asks for {asked}; give the same, "
                "or another name."
            )
        _check_framebuffer(
            self.profile, command.width, command.height, command.depth_bits, self.where + ": the pbuffer"
        )
        self.width, self.height, self.depth_bits = command.width, command.height, command.depth_bits
        self.in_window = False

    def bind_tex_image(self, command):
        if command.surface not in self.surfaces:
            made = ", ".join(repr(n) for n in self.surfaces) or "none"
            self.refuse(
                f"there is no pbuffer {command.surface!r} yet (made so far: {made}); put a MakeCurrent "
                "before."
            )
        surface = self.surfaces[command.surface]
        formats = (*READABLE_AS[surface.color_format], DEPTH_READABLE_AS[surface.depth_bits])
        if command.internal_format not in formats:
            self.refuse(
                f"{command.internal_format.name} does not read the words of {surface.color_format.name} with "
                f"{_depth_words(surface.depth_bits)}; give {_names(formats)}."
            )
        if command.target not in (TextureTarget.TEXTURE_2D, TextureTarget.TEXTURE_RECTANGLE):
            self.refuse(f"a pbuffer becomes a 2D texture, not a {command.target.name}; give TEXTURE_2D.")
        self.texture_storage(command.target, command.internal_format, surface.width, surface.height)
        size = (surface.width, surface.height)
        self.textures[command.texture] = _Known(command.target, command.internal_format, (size,), (1,))

    # ---------------------------------------------------------------------- rectangles and textures

    def rectangle(self, what, rectangle, width, height):
        x, y, w, h = rectangle
        if w < 0 or h < 0:
            self.refuse(f"the rectangle is {w}x{h}; give sizes that are not negative.")
        if x < 0 or y < 0 or x + w > width or y + h > height:
            self.refuse(
                f"the rectangle {w}x{h} at ({x}, {y}) reaches outside {what}, which is {width}x{height}; "
                "move it inside."
            )

    def framebuffer_rectangle(self, command):
        width = self.width - command.x if command.width is None else command.width
        height = self.height - command.y if command.height is None else command.height
        self.rectangle("the framebuffer", (command.x, command.y, width, height), self.width, self.height)
        return width, height

    def texture_storage(self, target, internal_format, width, height, layers=1):
        profile = self.profile
        if target not in profile.texture_targets:
            self.refuse(f"{profile.name} has no {target.name}; it has {_names(profile.texture_targets)}.")
        if internal_format not in profile.internal_formats:
            self.refuse(
                f"{profile.name} does not store {internal_format.name}; it stores "
                f"{_names(profile.internal_formats)}."
            )
        if width < 1 or height < 1:
            self.refuse(f"the texture is {width}x{height} texels; a texture needs at least 1x1.")
        what, limit = {
            TextureTarget.TEXTURE_CUBE_MAP: ("cube map faces", profile.max_cube_map_texture_size),
            TextureTarget.TEXTURE_3D: ("3D textures", profile.max_3d_texture_size),
        }.get(target, ("textures", profile.max_texture_size))
        if max(width, height, layers) > limit:
            self.refuse(
                f"the texture is {width}x{height}; {profile.name} holds {what} up to {limit}x{limit}. Scale "
                "it down or split it."
                if layers == 1
                else f"the texture is {width}x{height}x{layers}; {profile.name} holds {what} up to {limit} "
                "texels an edge. Scale it down or split it."
            )
        two = profile.power_of_two_textures and target is not TextureTarget.TEXTURE_RECTANGLE
        if two and layers & (layers - 1):
            self.refuse(
                f"the texture has {layers} layers; {profile.name} takes edges that are powers of two. Give "
                f"{_power_of_two(layers)}."
            )
        if two and (width & (width - 1) or height & (height - 1)):
            self.refuse(
                f"the texture is {width}x{height}; {profile.name} takes edges that are powers of two. Scale "
                f"it to {_power_of_two(width)}x{_power_of_two(height)}, or pad it."
            )

    def known_texture(self, name):
        if name not in self.textures:
            defined = ", ".join(repr(n) for n in self.textures) or "none"
            self.refuse(
                f"there is no texture {name!r} yet (defined so far: {defined}); put a TexImage or "
                "CopyTexImage before."
            )
        return self.textures[name]

    def texture_units(self, state, mesh):
        units, allowed = state.texture_units, self.profile.max_texture_units
        if len(units) > allowed:
            self.refuse(
                f"{self.profile.name} has {_count(allowed, 'texture unit')}; this pass has {len(units)}. "
                "Split the pass or choose a profile with more."
            )
        stages = self.texture_shader(state)
        enabled = [(i, unit) for i, unit in enumerate(units) if unit is not None]
        if not enabled:
            return
        if stages is not None:
            self.stage_widths(units, stages)
        for i, unit in enabled:
            operation = None if stages is None else stages[i].operation
            if operation in WITHOUT_TEXTURE or operation is TextureShaderOperation.NONE:
                if unit.texture is not None:
                    self.known_texture(unit.texture)
                if state.register_combiners is None:
                    rgba = operation is TextureShaderOperation.PASS_THROUGH
                    self.once(self.environment, unit, i, BaseFormat.RGBA if rgba else None)
                self.unit_coordinates(i, unit, 0 if operation is TextureShaderOperation.NONE else 3, mesh)
                continue
            if unit.texture is None:
                self.refuse(f"texture unit {i} names no texture to sample; give one, or disable the unit.")
            known = self.known_texture(unit.texture)
            needed = {TextureTarget.TEXTURE_1D: 1, TextureTarget.TEXTURE_2D: 2}.get(known.target, 3)
            foreign = (
                operation is TextureShaderOperation.TEXTURE_CUBE_MAP
                and known.target is not TextureTarget.TEXTURE_CUBE_MAP
            )
            if operation in DEPENDENT or foreign:
                needed = DEPENDENT.get(operation, 3)
                self.dependent_access(i, unit, known, operation)
            elif operation in TARGETS_READ and known.target not in self.accessible(operation):
                self.refuse(
                    f"texture shader stage {i} is {operation.name}, but {unit.texture!r} is a "
                    f"{known.target.name}, which {self.profile.name} does not read so; give the operation of "
                    "its target."
                )
            self.unit_coordinates(i, unit, needed, mesh)
            self.once(self.sampler, unit, known, i)
            self.texture_color_table(i, unit.color_table)
            if state.register_combiners is None:
                base = texture_format(unit, known.internal_format, self.profile)
                self.once(self.environment, unit, i, base)

    def texture_color_table(self, number, table):
        if table is not None and not self.profile.texture_color_table:
            self.refuse(
                f"texture unit {number} has a color_table; {self.profile.name} has none after its filters. "
                "Use the table's colours in the texture, or choose a profile that has it."
            )
        if problem := color_table_problem(f"the color table of texture unit {number}", table, self.profile):
            self.refuse(problem)

    def environment(self, unit, number, base):
        if problem := environment_problem(number, unit.environment, base, self.profile):
            self.refuse(problem)

    def texture_shader(self, state):
        """The stages of every unit, checked, or None."""
        if state.texture_shader is None:
            return None
        profile, units = self.profile, len(state.texture_units)
        if not profile.texture_shader_operations:
            self.refuse(f"{profile.name} has no texture shaders; leave texture_shader None.")
        if len(state.texture_shader) > units:
            self.refuse(
                f"there are {len(state.texture_shader)} texture shader stages, but "
                f"{_count(units, 'texture unit')}; give each stage a unit."
            )
        stages = shader_stages(state)
        for i, stage in enumerate(stages):
            if stage.operation is TextureShaderOperation.NONE:
                continue
            if stage.operation not in profile.texture_shader_operations:
                self.refuse(
                    f"{profile.name} has no {stage.operation.name} (texture shader stage {i}); it has "
                    f"{_names(profile.texture_shader_operations)}."
                )
            dotted = stage.operation.name.startswith("DOT_PRODUCT")
            if dotted and stage.dot_product_mapping not in profile.dot_product_mappings:
                self.refuse(
                    f"{profile.name} has no dot product mapping {stage.dot_product_mapping.name} (texture "
                    f"shader stage {i}); it has {_names(profile.dot_product_mappings)}."
                )
            if state.texture_units[i] is None:
                self.refuse(
                    f"texture shader stage {i} is {stage.operation.name}, but texture unit {i} is disabled; "
                    "enable it (with no texture where the operation reads none)."
                )
            if problem := stage_problem(i, stages):
                self.refuse(problem)
        return stages

    def stage_widths(self, units, stages):
        """Refuse stages that read words of 16 bits where there are none."""
        widths = []
        for unit, stage in zip(units, stages, strict=True):
            known = None if unit is None or unit.texture is None else self.known_texture(unit.texture)
            if known is None or stage.operation in WITHOUT_TEXTURE:
                widths.append(self.profile.texture_bits)
            else:
                widths.append((stored_widths(known.internal_format, self.profile) or (8,))[0])
        if problem := stage_width_problem(stages, widths, self.profile):
            self.refuse(problem)

    def accessible(self, operation):
        """The targets of textures that an operation reads here."""
        targets = TARGETS_READ[operation]
        return targets if self.profile.foreign_texture_targets else targets[:1]

    def dependent_access(self, number, unit, known, operation):
        filters = unit.sampler.min_filter, unit.sampler.mag_filter
        if filters[0] is not filters[1]:
            self.refuse(
                f"texture unit {number} minifies with {filters[0].name}, magnifies with {filters[1].name}; "
                f"{operation.name} makes coordinates that have no level of detail here; set both to "
                "NEAREST or both to LINEAR."
            )
        if max(unit.sampler.max_probes, unit.sampler.max_anisotropy) > 1:
            filters, limit = "filters anisotropically", "max_anisotropy"
            if unit.sampler.max_probes > 1:
                filters, limit = "assembles footprints", "max_probes"
            self.refuse(
                f"texture unit {number} {filters}, which {self.profile.name} does along its own "
                f"coordinates, not along those that {operation.name} makes; set {limit} to 1."
            )
        if operation in SCALING and unit.sampler.signed_components != SignedComponents():
            self.refuse(
                f"texture shader stage {number} is {operation.name}, which scales unsigned components alone; "
                "leave signed_components unset."
            )
        targets = self.accessible(operation)
        if known.target not in targets:
            self.refuse(
                f"texture shader stage {number} is {operation.name}, but {unit.texture!r} is a "
                f"{known.target.name}, which {self.profile.name} does not read so; give it a "
                f"{' or '.join(t.name for t in targets)}."
            )

    def unit_coordinates(self, number, unit, needed, mesh):
        self.generation(number, unit)
        sets = len(mesh.texture_coordinates)
        if unit.coordinates < 0:
            self.refuse(f"texture unit {number} takes coordinate set {unit.coordinates}; sets count from 0.")
        if unit.coordinates >= sets and any(gen.mode is TexGenMode.NONE for gen in unit.gen[:needed]):
            self.refuse(
                f"texture unit {number} takes coordinate set {unit.coordinates}, but the mesh has "
                f"{_count(sets, 'set')}; give the mesh coordinates or generate {', '.join('str'[:needed])}."
            )

    def generation(self, number, unit):
        profile, place = self.profile, f"texture unit {number}"
        if any(unit.cylinder_wrap) and not profile.cylinder_wrap:
            self.refuse(
                f"{profile.name} does not wrap texture coordinates; give the triangles that cross the seam "
                "vertices of their own."
            )
        for coordinate, gen in zip("strq", unit.gen, strict=True):
            if gen.mode is TexGenMode.NONE:
                continue
            if gen.mode not in profile.texgen_modes:
                self.refuse(
                    f"{profile.name} cannot generate {coordinate} by {gen.mode.name}; it has "
                    f"{_names(profile.texgen_modes)}."
                )
            if coordinate not in _GENERATED_BY.get(gen.mode, "strq"):
                self.refuse(
                    f"{place} generates {coordinate} by {gen.mode.name}, which makes "
                    f"{', '.join(_GENERATED_BY[gen.mode])} only; use OBJECT_LINEAR or EYE_LINEAR for it, or "
                    "NONE."
                )

    def rectangle_sampler(self, place, sampler, mipmapped):
        if mipmapped:
            self.refuse(
                f"{place} minifies a TEXTURE_RECTANGLE with {sampler.min_filter.name}; rectangles have no "
                "mipmaps. Give NEAREST or LINEAR."
            )
        for name in ("wrap_s", "wrap_t"):
            mode = getattr(sampler, name)
            if mode in (WrapMode.REPEAT, WrapMode.MIRRORED_REPEAT):
                self.refuse(
                    f"{place} asks for {name} {mode.name} of a TEXTURE_RECTANGLE, whose coordinates count "
                    "texels; give CLAMP, CLAMP_TO_EDGE or CLAMP_TO_BORDER."
                )

    def sampler(self, unit, known, number):
        profile, sampler, place = self.profile, unit.sampler, f"texture unit {number}"
        if sampler.mag_filter not in (TextureFilter.NEAREST, TextureFilter.LINEAR):
            self.refuse(
                f"{place} magnifies with {sampler.mag_filter.name}; a magnification filter is NEAREST or "
                "LINEAR."
            )
        for name in ("wrap_s", "wrap_t", "wrap_r"):
            if getattr(sampler, name) not in profile.wrap_modes:
                self.refuse(
                    f"{profile.name} has no {getattr(sampler, name).name}, which {place} asks for {name}; "
                    f"it has {_names(profile.wrap_modes)}."
                )
        if sampler.compare_mode not in profile.texture_compare_modes:
            self.refuse(
                f"{profile.name} has no {sampler.compare_mode.name}, which {place} asks for compare_mode; it "
                f"has {_names(profile.texture_compare_modes)}."
            )
        deep = known.internal_format in DEPTH_TEXELS
        compares = sampler.compare_mode is not TextureCompareMode.NONE
        if deep is not compares:
            self.refuse(
                f"{place} reads {unit.texture!r}, {known.internal_format.name}, with compare_mode "
                f"{sampler.compare_mode.name}; depth textures are read by comparing, and only they can be."
            )
        if problem := shadow_problem(place, sampler, profile):
            self.refuse(problem)
        if compares and {sampler.wrap_s, sampler.wrap_t} & {WrapMode.CLAMP, WrapMode.CLAMP_TO_BORDER}:
            self.refuse(
                f"{place} compares and may read its border colour, which is no depth; use CLAMP_TO_EDGE or "
                "REPEAT."
            )
        width, height = known.sizes[0]
        mipmapped = sampler.min_filter not in (TextureFilter.NEAREST, TextureFilter.LINEAR)
        if known.target is TextureTarget.TEXTURE_RECTANGLE:
            self.rectangle_sampler(place, sampler, mipmapped)
        layers = known.faces[0] if known.target is TextureTarget.TEXTURE_3D else 1
        complete = complete_levels(width, max(height, layers))
        if sampler.max_level < 0:
            self.refuse(f"{place} has the maximum level {sampler.max_level}; levels count from 0.")
        if mipmapped and len(known.sizes) < min(complete, sampler.max_level + 1):
            self.refuse(
                f"{place} minifies with {sampler.min_filter.name}, but {unit.texture!r} ({width}x{height}) "
                f"has {_count(len(known.sizes), 'level')} of {complete}; build it with mipmaps=True, set "
                f"max_level to {len(known.sizes) - 1}, or set min_filter to LINEAR or NEAREST."
            )
        if abs(sampler.min_lod) > _LOD_LIMIT or abs(sampler.max_lod) > _LOD_LIMIT:
            self.refuse(
                f"{place} limits the level of detail to {sampler.min_lod} .. {sampler.max_lod}; give limits "
                f"from -{_LOD_LIMIT:g} to {_LOD_LIMIT:g}."
            )
        if not 1 <= sampler.max_anisotropy <= profile.max_anisotropy:
            self.refuse(
                f"{place} has the maximum anisotropy {sampler.max_anisotropy:g}; {profile.name} takes 1 to "
                f"{profile.max_anisotropy:g}. Set max_anisotropy to one of these."
            )
        if sampler.max_anisotropy > 1 and (
            known.target not in (TextureTarget.TEXTURE_2D, TextureTarget.TEXTURE_RECTANGLE)
            or known.internal_format is InternalFormat.HILO16
        ):
            self.refuse(
                f"{place} filters {unit.texture!r} anisotropically; how is known of 2D and rectangle "
                "textures of bytes alone: set max_anisotropy to 1."
            )
        if problem := probes_problem(place, sampler, known.target, known.internal_format, profile):
            self.refuse(problem)
        if sampler.signed_components != SignedComponents() and not profile.signed_components:
            self.refuse(f"{profile.name} has no signed texels; bias them and use EXPAND_NORMAL mappings.")
        if abs(unit.lod_bias) > profile.max_lod_bias:
            least = -profile.max_lod_bias or 0.0
            self.refuse(
                f"{place} has the level-of-detail bias {unit.lod_bias}; {profile.name} takes {least} to "
                f"{profile.max_lod_bias}. Set lod_bias to one of these."
            )

    # ------------------------------------------------------------------------------------- vertices

    def vertex(self, vertex):
        if vertex.stage == VertexStage.PROGRAM_RESULTS:
            if self.profile.exact:
                self.refuse(
                    f"the vertex stage is PROGRAM_RESULTS, whose depths are a buffer's words; "
                    f"{self.profile.name} has no such buffer: choose FIXED_FUNCTION, or a machine."
                )
            plain = VertexState(
                stage=VertexStage.PROGRAM_RESULTS,
                two_side=vertex.two_side,
                secondary_color=vertex.secondary_color,
            )
            for field in fields(vertex):
                if getattr(vertex, field.name) != getattr(plain, field.name):
                    self.refuse(
                        f"vertex.{field.name} is set, but the vertex stage is PROGRAM_RESULTS: the mesh "
                        "holds window coordinates and final colors; choose FIXED_FUNCTION, or leave it unset."
                    )
        elif vertex.two_side:
            self.refuse(
                "vertex.two_side is VERTEX_PROGRAM_TWO_SIDE, but the vertex stage is FIXED_FUNCTION; set "
                "lighting.two_side, or leave it unset."
            )
        self.unit_only("vertex", vertex, VertexState(), ("secondary_color",))
        if vertex.composite is not None:
            self.composite(vertex)
        self.viewport(vertex.viewport)
        if len(vertex.clip_planes) > self.profile.max_clip_planes:
            self.refuse(
                f"{self.profile.name} has {_count(self.profile.max_clip_planes, 'clip plane')}; this pass "
                f"enables {len(vertex.clip_planes)}. Clip the mesh, or draw it in parts."
            )
        if vertex.lighting is not None:
            self.lighting(vertex.lighting)

    def unit_only(self, path, given, plain, names):
        """Refuse fields of ``given`` that only a lighting unit has, where they are not as in ``plain``."""
        if self.profile.lighting is LightingArithmetic.LIGHTING_UNIT:
            return
        for name in names:
            if getattr(given, name) != getattr(plain, name):
                self.refuse(
                    f"{path}.{name} is {_shown(getattr(given, name))}; {self.profile.name} computes lighting "
                    "by OpenGL's equations, which have no such thing. Leave it unset, or choose a profile "
                    "with a lighting unit."
                )

    def composite(self, vertex):
        if not self.profile.composite_matrix:
            self.refuse(
                f"{self.profile.name} has no Composite; give the projection matrix and the viewport instead."
            )
        plain = VertexState()
        for name in ("projection", "viewport"):
            if getattr(vertex, name) != getattr(plain, name):
                self.refuse(
                    f"vertex.{name} is set beside vertex.composite, which takes its place; leave one of them "
                    "unset."
                )

    def normals(self, state):
        if needs_normals(state):
            self.once(self.inverse, state.vertex)

    def inverse(self, vertex):
        try:
            invert_upper_left(vertex.modelview)
        except ValueError as error:
            self.refuse(f"{error}.")

    def viewport(self, viewport):
        profile = self.profile
        width = self.width if viewport.width is None else viewport.width
        height = self.height if viewport.height is None else viewport.height
        if width < 0 or height < 0:
            self.refuse(f"the viewport is {width}x{height}; give sizes that are not negative.")
        if max(width, height) > profile.max_viewport:
            self.refuse(
                f"the viewport is {width}x{height}; {profile.name} takes up to "
                f"{profile.max_viewport}x{profile.max_viewport}."
            )
        for name in ("near", "far"):
            if not 0 <= getattr(viewport, name) <= 1:
                self.refuse(
                    f"the depth range's {name} is {getattr(viewport, name)}; give a number from 0 to 1."
                )

    def lighting(self, lighting):
        profile = self.profile
        if len(lighting.lights) > profile.max_lights:
            self.refuse(
                f"{profile.name} has {_count(profile.max_lights, 'light')}; this pass enables "
                f"{len(lighting.lights)}. Add the others in a second pass with blending ONE, ONE."
            )
        if lighting.separate_specular_color and not profile.separate_specular_color:
            self.refuse(f"{profile.name} has no SEPARATE_SPECULAR_COLOR; use single color, or a second pass.")
        unit = ("front_sources", "back_sources", "back_model_ambient", "viewer_direction")
        self.unit_only("lighting", lighting, Lighting(), unit)
        for face in ("front", "back"):
            self.unit_only(
                f"lighting.{face}", getattr(lighting, face), Material(), ("specular_coefficients",)
            )
            shininess = getattr(lighting, face).shininess
            if not 0 <= shininess <= profile.max_shininess:
                self.refuse(
                    f"the {face} material's shininess is {shininess}; {profile.name} takes 0 to "
                    f"{profile.max_shininess}."
                )
        has_unit = profile.lighting is LightingArithmetic.LIGHTING_UNIT
        for i, light in enumerate(lighting.lights):
            unit = ("range", "half_vector", "spot", "back_ambient", "back_diffuse", "back_specular")
            self.unit_only(f"light {i}", light, Light(), unit)
            directional = light.position[3] == 0
            for name in ("range", "spot") if directional else ("half_vector",):
                if getattr(light, name) is not None:
                    kind = "directional" if directional else "positional"
                    self.refuse(f"light {i} is {kind}, and such a light has no {name}; leave it None.")
            if has_unit and light.spot_cutoff != 180:
                self.refuse(
                    f"light {i}'s spot cutoff is {light.spot_cutoff} degrees; {profile.name}'s lighting unit "
                    "takes a cone as the light's spot. Set that, and leave the cutoff at 180."
                )
            if not 0 <= light.spot_exponent <= profile.max_shininess:
                self.refuse(
                    f"light {i}'s spot exponent is {light.spot_exponent}; {profile.name} takes 0 to "
                    f"{profile.max_shininess}."
                )
            if not (0 <= light.spot_cutoff <= 90 or light.spot_cutoff == 180):
                self.refuse(
                    f"light {i}'s spot cutoff is {light.spot_cutoff} degrees; give 0 to 90, or 180 for no "
                    "spot."
                )
            attenuation = (light.constant_attenuation, light.linear_attenuation, light.quadratic_attenuation)
            if min(attenuation) < 0:
                self.refuse(f"light {i}'s attenuation is {attenuation}; attenuations are not negative.")
            if light.position[3] != 0 and max(attenuation) == 0 and not has_unit:
                self.refuse(
                    f"light {i}'s attenuations are all zero, which divides by zero; give a constant "
                    "attenuation."
                )

    # ----------------------------------------------------------------------------------- fragments

    def register_combiners(self, combiners):
        profile, stages = self.profile, len(combiners.general)
        if profile.max_general_combiners == 0:
            self.refuse(f"{profile.name} has no register combiners; choose a profile that has them.")
        if stages == 0:
            self.refuse(
                "register combiners need at least one general combiner; this pass has none. Add "
                "GeneralCombiner()."
            )
        if stages > profile.max_general_combiners:
            self.refuse(
                f"{profile.name} has {_count(profile.max_general_combiners, 'general combiner')}; this pass "
                f"uses {stages}. Split the pass or choose a profile with more."
            )
        for number, stage in enumerate(combiners.general):
            own = stage.constant_color0 is not None or stage.constant_color1 is not None
            if own and not profile.per_stage_constants:
                self.refuse(
                    f"general combiner {number} has its own constant colors; {profile.name} has two for all "
                    "stages together. Set constant_color0 and constant_color1 of the RegisterCombiners, or "
                    "choose a profile with per-stage constants."
                )
        if not profile.combiner_flags and (flag := nv2a_flag(combiners)):
            self.refuse(
                f"{profile.name} has no {flag}; leave it at its default, or choose a profile with "
                "combiner_flags."
            )
        for _, sentence in combiner_problems(combiners):
            self.refuse(sentence)
        for place, register in registers_named(combiners):
            if (
                register in TEXTURE_REGISTERS
                and TEXTURE_REGISTERS.index(register) >= profile.max_texture_units
            ):
                self.refuse(
                    f"{place} names {register.name}; {profile.name} has "
                    f"{_count(profile.max_texture_units, 'texture unit')}, so that register does not exist. "
                    "Use a spare register, or choose a profile with more."
                )

    def fog(self, fog):
        if fog.density < 0:
            self.refuse(f"the fog density is {fog.density}; densities are not negative.")
        if fog.mode is FogMode.LINEAR and fog.start == fog.end:
            self.refuse(
                f"linear fog starts and ends at {fog.start}, which divides by zero; move one of them."
            )
        if fog.registers is not None and not self.profile.fog_registers:
            self.refuse(
                f"{self.profile.name} has no FogRegisters; give density, or start and end, and leave "
                "fog.registers unset."
            )
        if fog.coordinate_source is FogCoordinateSource.FOG_COORDINATE and not self.profile.fog_coordinate:
            self.refuse(f"{self.profile.name} has no FOG_COORDINATE; use FRAGMENT_DEPTH.")

    def scissor(self, scissor):
        if scissor.width < 0 or scissor.height < 0:
            self.refuse(
                f"the scissor box is {scissor.width}x{scissor.height}; give sizes that are not negative."
            )

    def points_and_lines(self, state, mesh):
        profile, point, polygon = self.profile, state.point, state.polygon
        filled = PolygonMode.FILL == polygon.front_mode == polygon.back_mode and polygon.stipple is None
        if profile.exact and not (filled and mesh.primitive < PrimitiveType.POINTS):
            self.refuse(
                f"the {profile.name} evaluates filled polygons without stipple only; draw triangles in "
                "polygon mode FILL, or choose a machine."
            )
        others = not profile.exact and profile.subpixel_bits != NATIVE_SUBPIXEL_BITS
        if others and not (filled and mesh.primitive < PrimitiveType.POINTS and state.window_clip is None):
            self.refuse(
                f"{profile.name} has {profile.subpixel_bits} subpixel bits, with which filled polygons are "
                f"drawn alone, without stipple and window clip; draw these, or keep 4 bits."
            )
        for what, size, most in (
            ("the point size", point.size, profile.max_point_size),
            ("the line width", state.line.width, profile.max_line_width),
        ):
            if not 0 <= size <= most:
                self.refuse(
                    f"{what} is {size}; {profile.name} draws sizes from 0 to {most} pixels. Give one."
                )
        if problem := line_problem(state.line, profile):
            self.refuse(problem)
        if point.parameters is not None and not profile.point_parameters:
            self.refuse(f"{profile.name} has no point parameters; give the points one size.")
        if point.parameters is not None and min(point.parameters.attenuation) < 0:
            self.refuse("point.parameters.attenuation has a negative term; give terms that are not negative.")
        programmed = state.vertex.stage == VertexStage.PROGRAM_RESULTS
        if (point.parameters is not None) if programmed else point.program_size:
            given, other = ("parameters", "program_size") if programmed else ("program_size", "parameters")
            self.refuse(
                f"point.{given} takes no part where the vertex stage is {state.vertex.stage.name}; use "
                f"point.{other}."
            )
        replaced = [i for i, u in enumerate(state.texture_units) if u is not None and u.coord_replace]
        if wrong := [i for i in replaced if i not in profile.point_sprite_units]:
            allowed = ", ".join(map(str, sorted(profile.point_sprite_units))) or "none"
            self.refuse(
                f"texture unit {wrong[0]} has coord_replace; point sprites of {profile.name} replace the "
                f"coordinates of units: {allowed}. Use another unit, or texture coordinates of the mesh."
            )
        if point.sprite and not profile.point_sprite_units:
            self.refuse(f"{profile.name} has no point sprites; draw quads.")

    def window_clip(self, clip):
        most = self.profile.max_window_rectangles
        if not 0 < len(clip.rectangles) <= most:
            self.refuse(
                f"the window clip has {_count(len(clip.rectangles), 'rectangle')}; {self.profile.name} takes "
                + (f"1 to {most}." if most else "none: use the scissor box or the stencil buffer.")
            )
        for rectangle in clip.rectangles:
            self.scissor(rectangle)

    def depth_clamp(self, limits):
        if not self.profile.depth_clamp:
            self.refuse(f"{self.profile.name} has no DEPTH_CLAMP; leave depth_clamp None.")
        if limits.maximum is not None and limits.maximum < limits.minimum:
            self.refuse(
                f"the depth limits run from {limits.minimum} to {limits.maximum}; give a maximum that is not "
                "below the minimum."
            )

    def stencil_buffer(self, what):
        if self.profile.stencil_bits == 0:
            self.refuse(f"it {what}, and {self.profile.name} has none; choose a profile that has one.")

    def stencil_value(self, what, value):
        if not 0 <= value <= 0xFF:
            self.refuse(f"{what} is {value}; a stencil value has 8 bits: give 0 to 255.")

    def stencil_test(self, test):
        self.stencil_buffer("tests the stencil buffer")
        self.stencil_value("the stencil mask", test.mask)
        self.stencil_value("the stencil write_mask", test.write_mask)
        for name in ("fail", "depth_fail", "depth_pass"):
            operation = getattr(test, name)
            if operation not in self.profile.stencil_operations:
                self.refuse(
                    f"{self.profile.name} has no stencil operation {operation.name} ({name}); it has "
                    f"{_names(self.profile.stencil_operations)}."
                )

    def blending(self, blending):
        profile = self.profile
        for side, factors in (
            ("source", profile.blend_factors_source),
            ("destination", profile.blend_factors_destination),
        ):
            factor = getattr(blending, side)
            if factor not in factors:
                self.refuse(
                    f"{profile.name} does not take {factor.name} as its {side} blend factor; it takes "
                    f"{_names(factors)}."
                )
        if blending.equation not in profile.blend_equations:
            self.refuse(
                f"{profile.name} has no blend equation {blending.equation.name}; it has "
                f"{_names(profile.blend_equations)}."
            )


# Source: OpenGL 1.2.1 section 2.10.4 (SPHERE_MAP for s and t); NV_texgen_reflection (the other two, not q).
_GENERATED_BY = {
    TexGenMode.SPHERE_MAP: "st",
    TexGenMode.NORMAL_MAP: "str",
    TexGenMode.REFLECTION_MAP: "str",
}

_HANDLERS = {
    Clear: _Walk.clear,
    Draw: _Walk.draw,
    TexImage: _Walk.tex_image,
    CopyTexImage: _Walk.copy_tex_image,
    CopyTexSubImage: _Walk.copy_tex_sub_image,
    ReadPixels: _Walk.read_pixels,
    HostStep: _Walk.host_step,
    Saturate: _Walk.saturate,
    Accum: _Walk.accum,
    DrawPixels: _Walk.draw_pixels,
    CopyPixels: _Walk.copy_pixels,
    Bitmap: _Walk.bitmap,
    MakeCurrent: _Walk.make_current,
    BindTexImage: _Walk.bind_tex_image,
    ResetHistogram: _Walk.reset_histogram,
    ResetMinmax: _Walk.reset_minmax,
}


def _names(members):
    return ", ".join(m.name for m in sorted(members)) or "none"


def _count(number, noun):
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def _power_of_two(edge):
    """The power of two nearest to edge."""
    above = 1 << (edge - 1).bit_length()
    return above if above - edge <= edge - above // 2 else above // 2


def _check_framebuffer(profile, width, height, depth_bits, what="The framebuffer"):
    for name, number in (("width", width), ("height", height), ("depth_bits", depth_bits)):
        if wrong := _check_int(number):
            raise UnsupportedState(f"{what}'s {name} {wrong.predicate}.")
    if width < 1 or height < 1:
        raise UnsupportedState(f"{what} is {width}x{height}; give at least 1x1.")
    # Source: OpenGL 1.2.1 section 2.10.1: the largest viewport covers whatever can be displayed.
    if max(width, height) > profile.max_viewport:
        raise UnsupportedState(
            f"{what} is {width}x{height}; {profile.name} draws up to "
            f"{profile.max_viewport}x{profile.max_viewport}. Draw it in tiles."
        )
    if depth_bits not in profile.depth_bits:
        formats = " or ".join(str(b) if b > 0 else DepthFormat(b).name for b in profile.depth_bits)
        raise UnsupportedState(
            f"{what} has {_depth_words(depth_bits)}; {profile.name} has {formats}. Give one of these."
        )


def _depth_words(depth_bits):
    if depth_bits in (DepthFormat.FLOAT_16, DepthFormat.FLOAT_24):
        return f"{DepthFormat(depth_bits).name} depths"
    return f"{int(depth_bits)} bits of depth"


def _check_samples(profile, samples):
    if wrong := _check_int(samples):
        raise UnsupportedState(f"The framebuffer's samples {wrong.predicate}.")
    if samples not in profile.samples:
        allowed = " or ".join(map(str, profile.samples))
        raise UnsupportedState(
            f"The framebuffer has {_count(samples, 'sample')} in each pixel; {profile.name} has {allowed}. "
            "Give one of these, or draw the scene several times, shifted, and accumulate."
        )


def frame_of(commands):
    """The commands as a tuple. Raises UnsupportedState for what is none of them, one alone for instance."""
    if type(commands) in _HANDLERS:
        raise UnsupportedState(
            f"A frame is a tuple of commands; this is one {type(commands).__name__}. Write (command,)."
        )
    try:
        return tuple(commands)
    except TypeError:
        raise UnsupportedState(
            f"A frame is a tuple of commands; this is {_shown(commands)}. Give a tuple."
        ) from None


def _unwritable(array):
    """The same memory, not to be written to: what was read stays what the framebuffer held."""
    view = array.view()
    view.setflags(write=False)
    return view


def issued_by(step, pixels):
    """The commands that a HostStep issues for the pixels read so far, as a tuple.

    Raises UnsupportedState where its function returns no tuple of commands, and what that function raises.
    """
    try:
        issued = step.commands({name: _unwritable(pixels[name]) for name in step.reads})
    except Exception as error:
        error.add_note(f'in the function of HostStep "{step.label}"')
        raise
    try:
        return frame_of(issued)
    except UnsupportedState as error:
        raise UnsupportedState(f'HostStep "{step.label}": {error}') from None


def validate(
    commands,
    profile,
    width,
    height,
    depth_bits=None,
    textures=None,
    surfaces=None,
    statistics=None,
    *,
    samples=1,
    color_bits=None,
    read=(),
    host_step=None,
):
    """Refuse what the machine could not execute; return None if it can execute everything.

    commands       iterable of commands, in order
    profile        the machine
    width, height  of the framebuffer, pixels
    depth_bits     of the depth buffer; None: the widest fixed format that the machine has
    textures       {name: Texture} that the machine holds already, or None
    surfaces       {name: Framebuffer}, its pbuffers, or None
    statistics     its PixelStatistics, or None
    samples        of each of the framebuffer's pixels
    color_bits     of its colours' components; None: the usual width
    read           names that ReadPixels of the same frame gave already
    host_step      label of the HostStep that issued the first of these commands, or None

    Raises UnsupportedState (a ValueError) whose message names the command, what was given, what the machine
    allows, and what to do. Meshes and textures are looked at once in their life; so are states, as long as
    they are remembered (``_Remembered``).
    """
    depth_bits = profile.widest_depth if depth_bits is None else depth_bits
    _check_framebuffer(profile, width, height, depth_bits)
    _check_samples(profile, samples)
    if color_bits is not None and (wrong := _check_int(color_bits)):
        raise UnsupportedState(f"The framebuffer's color_bits {wrong.predicate}.")
    if color_bits is not None and color_bits not in profile.color_bits:
        widths = " or ".join(map(str, profile.color_bits))
        raise UnsupportedState(
            f"The framebuffer's colors have {_shown(color_bits)} bits a component; {profile.name} has "
            f"{widths}. Give one of these, or change the machine by with_precision."
        )
    statistics = statistics or PixelStatistics()
    walk = _Walk(profile, width, height, depth_bits, textures or {}, surfaces or {}, statistics, read)
    since = "" if host_step is None else f' from HostStep "{host_step}" on'
    for number, command in enumerate(frame_of(commands)):
        if walk.takes(command):
            continue
        walk.where = f"Command {number}{since}"
        if type(command) not in _HANDLERS:
            walk.refuse(
                f"{_shown(command)} is no command; a frame is made of "
                f"{', '.join(kind.__name__ for kind in _HANDLERS)}."
            )
        if isinstance(command.label, str):
            walk.where = f'Command {number}{since}, "{command.label}"'
        walk.command(command)


def validate_program(texture_shader, combiners, profile):
    """Refuse texture shader stages and register combiners that the machine does not have, whatever textures
    and meshes they meet; either may be None.

    Raises UnsupportedState (a ValueError) that names what was given, what the machine allows, what to do.
    """
    walk = _Walk(profile, 1, 1, profile.widest_depth, {}, {}, PixelStatistics())
    walk.where = "This program"
    if texture_shader is not None:
        units = len(texture_shader)
        if not profile.texture_shader_operations:
            walk.refuse(f"{profile.name} has no texture shaders; choose a profile that has them.")
        if units > profile.max_texture_units:
            walk.refuse(
                f"{profile.name} has {_count(profile.max_texture_units, 'texture unit')}; this program has "
                f"{units} stages. Split the pass or choose a profile with more."
            )
        walk.texture_shader(
            PassState(texture_units=(TextureUnit(None),) * units, texture_shader=texture_shader)
        )
    if combiners is not None:
        walk.register_combiners(combiners)
