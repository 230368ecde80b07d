"""The pass sequence in words: nothing that matters is left out, and equations say what is computed."""

import re
from dataclasses import MISSING, fields, is_dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings

from fixedpipe.pipeline.commands import Clear, CopyTexImage, CopyTexSubImage, Draw, Mesh, ReadPixels, TexImage
from fixedpipe.pipeline.description.describe import describe
from fixedpipe.pipeline.enums import (
    BlendFactor,
    ComparisonFunction,
    Face,
    InternalFormat,
    LogicOperation,
    PrimitiveType,
    TexGenMode,
    TextureFilter,
)
from fixedpipe.pipeline.notations.register_combiners import parse
from fixedpipe.pipeline.notations.texture_shaders import parse as parse_stages
from fixedpipe.pipeline.state import (
    AlphaTest,
    Blending,
    ColorMask,
    ColorMaterial,
    Combine,
    DepthClamp,
    DepthTest,
    Fog,
    Light,
    Lighting,
    PassState,
    PointParameters,
    PointState,
    PolygonState,
    RegisterCombiners,
    Sampler,
    Scissor,
    StencilTest,
    TexGen,
    TextureShaderStage,
    TextureUnit,
    VertexState,
    WindowClip,
)
from fixedpipe.pipeline.textures.images import texture_2d
from tests.support.combiner_strategies import register_combiners

MESH = Mesh(np.zeros((3, 3)))


def described(state):
    return describe((Draw(label="pass", mesh=MESH, state=state),))


def equations(text):
    """The lines of register combiners, without their indentation."""
    lines = described(PassState(register_combiners=parse("!!RC1.0\n" + text))).splitlines()
    return [line.strip() for line in lines if line.lstrip().startswith(("GC", "final", "COLOR_SUM", "const"))]


def test_a_pass_sequence_reads_like_this():
    combiners = parse("""!!RC1.0
        const0 = (0.25, 0.5, 1, 1);
        { rgb { spare0 = expand(tex0) . expand(col0); scale_by_four(); } }
        out.rgb = spare0 * const0; out.a = tex1;""")
    unit = TextureUnit("normals", sampler=Sampler(min_filter=TextureFilter.LINEAR))
    reflected = replace(unit, texture="sky", gen=(TexGen(TexGenMode.SPHERE_MAP),) * 2 + (TexGen(),) * 2)
    state = PassState(
        texture_units=(unit, reflected),
        register_combiners=combiners,
        depth_test=DepthTest(ComparisonFunction.EQUAL, write=False),
        blending=Blending(BlendFactor.ONE, BlendFactor.ONE),
        color_mask=ColorMask(alpha=False),
    )
    image = texture_2d(np.zeros((4, 8, 3)), InternalFormat.RGB8, mipmaps=True)
    frame = (
        Clear(label="begin", color=(0.0, 0.0, 0.0, 0.0), depth=1.0),
        TexImage(label="normal map", texture="normals", image=image),
        CopyTexImage(label="what is there", texture="sky"),
        Draw(
            label="diffuse",
            mesh=replace(MESH, indices=[0, 1, 2, 0], counts=(4,), primitive=PrimitiveType.TRIANGLE_FAN),
            state=state,
        ),
        CopyTexSubImage(label="part of it", texture="sky", x_offset=3, x=1, width=2, height=1),
        ReadPixels(label="look", name="sum", format="RGB", x=1, width=5),
    )
    assert (
        describe(frame)
        == """\
0. Clear "begin"
   clears color to (0, 0, 0, 0), depth to 1

1. TexImage "normal map"
   texture "normals": TEXTURE_2D, RGB8, 8x4, 4 levels

2. CopyTexImage "what is there"
   texture "sky": TEXTURE_2D, RGBA8, from the whole framebuffer

3. Draw "diffuse"
   draws TRIANGLE_FAN, 3 vertices, 4 indices in 1 run
   texture unit 0: texture "normals"
     sampler: TEXTURE_MIN_FILTER LINEAR
   texture unit 1: texture "sky"
     sampler: TEXTURE_MIN_FILTER LINEAR
     TEXTURE_GEN_S: mode SPHERE_MAP
     TEXTURE_GEN_T: mode SPHERE_MAP
   REGISTER_COMBINERS enabled
     const0 = (0.25, 0.5, 1, 1)
     GC0.rgb: spare0 = 4 * (expand(tex0) . expand(col0))
     COLOR_SUM_CLAMP disabled
     final.rgb: out.rgb = spare0 * const0
     final.alpha: out.a = tex1.a
   DEPTH_TEST enabled: function EQUAL, depth writes disabled
   BLEND enabled: source ONE, destination ONE
   color mask writes red, green, blue

4. CopyTexSubImage "part of it"
   texture "sky" at (3, 0): from the framebuffer from (1, 0), 2 columns and 1 row

5. ReadPixels "look"
   "sum": RGB of the framebuffer from (1, 0), 5 columns and all rows
"""
    )


