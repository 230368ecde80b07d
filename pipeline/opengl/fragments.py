"""Modes of rasterization, per-fragment operations and whole framebuffers (OpenGL 1.2.1 chapters 3 and 4)."""

import math

from fixedpipe.pipeline.commands import Accum, Clear
from fixedpipe.pipeline.enums import (
    AccumOperation,
    BlendEquation,
    BlendFactor,
    ComparisonFunction,
    Face,
    FrontFace,
    LineRasterization,
    LogicOperation,
    PolygonMode,
    ProvokingVertex,
    ShadeModel,
    StencilOperation,
)
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.capabilities import capability
from fixedpipe.pipeline.opengl.entry_points import entry, no_effect
from fixedpipe.pipeline.opengl.outcomes import GLError, Refused
from fixedpipe.pipeline.opengl.values import declare, section
from fixedpipe.pipeline.state import (
    AlphaTest,
    Blending,
    ColorMask,
    DepthTest,
    LineState,
    PolygonState,
    Scissor,
    StencilTest,
)


def words(enumeration, **other_names):
    """{token: member} of an enumeration whose members have the tokens' names, except for a vendor's suffix.

    ``other_names``: {member's name: token's name} for members whose token has another name.
    """
    found = {}
    for member in enumeration:
        stem = other_names.get(member.name, member.name)
        for suffix in ("", "_EXT", "_ARB", "_NV", "_SGIS", "_SGIX"):
            value = getattr(tokens, stem + suffix, None)
            if isinstance(value, int):
                found.setdefault(value, member)
                break
    return found


COMPARISONS = words(ComparisonFunction)
STENCIL_OPERATIONS = words(StencilOperation) | {
    tokens.INCR_WRAP: StencilOperation.INCR_WRAP,
    tokens.DECR_WRAP: StencilOperation.DECR_WRAP,
}
BLEND_FACTORS = words(BlendFactor)
BLEND_EQUATIONS = words(BlendEquation)
LOGIC_OPERATIONS = words(LogicOperation)
FACES = words(Face)
FRONT_FACES = words(FrontFace)
POLYGON_MODES = words(PolygonMode)
SHADE_MODELS = words(ShadeModel)
ACCUM_OPERATIONS = words(AccumOperation)


def member(table, token):
    """The member of a table for a token. Raises GLError(INVALID_ENUM)."""
    found = table.get(token)
    if found is None:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(token)} is not among its values")
    return found


def clamped(*components):
    """Components clamped to [0, 1]."""
    return tuple([min(max(float(c), 0.0), 1.0) for c in components])


# ---------------------------------------------------------------------------------- rasterization (chapter 3)

_POLYGON, _LINE, _POINT = tokens.POLYGON_BIT, tokens.LINE_BIT, tokens.POINT_BIT

capability(tokens.CULL_FACE, _POLYGON)
capability(tokens.POLYGON_OFFSET_FILL, _POLYGON)
capability(tokens.POLYGON_OFFSET_LINE, _POLYGON)
capability(tokens.POLYGON_OFFSET_POINT, _POLYGON)
capability(tokens.POLYGON_STIPPLE, _POLYGON)
capability(tokens.POLYGON_SMOOTH, _POLYGON)
capability(tokens.LINE_STIPPLE, _LINE)
capability(tokens.LINE_SMOOTH, _LINE)
capability(tokens.MULTISAMPLE, tokens.MULTISAMPLE_BIT, initial=True)
for _token in (tokens.SAMPLE_ALPHA_TO_COVERAGE, tokens.SAMPLE_ALPHA_TO_ONE, tokens.SAMPLE_COVERAGE):
    capability(_token, tokens.MULTISAMPLE_BIT)  # of no effect with one sample a pixel
declare("cull_face_mode", tokens.BACK, _POLYGON)
declare("front_face", tokens.CCW, _POLYGON)
declare("front_mode", tokens.FILL, _POLYGON)
declare("back_mode", tokens.FILL, _POLYGON)
declare("polygon_offset", (0.0, 0.0), _POLYGON)
declare("polygon_stipple", b"\xff" * 128, tokens.POLYGON_STIPPLE_BIT)
declare("shade_model", tokens.SMOOTH, tokens.LIGHTING_BIT)
declare("provoking_vertex", ProvokingVertex.LAST, tokens.LIGHTING_BIT)
declare("line_width", 1.0, _LINE)
declare("line_stipple", (1, 0xFFFF), _LINE)


