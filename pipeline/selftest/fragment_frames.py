"""Frames of per-fragment operations, primitives, lighting and bands of rows.

The operations are depth, stencil, blending, logic, masks and fog. The primitives are points, lines and
polygons in their modes.
"""

from dataclasses import replace
from functools import reduce
from operator import add

from fixedpipe.pipeline.commands import Clear, Draw, Mesh
from fixedpipe.pipeline.enums import (
    BlendEquation,
    BlendFactor,
    ColorMaterialParameter,
    ComparisonFunction,
    DepthFormat,
    Face,
    FogCoordinateSource,
    FogGeneration,
    FogMode,
    FrontFace,
    LineRasterization,
    LogicOperation,
    PolygonMode,
    PrimitiveType,
    ProvokingVertex,
    ShadeModel,
    StencilOperation,
)
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, NV2A, OPENGL_1_2
from fixedpipe.pipeline.selftest.frame import SIZE, Frame, background, patched
from fixedpipe.pipeline.selftest.shapes import grid_indices, normal, patch, places
from fixedpipe.pipeline.state import (
    AlphaTest,
    Blending,
    ColorMask,
    ColorMaterial,
    DepthClamp,
    DepthTest,
    Fog,
    FogRegisters,
    Light,
    Lighting,
    LineState,
    Material,
    PassState,
    PointParameters,
    PointState,
    PolygonState,
    Scissor,
    Spot,
    StencilTest,
    VertexState,
    WindowClip,
)

_FUNCTIONS = tuple(ComparisonFunction)
_TESTED = DepthTest(ComparisonFunction.LEQUAL)


def _depths():
    """Every depth function, with and without writing, polygon offset and alpha tests."""
    for number, function in enumerate(_FUNCTIONS):
        yield PassState(
            depth_test=DepthTest(function, write=number % 3 != 1),
            alpha_test=AlphaTest(_FUNCTIONS[(number * 3) % 8], 0.55) if number % 2 else None,
            polygon=PolygonState(offset_fill=number % 2 == 0, offset_factor=-1.5, offset_units=300.0),
        )


def _buffered():
    """W buffers, clamped depths, and depths outside the view volume."""
    near = VertexState(projection=((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 2.5, 0), (0, 0, 0, 1)))
    for number, function in enumerate(_FUNCTIONS):
        yield PassState(
            vertex=near,
            depth_test=DepthTest(function),
            w_buffering=number % 2 == 1,
            depth_clamp=DepthClamp(cull=number % 3 == 0) if number % 2 == 0 else None,
        )


def _stencils():
    operations = tuple(StencilOperation)
    for number, function in enumerate(_FUNCTIONS):
        yield PassState(
            depth_test=_TESTED,
            stencil_test=StencilTest(
                function,
                reference=4 + number % 3,
                mask=0xFF if number % 2 else 0x0E,
                fail=operations[number],
                depth_fail=operations[(number + 3) % 8],
                depth_pass=operations[(number + 5) % 8],
                write_mask=0xFF if number % 3 else 0x35,
            ),
        )


def _blendings():
    factor, equations = BlendFactor, BlendEquation
    color = (0.2, 0.7, 0.4, 0.55)
    for source, destination, equation in (
        (factor.SRC_ALPHA, factor.ONE_MINUS_SRC_ALPHA, equations.FUNC_ADD),
        (factor.DST_COLOR, factor.ZERO, equations.FUNC_ADD),
        (factor.ONE, factor.ONE, equations.FUNC_ADD),
        (factor.SRC_ALPHA_SATURATE, factor.DST_ALPHA, equations.FUNC_ADD),
        (factor.CONSTANT_COLOR, factor.ONE_MINUS_CONSTANT_ALPHA, equations.FUNC_SUBTRACT),
        (factor.ONE_MINUS_DST_COLOR, factor.SRC_COLOR, equations.FUNC_REVERSE_SUBTRACT),
        (factor.SRC_ALPHA, factor.ONE, equations.MIN),
        (factor.ONE, factor.ONE_MINUS_DST_ALPHA, equations.MAX),
    ):
        yield PassState(blending=Blending(source, destination, equation, color))


def _logic():
    """All sixteen operations; the second eight draw over the first."""
    for number, operation in enumerate(LogicOperation):
        yield PassState(logic_op=operation, color_mask=ColorMask(alpha=number % 3 != 0))