def test_the_initial_state_has_nothing_to_say():
    assert described(PassState()) == '0. Draw "pass"\n   draws TRIANGLES, 3 vertices\n'


def test_no_commands_are_no_text():
    assert describe(()) == ""


# ------------------------------------------------------------------------- every field of every state

FULL = PassState(
    vertex=VertexState(
        lighting=Lighting(lights=(Light(),), color_material=ColorMaterial()),
        clip_planes=((1.0, 0.0, 0.0, 0.0),),
    ),
    polygon=PolygonState(cull_face=Face.FRONT, stipple=bytes(128)),
    texture_units=(TextureUnit("a"),),
    fog=Fog(),
    scissor=Scissor(0, 0, 8, 8),
    alpha_test=AlphaTest(),
    stencil_test=StencilTest(),
    depth_test=DepthTest(),
    depth_clamp=DepthClamp(maximum=5.0),
    blending=Blending(),
    logic_op=LogicOperation.AND,
    texture_shader=(TextureShaderStage(),),
    point=PointState(parameters=PointParameters()),
    window_clip=WindowClip((Scissor(0, 0, 8, 8),)),
)


def another(value):
    """A value of the same kind that differs from ``value``."""
    if isinstance(value, bool):
        return not value
    if hasattr(type(value), "__members__"):
        members = list(type(value))
        return members[(members.index(value) + 1) % len(members)]
    if isinstance(value, int):
        return value + 1
    if isinstance(value, float):
        return value + 0.0123456789
    if isinstance(value, str):
        return value + "b"
    if isinstance(value, bytes):
        return b"\xab" + value[1:]
    return (another(value[0]), *value[1:])


def changes(value, path=""):
    """(path, changed copy) for every simple field inside a state. What combines is shown as an equation."""
    if is_dataclass(value):
        for field in fields(value):
            inner = getattr(value, field.name)
            if inner is not None and not isinstance(inner, RegisterCombiners | Combine):
                for below, changed in changes(inner, f"{path}.{field.name}"):
                    yield below, replace(value, **{field.name: changed})
    elif isinstance(value, tuple) and value and is_dataclass(value[0]):
        for i, inner in enumerate(value):
            for below, changed in changes(inner, f"{path}[{i}]"):
                yield below, (*value[:i], changed, *value[i + 1 :])
    elif value != ():
        yield path, another(value)


CHANGES = dict(changes(FULL))


def leaf(state, path):
    """The value at a path of ``changes``; of a tuple of numbers the first, in depth."""
    for name in path.replace("[", ".").replace("]", "").strip(".").split("."):
        state = state[int(name)] if name.isdigit() else getattr(state, name)
    while isinstance(state, tuple):
        state = state[0]
    return state