@section(
    "polygon",
    ("enabled", tokens.CULL_FACE),
    "cull_face_mode",
    "front_face",
    "front_mode",
    "back_mode",
    "polygon_offset",
    ("enabled", tokens.POLYGON_OFFSET_FILL),
    ("enabled", tokens.POLYGON_OFFSET_LINE),
    ("enabled", tokens.POLYGON_OFFSET_POINT),
    ("enabled", tokens.POLYGON_STIPPLE),
    "polygon_stipple",
    ("enabled", tokens.POLYGON_SMOOTH),
    "shade_model",
    "provoking_vertex",
)
def _polygon(
    gl,
    cull,
    culled,
    front,
    front_mode,
    back_mode,
    offset,
    fill,
    line,
    point,
    stipple,
    pattern,
    smooth,
    shade,
    provoking,
):
    return PolygonState(
        cull_face=FACES[culled] if cull else None,
        front_face=FRONT_FACES[front],
        offset_fill=fill,
        offset_factor=offset[0] if fill or line or point else 0.0,
        offset_units=offset[1] if fill or line or point else 0.0,
        shade_model=SHADE_MODELS[shade],
        provoking_vertex=provoking,
        front_mode=POLYGON_MODES[front_mode],
        back_mode=POLYGON_MODES[back_mode],
        offset_line=line,
        offset_point=point,
        stipple=pattern if stipple else None,
        smooth=_smooths(gl, smooth, "POLYGON_SMOOTH", "polygons"),
    )


def _smooths(gl, enabled, capability_name, what):
    """Whether an enabled smooth mode takes effect. If the machine cannot smooth, this is counted."""
    if enabled and not gl.profile.primitives.smoothing_samples:
        gl.tally.add("no effect", f"{capability_name}: {gl.profile.name} has no smooth {what}")
        return False
    return enabled


@section(
    "line", "line_width", ("enabled", tokens.LINE_STIPPLE), "line_stipple", ("enabled", tokens.LINE_SMOOTH)
)
def _line(gl, width, stipple, pattern, smooth):
    primitives = gl.profile.primitives
    smooth = _smooths(gl, smooth, "LINE_SMOOTH", "lines")
    # Section 3.4.2.1: an aliased line's width is rounded to the nearest integer, and clamped to the range.
    if not smooth:
        width = max(1.0, math.floor(width + 0.5))
    return LineState(
        width=min(width, primitives.max_line_width),
        # Section 3.4.4: a smooth line is a rectangle.
        rasterization=LineRasterization.RECTANGLE if smooth else LineRasterization.STEPS,
        stipple=pattern if stipple else None,
        smooth=smooth,
    )


@entry("CullFace")
def cull_face(gl, mode):
    """Set which faces CULL_FACE discards."""
    member(FACES, mode)
    gl.values.set("cull_face_mode", mode)


@entry("FrontFace")
def front_face(gl, mode):
    """Set the orientation of front faces."""
    member(FRONT_FACES, mode)
    gl.values.set("front_face", mode)


@entry("PolygonMode")
def polygon_mode(gl, face, mode):
    """Set how polygons are drawn (section 3.5.4)."""
    member(POLYGON_MODES, mode)
    member(FACES, face)
    if face != tokens.BACK:
        gl.values.set("front_mode", mode)
    if face != tokens.FRONT:
        gl.values.set("back_mode", mode)


@entry("PolygonOffset")
def polygon_offset(gl, factor, units):
    """Set the depth offset (section 3.5.5)."""
    gl.values.set("polygon_offset", (float(factor), float(units)))


@entry("PolygonOffsetEXT")
def polygon_offset_ext(gl, factor, bias):
    """Set the depth offset; its bias is a depth from 0 to 1 (EXT_polygon_offset)."""
    polygon_offset(gl, factor, bias * ((1 << gl.profile.widest_depth) - 1))


@entry("ShadeModel")
def shade_model(gl, mode):
    """Set the shade model, FLAT or SMOOTH."""
    member(SHADE_MODELS, mode)
    gl.values.set("shade_model", mode)