def _masked():
    for number in range(8):
        yield PassState(
            depth_test=_TESTED if number % 2 else None,
            color_mask=ColorMask(number % 2 == 0, number % 3 != 0, number % 4 != 1, number < 5),
            scissor=Scissor(1 + number, 2, 29 - 2 * number, 60) if number % 2 else None,
            window_clip=WindowClip((Scissor(3, 5, 9, 50), Scissor(20, 30, 9, 30)), exclusive=number == 4)
            if number % 2 == 0
            else None,
            blending=Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE) if number % 4 == 3 else None,
        )


def _fogs():
    colored = {"color": (0.4, 0.7, 0.9, 1.0)}
    far = VertexState(modelview=((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, -0.4), (0, 0, 0, 1)))
    for number in range(8):
        coordinate = FogCoordinateSource(number // 4)
        mode = FogMode(number % 3)
        yield PassState(
            vertex=far,
            fog=Fog(
                mode, density=0.9 + number / 5, start=0.1, end=0.9, coordinate_source=coordinate, **colored
            ),
            color_sum=number % 2 == 1,
        )


def _registered_fogs():
    """The NV2A's own fog parameters and its table of factors."""
    generations = FogGeneration.RADIAL, FogGeneration.PLANAR, FogGeneration.ABSOLUTE_PLANAR
    for number in range(8):
        bias = 1.9 if number % 3 == FogMode.LINEAR else 1.5
        registers = FogRegisters(
            bias, -0.09 * (number + 1), generations[number % 3], (0.2, -0.3, 0.8, 0.1), number % 2 == 1
        )
        yield PassState(fog=Fog(FogMode(number % 3), color=(0.8, 0.3, 0.1, 0.5), registers=registers))


def _between(corners, u, v):
    """A place among a patch's four corners, by u and v."""
    weights = (1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v
    return [reduce(add, (w * c[i] for w, c in zip(weights, corners, strict=True))) for i in range(4)]


def _strokes(number, primitive):
    at = [(0.1 + k / 9.0, ((k * k + number) % 7) / 7.0) for k in range(8)]
    base = patch(number, SIZE)
    corners = base.positions if len(base.positions) == 4 else base.positions[[0, 5, 30, 35]]
    positions = [_between(corners, u, v) for u, v in at]
    return Mesh(positions, primitive, colors=[[u, v, 1.0 - u, 0.5 + v / 2] for u, v in at])


def _lines_and_points():
    lines, steps = PrimitiveType.LINES, LineRasterization.RECTANGLE
    for number, (primitive, state) in enumerate(
        (
            (lines, PassState(line=LineState(1.0))),
            (PrimitiveType.LINE_STRIP, PassState(line=LineState(3.0))),
            (PrimitiveType.LINE_LOOP, PassState(line=LineState(1.0, stipple=(2, 0x5F35)))),
            (lines, PassState(line=LineState(2.4, steps), depth_test=_TESTED)),
            (PrimitiveType.POINTS, PassState(point=PointState(1.0))),
            (PrimitiveType.POINTS, PassState(point=PointState(3.0))),
            (PrimitiveType.POINTS, PassState(point=PointState(4.6), depth_test=_TESTED)),
            (
                PrimitiveType.POINTS,
                PassState(point=PointState(parameters=PointParameters((0.2, 0.3, 0.1), 0.0, 6.0, 1.0))),
            ),
        )
    ):
        yield Draw(label=f"strokes {number}", mesh=_strokes(number, primitive), state=state)


def _polygon_modes():
    """Polygons drawn as points and lines, flat, culled, stippled and clipped."""
    stippled = bytes((0x5A, 0xF0, 0x33, 0x0F) * 32)
    turned = VertexState(clip_planes=((0.4, 0.7, 0.1, 0.55),))
    for state in (
        PolygonState(front_mode=PolygonMode.LINE, back_mode=PolygonMode.LINE),
        PolygonState(front_mode=PolygonMode.POINT, back_mode=PolygonMode.POINT, shade_model=ShadeModel.FLAT),
        PolygonState(shade_model=ShadeModel.FLAT, provoking_vertex=ProvokingVertex.FIRST),
        PolygonState(shade_model=ShadeModel.FLAT),
        PolygonState(stipple=stippled),
        PolygonState(cull_face=Face.FRONT, front_face=FrontFace.CW),
        PolygonState(cull_face=Face.BACK),
        PolygonState(
            front_mode=PolygonMode.LINE, back_mode=PolygonMode.FILL, offset_line=True, offset_units=9.0
        ),
    ):
        yield PassState(polygon=state, vertex=turned, depth_test=_TESTED)


_CONE = {"spot_direction": (-0.4, -0.2, -1.0), "spot_cutoff": 50.0, "spot_exponent": 3.0}
_UNIT_CONE = {"spot": Spot((0.5, 0.3, 1.0, 0.2), (-0.3, 0.4, 0.5)), "range": 6.0}


def _lit(cone):
    lights = (
        Light(ambient=(0.1, 0.1, 0.2, 1.0), position=(2.0, 1.0, 3.0, 1.0), linear_attenuation=0.1, **cone),
        Light(diffuse=(0.3, 0.9, 0.5, 1.0), specular=(0.9, 0.4, 0.3, 1.0), position=(-0.6, 0.3, 0.8, 0.0)),
    )
    for number in range(8):
        material = Material(
            specular=(0.9, 0.9, 0.6, 1.0),
            emission=(0.0, 0.1, 0.0, 1.0),
            shininess=(1.0, 7.0, 20.0)[number % 3],
        )
        lighting = Lighting(
            lights[: 1 + number % 2],
            material,
            local_viewer=number % 3 == 0,
            two_side=number % 4 == 1,
            separate_specular_color=number % 2 == 1,
            color_material=ColorMaterial(parameter=ColorMaterialParameter(number % 3))
            if number > 4
            else None,
        )
        yield PassState(vertex=VertexState(lighting=lighting, normalize=number % 2 == 0))


# Seven bands of rows, and part of an eighth.
_TALL = 24, 230


def _tall_draws():
    """Hundreds of small triangles and a few large ones over all bands, layer over layer."""
    steps = 12
    at = places(steps)
    for layer in range(4):
        shift = (layer - 1.5) / 9.0
        mesh = Mesh(
            [
                [
                    (2.2 * u - 1.1 + shift * v) * (1.0 + v / 2),
                    (2.1 * v - 1.05) * (1.0 + v / 2),
                    (0.6 - v - shift + (u - 0.5) * (layer - 1.4)) * (1.0 + v / 2),
                    1.0 + v / 2,
                ]
                for u, v in at
            ],
            indices=grid_indices(steps),
            colors=[[u, v, (layer + 1) / 5.0, 0.3 + u / 2] for u, v in at],
            normals=[normal(u, v) for u, v in at],
        )
        blending = Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE_MINUS_SRC_ALPHA) if layer % 2 else None
        state = PassState(depth_test=_TESTED, blending=blending)
        yield Draw(label=f"layer {layer}", mesh=mesh, state=state)


def _depth_frame(name, profile, states, **more):
    return Frame(name=name, profile=profile, commands=(*background(), *patched(states)), **more)


FRAGMENT_FRAMES = (
    _depth_frame("depth", GEFORCE_256, _depths(), window={"depth_bits": 24}),
    _depth_frame("depth-of-sixteen-bits", OPENGL_1_2, _depths(), window={"depth_bits": 16}),
    _depth_frame(
        "float-depths-and-w-buffers", NV2A, _buffered(), window={"depth_bits": DepthFormat.FLOAT_24}
    ),
    _depth_frame("stencil", GEFORCE_256, _stencils()),
    _depth_frame("blending", GEFORCE_3, _blendings()),
    _depth_frame("logic-operations", OPENGL_1_2, _logic()),
    _depth_frame("masks-and-scissors", NV2A, _masked()),
    Frame(name="fog", profile=GEFORCE_256, commands=(*background(), *patched(_fogs()))),
    Frame(name="fog-by-a-table", profile=NV2A, commands=(*background(), *patched(_registered_fogs()))),
    Frame(name="points-and-lines", profile=NV2A, commands=(*background(), *_lines_and_points())),
    Frame(name="polygon-modes", profile=GEFORCE_256, commands=(*background(), *patched(_polygon_modes()))),
    Frame(name="lighting", profile=GEFORCE_256, commands=(*background(), *patched(_lit(_CONE)))),
    Frame(
        name="lighting-unit",
        profile=NV2A,
        commands=(*background(), *patched(replace(s, color_sum=True) for s in _lit(_UNIT_CONE))),
    ),
    Frame(
        name="bands",
        profile=GEFORCE_256,
        size=_TALL,
        commands=(Clear(label="clear", color=(0.0, 0.0, 0.0, 0.0), depth=1.0), *_tall_draws()),
    ),
)