def said(text, value):
    """How often a description says a value."""
    if isinstance(value, bool):
        return 0
    if hasattr(value, "name"):
        return len(re.findall(rf"\b{value.name}\b", text))
    if isinstance(value, str | bytes):
        return text.count(value if isinstance(value, str) else value.hex(" ", 4))
    return sum(float(number) == value for number in re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", text))


@pytest.mark.parametrize("path", CHANGES)
def test_a_change_of_any_field_is_said(path):
    before, after, value = described(FULL), described(CHANGES[path]), leaf(CHANGES[path], path)
    assert after != before
    assert isinstance(value, bool) or said(after, value) > said(before, value)


@pytest.mark.parametrize("name", [f.name for f in fields(PassState) if f.default is None])
def test_what_is_switched_off_is_not_mentioned_and_what_is_switched_on_is(name):
    on = getattr(replace(FULL, register_combiners=RegisterCombiners()), name)
    assert len(described(PassState(**{name: on})).splitlines()) > len(described(PassState()).splitlines())


def test_every_state_class_with_fields_of_its_own_was_changed():
    reached = {path.lstrip(".").split(".")[0].split("[")[0] for path in CHANGES}
    simple = {
        f.name for f in fields(PassState) if f.default is not MISSING or f.default_factory is not MISSING
    }
    assert reached == simple - {"register_combiners"}


@pytest.mark.parametrize("value", [0.1, 1 / 3, 1e-9, 12345678.5])
def test_numbers_are_shown_with_every_digit_they_need(value):
    text = described(PassState(alpha_test=AlphaTest(reference=value)))
    assert float(text.rsplit("reference ", 1)[1]) == value


# ------------------------------------------------------------------------------------------- equations


@pytest.mark.parametrize(
    ("portion", "expected"),
    [
        ("rgb { spare0 = tex0; }", "GC0.rgb: spare0 = tex0"),
        ("rgb { spare0 = tex0 * one; }", "GC0.rgb: spare0 = tex0"),
        ("rgb { spare0 = one * tex0; }", "GC0.rgb: spare0 = tex0"),
        ("rgb { spare0 = tex0 * zero; }", "GC0.rgb: spare0 = 0"),
        ("rgb { spare0 = tex0 . zero; }", "GC0.rgb: spare0 = 0"),
        ("rgb { spare0 = tex0 . one; }", "GC0.rgb: spare0 = tex0 . 1"),
        ("rgb { spare0 = -tex0.a * unsigned_invert(col1); }", "GC0.rgb: spare0 = -tex0.a * (1 - col1)"),
        (
            "rgb { spare0 = unsigned(tex0) * -half_bias(fog); }",
            "GC0.rgb: spare0 = unsigned(tex0) * -half_bias(fog)",
        ),
        ("rgb { spare0 = expand(zero); }", "GC0.rgb: spare0 = -1"),
        ("rgb { spare0 = tex0; spare1 = col0 * col1; }", "GC0.rgb: spare0 = tex0; spare1 = col0 * col1"),
        (
            "rgb { discard = tex0; discard = -col0 * col1; spare0 = sum(); }",
            "GC0.rgb: spare0 = tex0 - col0 * col1",
        ),
        ("rgb { discard = tex0; discard = zero; spare0 = sum(); }", "GC0.rgb: spare0 = tex0"),
        ("rgb { discard = zero; discard = zero; spare0 = sum(); }", "GC0.rgb: spare0 = 0"),
        (
            "rgb { discard = tex0 . col0; discard = -tex1 . col0; spare0 = sum(); scale_by_two(); }",
            "GC0.rgb: spare0 = 2 * ((tex0 . col0) + (-tex1 . col0))",
        ),
        (
            "rgb { discard = tex0; discard = col0; spare1 = mux(); }",
            "GC0.rgb: spare1 = (spare0.a < 1/2 ? tex0 : col0)",
        ),
        ("rgb { spare0 = tex0; scale_by_two(); }", "GC0.rgb: spare0 = 2 * tex0"),
        ("rgb { spare0 = tex0 * col0; scale_by_one_half(); }", "GC0.rgb: spare0 = 1/2 * (tex0 * col0)"),
        ("rgb { spare0 = tex0; bias_by_negative_one_half(); }", "GC0.rgb: spare0 = tex0 - 1/2"),
        (
            "rgb { spare0 = tex0 * col0; bias_by_negative_one_half_scale_by_two(); }",
            "GC0.rgb: spare0 = 2 * (tex0 * col0 - 1/2)",
        ),
        ("rgb { spare0 = zero; scale_by_four(); }", "GC0.rgb: spare0 = 0"),
        (
            "rgb { spare0 = zero; bias_by_negative_one_half_scale_by_two(); }",
            "GC0.rgb: spare0 = 2 * -1/2",
        ),
        ("alpha { spare0 = tex0 * col0.b; }", "GC0.alpha: spare0.a = tex0.a * col0.b"),
        ("rgb { discard = tex0; }", "GC0: writes nothing"),
        ("const1 = (0, 1, 0, 0); rgb { spare0 = const1; }", "GC0: const1 = (0, 1, 0, 0)"),
    ],
)
def test_a_general_combiner_as_an_equation(portion, expected):
    assert equations(f"{{ {portion} }} out.rgb = spare0;")[0] == expected


@pytest.mark.parametrize(
    ("output", "expected"),
    [
        ("zero", "0"),
        ("one", "1"),
        ("spare0", "spare0"),
        ("tex0 * col0", "tex0 * col0"),
        ("tex0 * col0 + spare1", "tex0 * col0 + spare1"),
        ("tex0 + spare1", "tex0 + spare1"),
        ("one * color_sum", "color_sum"),
        ("lerp(fog.a, color_sum, fog)", "fog.a * color_sum + (1 - fog.a) * fog"),
        ("lerp(unsigned_invert(tex0.a), tex0, tex1)", "(1 - tex0.a) * tex0 + tex0.a * tex1"),
        ("lerp(tex0, zero, tex1) + zero", "(1 - tex0) * tex1"),
        ("lerp(tex0, one, zero) + zero", "tex0"),
        ("lerp(one, tex0, tex1)", "tex0"),
        ("lerp(zero, tex0, tex1)", "tex1"),
        ("unsigned_invert(zero) * unsigned_invert(tex1)", "(1 - tex1)"),
    ],
)
def test_the_final_combiner_drops_trivial_terms(output, expected):
    assert equations(f"out.rgb = {output};")[-2:] == [
        f"final.rgb: out.rgb = {expected}",
        "final.alpha: out.a = 0",
    ]


def test_final_product_is_shown_where_it_is_read():
    lines = equations("final_product = spare0 * spare1.a; out.rgb = final_product + col0; out.a = fog.b;")
    assert lines[-3:] == [
        "final: final_product = spare0 * spare1.a",
        "final.rgb: out.rgb = final_product + col0",
        "final.alpha: out.a = fog.b",
    ]
    assert not any(
        "final_product" in line for line in equations("final_product = spare0 * spare1; out.a = one;")
    )


def test_the_color_sum_clamp_is_mentioned_only_when_off():
    assert "COLOR_SUM_CLAMP disabled" in equations("out.rgb = color_sum;")
    assert "COLOR_SUM_CLAMP disabled" not in equations("clamp_color_sum(); out.rgb = color_sum;")


def test_constants_and_masks_of_commands_are_mentioned():
    text = describe(
        (
            Clear(
                label="c",
                stencil=3,
                scissor=Scissor(1, 2, 3, 4),
                color_mask=ColorMask(False, False, False, False),
                stencil_write_mask=1,
            ),
            Clear(label="idle"),
            CopyTexSubImage(label="s", texture="t", width=1, height=2, level=2, face=5),
        )
    )
    for words in (
        "clears stencil to 3",
        "SCISSOR_TEST enabled: x 1, y 2, width 3, height 4",
        "color mask writes nothing",
        "stencil write mask 1",
        "clears nothing",
        "of level 2 of face 5",
    ):
        assert words in text


def test_the_arrays_of_a_mesh_are_mentioned():
    columns = np.zeros((3, 3))
    mesh = Mesh(columns, colors=columns, normals=columns, texture_coordinates=(columns, columns))
    text = describe((Draw(label="d", mesh=mesh, state=PassState()),))
    assert "draws TRIANGLES, 3 vertices; with colors, normals, 2 texture coordinate sets" in text


@settings(max_examples=60)
@given(register_combiners(max_stages=4, units=4, per_stage_constants=True))
def test_all_register_combiners_can_be_described(combiners):
    text = described(PassState(register_combiners=combiners))
    assert text.count("final.rgb: out.rgb = ") == 1
    assert all(f"GC{number}" in text for number in range(len(combiners.general)))


DOTS = "texture_2d(); {0}_1of3({1}); {0}_2of3({1}); {0}_3of3({1});"
STAGES = {
    "texture_3d();": "tex0 = TEXTURE_3D(s0/q0, t0/q0, r0/q0)",
    "pass_through();": "tex0 = (s0, t0, r0, q0), clamped to [0, 1]",
    "cull_fragment(LESS_THAN_ZERO, GEQUAL_TO_ZERO, GEQUAL_TO_ZERO, LESS_THAN_ZERO);": (
        "tex0 = 0; kept where s0 < 0, t0 >= 0, r0 >= 0, q0 < 0"
    ),
    "texture_2d(); dependent_ar(tex0);": "tex1 = TEXTURE_2D(tex0.a, tex0.r)",
    "texture_2d(); offset_2d_scale(tex0, 1, 2, 3, 4, 0.5, 0.25);": (
        "tex1 = TEXTURE_2D((s1, t1) + [1 3 | 2 4] (tex0's ds, dt)), rgb times 0.5 tex0's magnitude + 0.25"
    ),
    "texture_2d(); dot_product_depth_replace_1of2(tex0); dot_product_depth_replace_2of2(tex0);": (
        "dot2 = (s2, t2, r2) . tex0; depth = dot1 / dot2; tex2 = 0"
    ),
    DOTS.format("dot_product_cube_map", "expand(tex0)"): (
        "dot3 = (s3, t3, r3) . expand(tex0); tex3 = TEXTURE_CUBE_MAP(dot1, dot2, dot3)"
    ),
    DOTS.format("dot_product_reflect_cube_map_eye_from_qs", "tex0"): (
        "dot3 = (s3, t3, r3) . tex0; tex3 = TEXTURE_CUBE_MAP(2 n (n . e) / (n . n) - e), "
        "n = (dot1, dot2, dot3), e = (q1, q2, q3)"
    ),
}


@pytest.mark.parametrize(("text", "expected"), STAGES.items())
def test_the_last_texture_shader_stage_as_an_equation(text, expected):
    stages = parse_stages("!!TS1.0\n" + text)
    last = described(PassState(texture_shader=stages)).splitlines()[-1]
    assert last.strip().removeprefix("TEXTURE_SHADER ") == f"stage {len(stages) - 1}: {expected}"