@entry("ProvokingVertex")
def provoking_vertex(gl, mode):
    """Set which vertex determines the colour of a flat primitive (EXT_provoking_vertex)."""
    first, last = 0x8E4D, 0x8E4E  # FIRST_VERTEX_CONVENTION_EXT, LAST_VERTEX_CONVENTION_EXT
    chosen = member({first: ProvokingVertex.FIRST, last: ProvokingVertex.LAST}, mode)
    gl.values.set("provoking_vertex", chosen)


@entry("LineWidth")
def line_width(gl, width):
    """Set the width of lines, in pixels."""
    if not width > 0:
        raise GLError(tokens.INVALID_VALUE)
    gl.values.set("line_width", float(width))


@entry("LineStipple")
def line_stipple(gl, factor, pattern):
    """Set the stipple of lines; the factor is clamped to [1, 256]."""
    gl.values.set("line_stipple", (min(max(int(factor), 1), 256), int(pattern) & 0xFFFF))


# ----------------------------------------------------------------------- per-fragment operations (chapter 4)

_COLOR_BUFFER, _STENCIL, _DEPTH = tokens.COLOR_BUFFER_BIT, tokens.STENCIL_BUFFER_BIT, tokens.DEPTH_BUFFER_BIT

capability(tokens.SCISSOR_TEST, tokens.SCISSOR_BIT)
capability(tokens.ALPHA_TEST, _COLOR_BUFFER)
capability(tokens.STENCIL_TEST, _STENCIL)
capability(tokens.DEPTH_TEST, _DEPTH)
capability(tokens.BLEND, _COLOR_BUFFER)
capability(tokens.COLOR_LOGIC_OP, _COLOR_BUFFER)
capability(tokens.INDEX_LOGIC_OP, _COLOR_BUFFER)
capability(tokens.DITHER, _COLOR_BUFFER, initial=True)
declare("scissor", lambda gl: (0, 0, gl.drawable.width, gl.drawable.height), tokens.SCISSOR_BIT)
declare("alpha_function", (tokens.ALWAYS, 0.0), _COLOR_BUFFER)
declare("stencil_function", (tokens.ALWAYS, 0, 0xFFFFFFFF), _STENCIL)
declare("stencil_operations", (tokens.KEEP, tokens.KEEP, tokens.KEEP), _STENCIL)
declare("stencil_write_mask", 0xFFFFFFFF, _STENCIL)
declare("depth_function", tokens.LESS, _DEPTH)
declare("depth_mask", True, _DEPTH)
declare("blend_factors", (tokens.ONE, tokens.ZERO), _COLOR_BUFFER)
declare("blend_equation", tokens.FUNC_ADD, _COLOR_BUFFER)
declare("blend_color", (0.0, 0.0, 0.0, 0.0), _COLOR_BUFFER)
declare("logic_operation", tokens.COPY, _COLOR_BUFFER)
declare("color_mask", (True, True, True, True), _COLOR_BUFFER)
declare("clear_color", (0.0, 0.0, 0.0, 0.0), _COLOR_BUFFER)
declare("clear_depth", 1.0, _DEPTH)
declare("clear_stencil", 0, _STENCIL)
declare("clear_accum", (0.0, 0.0, 0.0, 0.0), tokens.ACCUM_BUFFER_BIT)
declare("render_mode", tokens.RENDER)


@section("scissor section", ("enabled", tokens.SCISSOR_TEST), "scissor")
def _scissor(gl, enabled, box):
    return Scissor(*box) if enabled else None


@section("alpha_test", ("enabled", tokens.ALPHA_TEST), "alpha_function")
def _alpha_test(gl, enabled, function):
    return AlphaTest(COMPARISONS[function[0]], function[1]) if enabled else None


@section(
    "stencil_test",
    ("enabled", tokens.STENCIL_TEST),
    "stencil_function",
    "stencil_operations",
    "stencil_write_mask",
)
def _stencil_test(gl, enabled, function, operations, write_mask):
    if not enabled:
        return None
    fail, depth_fail, depth_pass = [STENCIL_OPERATIONS[operation] for operation in operations]
    compared, reference, mask = function
    return StencilTest(
        COMPARISONS[compared],
        min(max(reference, 0), 255),
        mask & 0xFF,
        fail,
        depth_fail,
        depth_pass,
        write_mask & 0xFF,
    )


@section("depth_test", ("enabled", tokens.DEPTH_TEST), "depth_function", "depth_mask")
def _depth_test(gl, enabled, function, mask):
    return DepthTest(COMPARISONS[function], mask) if enabled else None


@section(
    "blending",
    ("enabled", tokens.BLEND),
    ("enabled", tokens.COLOR_LOGIC_OP),
    "blend_factors",
    "blend_equation",
    "blend_color",
)
def _blending(gl, enabled, logic, factors, equation, color):
    # Section 4.1.8: an enabled COLOR_LOGIC_OP replaces blending.
    if not enabled or logic:
        return None
    source, destination = [BLEND_FACTORS[factor] for factor in factors]
    return Blending(source, destination, BLEND_EQUATIONS[equation], color)


@section("logic_op", ("enabled", tokens.COLOR_LOGIC_OP), "logic_operation")
def _logic_op(gl, enabled, operation):
    return LOGIC_OPERATIONS[operation] if enabled else None


@section("color_mask section", "color_mask", "draw_buffer")
def _color_mask(gl, mask, buffer):
    # Without a colour buffer fragments are tested, counted, and written to the other buffers (section 4.2.1).
    return ColorMask(*((False,) * 4 if buffer == tokens.NONE else mask))


@entry("Scissor")
def scissor(gl, x, y, width, height):
    """Set the scissor box (section 4.1.2)."""
    if width < 0 or height < 0:
        raise GLError(tokens.INVALID_VALUE)
    gl.values.set("scissor", (int(x), int(y), int(width), int(height)))


@entry("AlphaFunc")
def alpha_func(gl, function, reference):
    """Set the alpha test (section 4.1.3)."""
    member(COMPARISONS, function)
    gl.values.set("alpha_function", (function, *clamped(reference)))


@entry("StencilFunc")
def stencil_func(gl, function, reference, mask):
    """Set the stencil test (section 4.1.4)."""
    member(COMPARISONS, function)
    gl.values.set("stencil_function", (function, int(reference), int(mask) & 0xFFFFFFFF))


@entry("StencilOp")
def stencil_op(gl, *operations):
    """Set the operations on stencil values."""
    for operation in operations:
        member(STENCIL_OPERATIONS, operation)
    fail, depth_fail, depth_pass = operations
    gl.values.set("stencil_operations", (fail, depth_fail, depth_pass))


def _of_both_faces(face):
    """Refuse a stencil state for one face, because no machine here has EXT_stencil_two_side."""
    if member(FACES, face) is not Face.FRONT_AND_BACK:
        raise Refused("a stencil state of one face alone: no machine here has EXT_stencil_two_side")


@entry("StencilFuncSeparate")
def stencil_func_separate(gl, face, function, reference, mask):
    """Set the stencil test of both faces (OpenGL 2.0)."""
    _of_both_faces(face)
    stencil_func(gl, function, reference, mask)


@entry("StencilOpSeparate")
def stencil_op_separate(gl, face, *operations):
    """Set the operations on stencil values for both faces (OpenGL 2.0)."""
    _of_both_faces(face)
    stencil_op(gl, *operations)


@entry("StencilMaskSeparate")
def stencil_mask_separate(gl, face, mask):
    """Set which bits of stencil values both faces write (OpenGL 2.0)."""
    _of_both_faces(face)
    stencil_mask(gl, mask)


@entry("StencilMask")
def stencil_mask(gl, mask):
    """Set which bits of stencil values are written."""
    gl.values.set("stencil_write_mask", int(mask) & 0xFFFFFFFF)


@entry("DepthFunc")
def depth_func(gl, function):
    """Set the depth test (section 4.1.5)."""
    member(COMPARISONS, function)
    gl.values.set("depth_function", function)


@entry("DepthMask")
def depth_mask(gl, flag):
    """Set whether depths are written."""
    gl.values.set("depth_mask", bool(flag))


@entry("BlendFunc")
def blend_func(gl, source, destination):
    """Set the blend factors (section 4.1.6)."""
    member(BLEND_FACTORS, source)
    member(BLEND_FACTORS, destination)
    gl.values.set("blend_factors", (source, destination))


@entry("BlendFuncSeparate")
def blend_func_separate(gl, source, destination, source_alpha, destination_alpha):
    """Set the blend factors (EXT_blend_func_separate). Other factors for alpha are refused: no machine here
    has them.
    """
    if (source, destination) != (source_alpha, destination_alpha):
        raise Refused(
            "blending alpha by other factors than colours: no machine here has EXT_blend_func_separate"
        )
    blend_func(gl, source, destination)


@entry("BlendEquation")
def blend_equation(gl, equation):
    """Set the blend equation."""
    member(BLEND_EQUATIONS, equation)
    gl.values.set("blend_equation", equation)


@entry("BlendEquationSeparate")
def blend_equation_separate(gl, equation, alpha_equation):
    """Set the blend equation (EXT_blend_equation_separate). Another equation for alpha is refused."""
    if equation != alpha_equation:
        raise Refused("blending alpha by another equation than colours: no machine here does so")
    blend_equation(gl, equation)


@entry("BlendColor")
def blend_color(gl, *color):
    """Set the constant blend colour."""
    gl.values.set("blend_color", clamped(*color))


@entry("LogicOp")
def logic_op(gl, operation):
    """Set the logic operation (section 4.1.8)."""
    member(LOGIC_OPERATIONS, operation)
    gl.values.set("logic_operation", operation)


@entry("ColorMask")
def color_mask(gl, *mask):
    """Set which components of colours are written."""
    gl.values.set("color_mask", tuple(map(bool, mask)))


# ----------------------------------------------------------------------------------------- whole framebuffers


@entry("ClearColor")
def clear_color(gl, *color):
    """Set the colour that Clear writes."""
    gl.values.set("clear_color", clamped(*color))


@entry("ClearDepth", "ClearDepthf")
def clear_depth(gl, depth):
    """Set the depth that Clear writes."""
    gl.values.set("clear_depth", clamped(depth)[0])


@entry("ClearStencil")
def clear_stencil(gl, value):
    """Set the stencil value that Clear writes."""
    gl.values.set("clear_stencil", int(value) & 0xFF)


@entry("ClearAccum")
def clear_accum(gl, *color):
    """Set the value that Clear writes into the accumulation buffer."""
    gl.values.set("clear_accum", tuple([min(max(float(c), -1.0), 1.0) for c in color]))


@entry("Clear")
def clear(gl, mask):
    """Clear buffers (section 4.2.3)."""
    known = (
        tokens.COLOR_BUFFER_BIT
        | tokens.DEPTH_BUFFER_BIT
        | tokens.STENCIL_BUFFER_BIT
        | tokens.ACCUM_BUFFER_BIT
    )
    if mask & ~known:
        raise GLError(tokens.INVALID_VALUE)
    if gl.values["render_mode"] != tokens.RENDER:
        return
    values = gl.values
    color = mask & tokens.COLOR_BUFFER_BIT and values["draw_buffer"] != tokens.NONE
    depth = mask & tokens.DEPTH_BUFFER_BIT and values["depth_mask"]
    stencil = mask & tokens.STENCIL_BUFFER_BIT
    accumulation = mask & tokens.ACCUM_BUFFER_BIT and gl.drawable is gl.window
    if not (color or depth or stencil or accumulation):
        return
    gl.commands.append(
        Clear(
            label=f"{gl.called} (call {gl.tally.call})",
            color=values["clear_color"] if color else None,
            depth=values["clear_depth"] if depth else None,
            stencil=values["clear_stencil"] if stencil else None,
            accumulation=values["clear_accum"] if accumulation else None,
            scissor=values.section("scissor section"),
            color_mask=values.section("color_mask section"),
            stencil_write_mask=values["stencil_write_mask"] & 0xFF,
        )
    )


@entry("Accum")
def accum(gl, operation, value):
    """Move colours to and from the accumulation buffer (section 4.2.4)."""
    chosen = member(ACCUM_OPERATIONS, operation)
    if gl.values["render_mode"] != tokens.RENDER:  # section 5.2: nothing changes the framebuffer
        return
    gl.commands.append(
        Accum(
            label=f"{gl.called} (call {gl.tally.call})",
            operation=chosen,
            value=float(value),
            scissor=gl.values.section("scissor section"),
            color_mask=gl.values.section("color_mask section"),
        )
    )


no_effect("ClearIndex", "IndexMask", "SampleCoverage", "SampleMask", "SamplePattern")
no_effect("Finish", "Flush", compiled=False)
no_effect("AddSwapHintRect", "FlushRaster", "ResizeBuffers", "TextureRange", compiled=False)
