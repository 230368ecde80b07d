"""Texture objects, parameters, environments, generation, and the texture units that a draw reads."""

import numpy as np
import pytest

from fixedpipe.pipeline.enums import (
    CombineFunction,
    CombineOperand,
    CombineSource,
    ComparisonFunction,
    TexGenMode,
    TextureCompareMode,
    TextureEnvironmentMode,
    TextureFilter,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.opengl import tokens as GL
from fixedpipe.pipeline.opengl.context import Context
from fixedpipe.pipeline.opengl.environments import environment_of
from fixedpipe.pipeline.opengl.texture_objects import Parameters
from fixedpipe.pipeline.opengl.texture_queries import (
    environment_parameter,
    generation_parameter,
    texture_parameter,
)
from fixedpipe.pipeline.opengl.texturing import (
    bound_object,
    bound_parameters,
    object_named,
    restore_parameters,
)
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.state import IDENTITY, TexGen, TextureEnvironment
from tests.pipeline.opengl.drawn import context, counted, refusals

_ENV = GL.TEXTURE_ENV
_DEFINE = {
    GL.TEXTURE_1D: "TexImage1D",
    GL.TEXTURE_2D: "TexImage2D",
    GL.TEXTURE_RECTANGLE_NV: "TexImage2D",
    GL.TEXTURE_3D: "TexImage3D",
    GL.TEXTURE_CUBE_MAP: "TexImage2D",
}


def _texture(gl, target=GL.TEXTURE_2D, number=1, internal=GL.RGBA, edge=2):
    """A complete texture of one level."""
    gl.BindTexture(target, number)
    gl.TexParameteri(target, GL.TEXTURE_MIN_FILTER, GL.NEAREST)
    faces = [target]
    if target == GL.TEXTURE_CUBE_MAP:
        faces = list(range(GL.TEXTURE_CUBE_MAP_POSITIVE_X, GL.TEXTURE_CUBE_MAP_POSITIVE_X + 6))
    axes = {GL.TEXTURE_1D: 1, GL.TEXTURE_3D: 3}.get(target, 2)
    depth = internal in (GL.DEPTH_COMPONENT16, GL.DEPTH_COMPONENT)
    image_format = GL.DEPTH_COMPONENT if depth else GL.RGBA
    for face in faces:
        size = (edge,) * axes
        define = getattr(gl, _DEFINE[target])
        define(face, 0, internal, *size, 0, image_format, GL.UNSIGNED_BYTE, None)


def _unit(gl, number=0):
    units = gl.state().texture_units
    return units[number] if number < len(units) else None


# ------------------------------------------------------------------------------------------------------ units


def test_the_highest_enabled_target_is_read():
    gl = context("GEFORCE_3")
    order = [GL.TEXTURE_1D, GL.TEXTURE_2D, GL.TEXTURE_RECTANGLE_NV, GL.TEXTURE_3D, GL.TEXTURE_CUBE_MAP]
    for number, target in enumerate(order, 1):
        _texture(gl, target, number)
        gl.Enable(target)
        assert _unit(gl).texture == f"texture {number}"
    for number, target in reversed(list(enumerate(order, 1))):
        assert _unit(gl).texture == f"texture {number}"
        gl.Disable(target)
    assert gl.state().texture_units == ()
    assert not refusals(gl)


def test_an_incomplete_texture_of_the_highest_target_disables_the_unit():
    gl = context("GEFORCE_3")
    _texture(gl)
    gl.Enable(GL.TEXTURE_2D)
    gl.Enable(GL.TEXTURE_CUBE_MAP)
    assert gl.state().texture_units == ()


def test_units_are_numbered_and_cut():
    gl = context("GEFORCE_3")
    _texture(gl)
    gl.ActiveTexture(GL.TEXTURE2)
    gl.BindTexture(GL.TEXTURE_2D, 1)
    gl.Enable(GL.TEXTURE_2D)
    gl.MatrixMode(GL.TEXTURE)
    gl.PushMatrix()
    gl.LoadMatrixf([2.0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1])
    first, second, third = gl.state().texture_units
    assert first is None
    assert second is None
    assert (third.texture, third.coordinates) == ("texture 1", 2)
    assert third.matrix == ((2.0, 0, 0, 5.0), *IDENTITY[1:])
    gl.Disable(GL.TEXTURE_2D)
    assert gl.state().texture_units == ()


def test_a_draw_with_more_units_than_the_machine_has_is_refused():
    gl = context("GEFORCE_256")
    _texture(gl)
    gl.ActiveTextureARB(GL.TEXTURE2)
    gl.BindTexture(GL.TEXTURE_2D, 1)
    gl.Enable(GL.TEXTURE_2D)
    gl.Rectf(0, 0, 1, 1)
    assert counted(gl, "refused") == [("glRectf: texture unit 2 is enabled, and GeForce 256 has 2", 1)]
    assert gl.tally.count("drawn") == 0
    gl.Disable(GL.TEXTURE_2D)
    gl.Rectf(0, 0, 1, 1)
    assert gl.tally.count("drawn") == 1


def test_default_objects_are_one_for_each_target():
    gl = context("GEFORCE_3")
    _texture(gl, GL.TEXTURE_1D, 0)
    gl.Enable(GL.TEXTURE_1D)
    assert _unit(gl).texture == "texture 0 of TEXTURE_1D"
    assert object_named(gl, "texture 0 of TEXTURE_1D") is bound_object(gl, GL.TEXTURE_1D)
    gl.Enable(GL.TEXTURE_2D)
    assert _unit(gl) is None
    _texture(gl, GL.TEXTURE_2D, 0)
    assert _unit(gl).texture == "texture 0 of TEXTURE_2D"
    gl.Rectf(-1, -1, 1, 1)
    Machine(PROFILES["GEFORCE_3"], 64, 64).run(gl.take_commands())


# ---------------------------------------------------------------------------------------------------- objects


def test_names_and_objects():
    gl = context()
    names = gl.GenTextures(3)
    assert len(set(names)) == 3
    assert 0 not in names
    assert [gl.IsTexture(name) for name in names] == [False] * 3  # until they are bound
    gl.BindTexture(GL.TEXTURE_2D, names[1])
    assert [gl.IsTexture(name) for name in (*names, 0, 99)] == [False, True, False, False, False]
    assert set(gl.GenTextures(2)).isdisjoint(names)
    gl.call("glGenTextures", [2, [70, 71]])  # as a trace has it
    gl.BindTexture(GL.TEXTURE_2D, 70)
    assert gl.AreTexturesResident(1, [70])
    gl.BindTexture(GL.TEXTURE_1D, 70)
    assert gl.error == GL.INVALID_OPERATION
    gl.DeleteTextures(2, [70, 0])
    assert gl.values["bound", GL.TEXTURE_2D, 0] == 0
    assert not gl.IsTexture(70)
    gl.BindTexture(GL.TEXTURE_1D, 70)  # a new object may have another target
    assert gl.IsTexture(70)


def test_what_objects_refuse():
    gl = context()
    gl.BindTexture(GL.TEXTURE_ENV, 1)
    gl.GenTextures(-1)
    gl.DeleteTextures(-1, [])
    gl.ActiveTexture(GL.TEXTURE0 + 8)
    gl.AreTexturesResident(1, [5])
    kinds = [what.split(", ")[0].split(": ")[1] for what, _ in counted(gl, "error")]
    assert kinds == [f"GL_INVALID_{k}" for k in ("ENUM", "VALUE", "VALUE", "ENUM", "VALUE")]


def test_objects_are_shared_by_contexts_of_a_group():
    first = context()
    second = Context(first.profile, 8, 8, shared=first.shared)
    _texture(first)
    second.BindTexture(GL.TEXTURE_2D, 1)
    second.Enable(GL.TEXTURE_2D)
    assert _unit(second).texture == "texture 1"
    first.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_WRAP_S, GL.CLAMP)
    assert _unit(second).sampler.wrap_s is WrapMode.CLAMP
    first.TexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, 0, 0, 0, GL.RGBA, GL.UNSIGNED_BYTE, None)
    assert _unit(second) is None


# ------------------------------------------------------------------------------------------------- parameters


def _sampler(gl):
    gl.Enable(GL.TEXTURE_2D)
    return _unit(gl).sampler


def test_parameters_become_the_sampler():
    gl = context("GEFORCE_3")
    _texture(gl)
    for name, value in (
        (GL.TEXTURE_MAG_FILTER, GL.NEAREST),
        (GL.TEXTURE_WRAP_S, GL.CLAMP_TO_BORDER),
        (GL.TEXTURE_WRAP_T, GL.MIRRORED_REPEAT),
        (GL.TEXTURE_WRAP_R, GL.CLAMP),
        (GL.TEXTURE_MIN_LOD, -2000.0),
        (GL.TEXTURE_MAX_LOD, 2.5),
        (GL.TEXTURE_MAX_LEVEL, 5),
        (GL.TEXTURE_MAX_ANISOTROPY_EXT, 100.0),
        (GL.TEXTURE_COMPARE_MODE, 0x884E),
    ):
        gl.TexParameterf(GL.TEXTURE_2D, name, value)
    gl.TexParameterfv(GL.TEXTURE_2D, GL.TEXTURE_BORDER_COLOR, [0.5, 2.0, -1.0, 1.0])
    sampler = _sampler(gl)
    assert sampler.min_filter is TextureFilter.NEAREST
    assert sampler.mag_filter is TextureFilter.NEAREST
    wraps = (sampler.wrap_s, sampler.wrap_t, sampler.wrap_r)
    assert wraps == (WrapMode.CLAMP_TO_BORDER, WrapMode.MIRRORED_REPEAT, WrapMode.CLAMP)
    assert sampler.border_color == (0.5, 1.0, 0.0, 1.0)
    assert (sampler.min_lod, sampler.max_lod, sampler.max_level) == (-1000.0, 2.5, 5)
    assert sampler.max_anisotropy == 8.0
    assert sampler.compare_mode is TextureCompareMode.NONE  # colours are not compared
    gl.TexParameteriv(GL.TEXTURE_2D, GL.TEXTURE_BORDER_COLOR, [2**31 - 1, 0, -(2**31), 0])
    np.testing.assert_allclose(_sampler(gl).border_color, (1.0, 0.0, 0.0, 0.0), atol=1e-9)
    assert not refusals(gl)


@pytest.mark.parametrize("sgix", [False, True])
def test_depth_textures_are_compared(sgix):
    gl = context("GEFORCE_3")
    _texture(gl, internal=GL.DEPTH_COMPONENT16)
    assert _sampler(gl).depth_texture_mode.name == "LUMINANCE"
    if sgix:
        gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_COMPARE_SGIX, 1)
        gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_COMPARE_OPERATOR_SGIX, GL.TEXTURE_GEQUAL_R_SGIX)
    else:
        gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_COMPARE_MODE, 0x884E)
        gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_COMPARE_FUNC, GL.GEQUAL)
    sampler = _sampler(gl)
    assert sampler.compare_mode is TextureCompareMode.COMPARE_R_TO_TEXTURE
    assert sampler.compare_function is ComparisonFunction.GEQUAL
    assert texture_parameter(gl, GL.TEXTURE_2D, GL.TEXTURE_COMPARE_OPERATOR_SGIX) == GL.TEXTURE_GEQUAL_R_SGIX


@pytest.mark.parametrize(
    ("profile", "target", "name", "value"),
    [
        ("OPENGL_1_2", GL.TEXTURE_2D, GL.TEXTURE_WRAP_S, GL.CLAMP_TO_BORDER),
        ("GEFORCE_3", GL.TEXTURE_2D, GL.TEXTURE_WRAP_S, 0x8742),
        ("GEFORCE_3", GL.TEXTURE_RECTANGLE_NV, GL.TEXTURE_WRAP_S, GL.REPEAT),
        ("GEFORCE_3", GL.TEXTURE_RECTANGLE_NV, GL.TEXTURE_MIN_FILTER, GL.LINEAR_MIPMAP_LINEAR),
        ("GEFORCE_3", GL.TEXTURE_2D, GL.TEXTURE_MAG_FILTER, GL.LINEAR_MIPMAP_LINEAR),
        ("GEFORCE_3", GL.TEXTURE_2D, GL.TEXTURE_BASE_LEVEL, -1),
        ("GEFORCE_3", GL.TEXTURE_2D, GL.TEXTURE_MAX_ANISOTROPY_EXT, 0),
        ("OPENGL_1_2", GL.TEXTURE_2D, GL.TEXTURE_MAX_ANISOTROPY_EXT, 2),
        ("GEFORCE_256", GL.TEXTURE_2D, GL.TEXTURE_COMPARE_MODE, 0x884E),
        ("GEFORCE_256", GL.TEXTURE_2D, GL.DEPTH_TEXTURE_MODE, GL.LUMINANCE),
        ("GEFORCE_3", GL.TEXTURE_2D, GL.TEXTURE_COMPARE_FAIL_VALUE_ARB, 1),
        ("GEFORCE_3", GL.TEXTURE_2D, GL.TEXTURE_BORDER_COLOR, 1),
        ("GEFORCE_3", GL.TEXTURE_2D, GL.TEXTURE_ENV_MODE, GL.MODULATE),
        ("GEFORCE_3", GL.TEXTURE_CUBE_MAP_POSITIVE_X, GL.TEXTURE_WRAP_S, GL.REPEAT),
    ],
)
def test_parameters_that_the_machines_driver_refuses(profile, target, name, value):
    gl = context(profile)
    gl.TexParameterf(target, name, value)
    assert gl.error in (GL.INVALID_ENUM, GL.INVALID_VALUE)
    assert gl.tally.count("error") == 1
    for made in gl.shared.textures.values():
        assert made.parameters == type(made)(made.key, made.target).parameters


def test_anisotropy_is_left_out_where_no_machine_has_it():
    gl = context("GEFORCE_3")
    _texture(gl, GL.TEXTURE_CUBE_MAP)
    gl.TexParameterf(GL.TEXTURE_CUBE_MAP, GL.TEXTURE_MAX_ANISOTROPY_EXT, 4)
    gl.Enable(GL.TEXTURE_CUBE_MAP)
    assert _unit(gl).sampler.max_anisotropy == 1.0
    gl.Rectf(0, 0, 1, 1)
    Machine(PROFILES["GEFORCE_3"], 64, 64).run(gl.take_commands())


def test_parameters_are_saved_and_restored_by_object():
    gl = context()
    _texture(gl, number=1)
    _texture(gl, GL.TEXTURE_1D, 2)
    saved = bound_parameters(gl)
    for target in (GL.TEXTURE_2D, GL.TEXTURE_1D):
        gl.TexParameteri(target, GL.TEXTURE_WRAP_S, GL.CLAMP)
    gl.BindTexture(GL.TEXTURE_2D, 5)
    gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_WRAP_S, GL.CLAMP)
    gl.DeleteTextures(1, [2])
    restore_parameters(gl, saved)
    wraps = {key: made.parameters.wrap_s for key, made in gl.shared.textures.items() if made.parameters}
    assert (wraps[1], wraps[5]) == (GL.REPEAT, GL.CLAMP)
    assert 2 not in gl.shared.textures


def test_pushed_attributes_hold_texture_state():
    gl = context()
    _texture(gl)
    gl.Enable(GL.TEXTURE_2D)
    before = gl.state()
    gl.PushAttrib(GL.TEXTURE_BIT)
    gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_WRAP_S, GL.CLAMP)
    gl.TexEnvi(_ENV, GL.TEXTURE_ENV_MODE, GL.DECAL)
    gl.TexGeni(GL.S, GL.TEXTURE_GEN_MODE, GL.SPHERE_MAP)
    gl.Enable(GL.TEXTURE_GEN_S)
    _texture(gl, number=4)
    assert gl.state() != before
    gl.PopAttrib()
    assert gl.state() is before
    assert not refusals(gl)


# ----------------------------------------------------------------------------------------------- environments


def _environment(gl):
    gl.Enable(GL.TEXTURE_2D)
    return _unit(gl).environment


def test_environments_of_opengl_1_0():
    gl = context("GEFORCE_256")
    _texture(gl)
    assert _environment(gl) == TextureEnvironment()
    for token, mode in (
        (GL.REPLACE, "REPLACE"),
        (GL.REPLACE_EXT, "REPLACE"),
        (GL.DECAL, "DECAL"),
        (GL.BLEND, "BLEND"),
        (GL.ADD, "ADD"),
    ):
        gl.TexEnvf(_ENV, GL.TEXTURE_ENV_MODE, float(token))
        assert _environment(gl).mode.name == mode
    gl.TexEnvfv(_ENV, GL.TEXTURE_ENV_COLOR, [0.25, -1.0, 2.0, 1.0])
    assert _environment(gl).color == (0.25, 0.0, 1.0, 1.0)
    assert not refusals(gl)


@pytest.mark.parametrize("internal", [GL.ALPHA, GL.LUMINANCE, GL.LUMINANCE_ALPHA, GL.INTENSITY])
@pytest.mark.parametrize("profile", ["OPENGL_1_2", "GEFORCE_256", "GEFORCE_3"])
def test_a_decal_without_colours_passes_the_fragments_own(profile, internal):
    """As NV_texture_shader defines it."""
    gl = context(profile, 4, 4)
    _texture(gl, internal=internal)
    gl.Enable(GL.TEXTURE_2D)
    gl.TexEnvi(_ENV, GL.TEXTURE_ENV_MODE, GL.DECAL)
    gl.Color4f(1.0, 0.6, 0.2, 0.4)
    gl.Rectf(-1.0, -1.0, 1.0, 1.0)
    picture = Machine(gl.profile, 4, 4).run(gl.take_commands()).image()
    assert picture.reshape(-1, 4).tolist() == [[255, 153, 51, 102]] * 16
    gl.TexEnvi(_ENV, GL.TEXTURE_ENV_MODE, GL.MODULATE)
    assert len(gl.state().texture_units) == 1
    assert not refusals(gl)


def test_combiners_read_a_texture_whatever_its_environment():
    gl = context()
    _texture(gl, internal=GL.LUMINANCE)
    gl.Enable(GL.TEXTURE_2D)
    gl.TexEnvi(_ENV, GL.TEXTURE_ENV_MODE, GL.DECAL)
    assert gl.state().texture_units[0].environment.mode is TextureEnvironmentMode.COMBINE
    gl.Enable(GL.REGISTER_COMBINERS_NV)
    assert gl.state().texture_units[0].environment.mode is TextureEnvironmentMode.DECAL


def test_levels_are_the_nearest_integers_of_floats():
    gl = context()
    gl.TexParameterf(GL.TEXTURE_2D, GL.TEXTURE_BASE_LEVEL, 1.75)
    gl.TexParameterf(GL.TEXTURE_2D, GL.TEXTURE_MAX_LEVEL, -0.25)
    assert gl.GetTexParameteriv(GL.TEXTURE_2D, GL.TEXTURE_BASE_LEVEL) == 2
    assert gl.GetTexParameteriv(GL.TEXTURE_2D, GL.TEXTURE_MAX_LEVEL) == 0
    assert not refusals(gl)


def test_a_combine_environment():
    gl = context("GEFORCE_3")
    _texture(gl)
    gl.TexEnvi(_ENV, GL.TEXTURE_ENV_MODE, GL.COMBINE)
    assert _environment(gl) == TextureEnvironment(TextureEnvironmentMode.COMBINE)
    for name, value in (
        (GL.COMBINE_RGB, GL.INTERPOLATE),
        (GL.SOURCE0_RGB, GL.PREVIOUS),
        (GL.SOURCE1_RGB, GL.TEXTURE1),
        (GL.OPERAND0_RGB, GL.ONE_MINUS_SRC_COLOR),
        (GL.OPERAND2_RGB, GL.ONE_MINUS_SRC_ALPHA),
        (GL.RGB_SCALE, 4.0),
        (GL.COMBINE_ALPHA, GL.ADD_SIGNED),
        (GL.SOURCE1_ALPHA, GL.PRIMARY_COLOR),
        (GL.OPERAND1_ALPHA, GL.ONE_MINUS_SRC_ALPHA),
        (GL.ALPHA_SCALE, 2.0),
    ):
        gl.TexEnvf(_ENV, name, value)
        assert environment_parameter(gl, _ENV, name) == value
    rgb, alpha = _environment(gl).rgb, _environment(gl).alpha
    assert (rgb.function, rgb.scale) == (CombineFunction.INTERPOLATE, 4.0)
    assert rgb.sources == (CombineSource.PREVIOUS, CombineSource.TEXTURE1, CombineSource.CONSTANT)
    assert [operand.name for operand in rgb.operands] == [
        "ONE_MINUS_SRC_COLOR",
        "SRC_COLOR",
        "ONE_MINUS_SRC_ALPHA",
    ]
    assert (alpha.function, alpha.scale) == (CombineFunction.ADD_SIGNED, 2.0)
    assert alpha.sources[1] is CombineSource.PRIMARY_COLOR
    assert alpha.operands[1] is CombineOperand.ONE_MINUS_SRC_ALPHA
    assert not refusals(gl)


def test_combine4_has_four_arguments_in_each_half():
    gl = context("GEFORCE_256")
    _texture(gl)
    gl.TexEnvi(_ENV, GL.TEXTURE_ENV_MODE, GL.COMBINE4_NV)
    gl.TexEnvi(_ENV, GL.COMBINE_RGB, GL.ADD)
    gl.TexEnvi(_ENV, GL.SOURCE3_RGB_NV, GL.PRIMARY_COLOR)
    gl.TexEnvi(_ENV, GL.OPERAND3_RGB_NV, GL.SRC_COLOR)
    environment = _environment(gl)
    assert environment.mode is TextureEnvironmentMode.COMBINE4
    assert environment.rgb.sources[3] is CombineSource.PRIMARY_COLOR
    assert environment.alpha.sources[3] is CombineSource.ZERO
    assert environment.alpha.operands[3] is CombineOperand.ONE_MINUS_SRC_ALPHA
    gl.TexEnvi(_ENV, GL.COMBINE_ALPHA, GL.ADD)
    gl.Rectf(0, 0, 1, 1)
    Machine(PROFILES["GEFORCE_256"], 64, 64).run(gl.take_commands())


@pytest.mark.parametrize(
    ("profile", "name", "value"),
    [
        ("OPENGL_1_2", GL.TEXTURE_ENV_MODE, GL.ADD),
        ("OPENGL_1_2", GL.TEXTURE_ENV_MODE, GL.COMBINE),
        ("MULTITEXTURE", GL.TEXTURE_ENV_MODE, GL.COMBINE4_NV),
        ("GEFORCE_256", GL.COMBINE_RGB, GL.SUBTRACT),
        ("GEFORCE_3", GL.COMBINE_ALPHA, GL.DOT3_RGB),
        ("GEFORCE_3", GL.RGB_SCALE, 3),
        ("GEFORCE_3", GL.OPERAND0_ALPHA, GL.SRC_COLOR),
        ("GEFORCE_3", GL.SOURCE0_RGB, GL.TEXTURE_2D),
        ("GEFORCE_3", GL.TEXTURE_ENV_COLOR, 1),
        ("GEFORCE_3", GL.TEXTURE_WRAP_S, 1),
    ],
)
def test_environments_that_the_machines_driver_refuses(profile, name, value):
    gl = context(profile)
    gl.TexEnvi(_ENV, name, value)
    assert gl.error in (GL.INVALID_ENUM, GL.INVALID_VALUE)
    _texture(gl)
    assert _environment(gl) == TextureEnvironment()


def test_the_bias_of_the_level_of_detail_is_clamped():
    gl = context("GEFORCE_256")
    _texture(gl)
    gl.Enable(GL.TEXTURE_2D)
    for asked, held in ((1.5, 1.5), (9.0, 4.0), (-9.0, -4.0)):
        gl.TexEnvf(GL.TEXTURE_FILTER_CONTROL, GL.TEXTURE_LOD_BIAS, asked)
        assert _unit(gl).lod_bias == held
    gl.TexParameterf(GL.TEXTURE_2D, GL.TEXTURE_LOD_BIAS, 1.0)  # OpenGL 1.4: both are added
    assert _unit(gl).lod_bias == -3.0
    without = context("OPENGL_1_2")
    without.TexEnvf(GL.TEXTURE_FILTER_CONTROL, GL.TEXTURE_LOD_BIAS, 1.0)
    assert without.error == GL.INVALID_ENUM


def test_sprites_replace_coordinates_where_they_are_enabled():
    gl = context("GEFORCE_3")
    gl.ActiveTexture(GL.TEXTURE3)
    _texture(gl)
    gl.Enable(GL.TEXTURE_2D)
    gl.TexEnvi(GL.POINT_SPRITE_ARB, GL.COORD_REPLACE_ARB, 1)
    assert not _unit(gl, 3).coord_replace
    gl.Enable(GL.POINT_SPRITE_ARB)
    assert _unit(gl, 3).coord_replace


# ------------------------------------------------------------------------------------------ texture shaders


def test_a_texture_shader_says_what_a_unit_reads():
    gl = context("GEFORCE_3")
    _texture(gl, GL.TEXTURE_CUBE_MAP, 1)
    _texture(gl, GL.TEXTURE_2D, 2)
    gl.TexEnvi(GL.TEXTURE_SHADER_NV, GL.SHADER_OPERATION_NV, GL.TEXTURE_2D)
    gl.Enable(GL.TEXTURE_CUBE_MAP)
    assert _unit(gl).texture == "texture 1"
    gl.Enable(GL.TEXTURE_SHADER_NV)
    assert _unit(gl).texture == "texture 2"  # the enables do not matter
    gl.TexEnvi(GL.TEXTURE_SHADER_NV, GL.SHADER_OPERATION_NV, GL.PASS_THROUGH_NV)
    assert _unit(gl).texture is None
    gl.TexEnvi(GL.TEXTURE_SHADER_NV, GL.SHADER_OPERATION_NV, GL.NONE)
    assert _unit(gl) is None
    gl.TexEnvi(GL.TEXTURE_SHADER_NV, GL.SHADER_OPERATION_NV, GL.TEXTURE_CUBE_MAP)
    assert _unit(gl).texture == "texture 1"
    assert not refusals(gl)


def test_stages_of_incomplete_textures_are_none():
    gl = context("GEFORCE_3", 8, 8)
    _texture(gl)
    gl.TexImage2D(GL.TEXTURE_2D, 0, GL.RGBA, 1, 1, 0, GL.RGBA, GL.UNSIGNED_BYTE, bytes((1, 2, 3, 4)))
    gl.TexEnvi(_ENV, GL.TEXTURE_ENV_MODE, GL.REPLACE)
    gl.TexEnvi(GL.TEXTURE_SHADER_NV, GL.SHADER_OPERATION_NV, GL.TEXTURE_2D)
    gl.ActiveTexture(GL.TEXTURE1)
    gl.TexEnvi(GL.TEXTURE_SHADER_NV, GL.SHADER_OPERATION_NV, GL.TEXTURE_CUBE_MAP)
    gl.Enable(GL.TEXTURE_SHADER_NV)
    gl.Rectf(-1, -1, 1, 1)
    picture = Machine(PROFILES["GEFORCE_3"], 8, 8).run(gl.take_commands()).image()
    assert (picture == (1, 2, 3, 4)).all()
    assert not refusals(gl)


# ------------------------------------------------------------------------------------------------- generation


def test_generation_of_coordinates():
    gl = context("GEFORCE_256")
    _texture(gl)
    gl.Enable(GL.TEXTURE_2D)
    assert _unit(gl).gen == (TexGen(),) * 4
    gl.TexGeni(GL.S, GL.TEXTURE_GEN_MODE, GL.OBJECT_LINEAR)
    gl.TexGenfv(GL.S, GL.OBJECT_PLANE, [1, 2, 3, 4])
    gl.TexGend(GL.T, GL.TEXTURE_GEN_MODE, float(GL.SPHERE_MAP))
    gl.Translatef(0, 0, 5)
    gl.TexGendv(GL.R, GL.EYE_PLANE, [0.0, 0.0, 1.0, 0.0])
    gl.Translatef(0, 0, 5)  # the plane was transformed when it was given
    for token in (GL.TEXTURE_GEN_S, GL.TEXTURE_GEN_T, GL.TEXTURE_GEN_R):
        gl.Enable(token)
    s, t, r, q = _unit(gl).gen
    assert s == TexGen(TexGenMode.OBJECT_LINEAR, (1.0, 2.0, 3.0, 4.0))
    assert t == TexGen(TexGenMode.SPHERE_MAP)
    assert r == TexGen(TexGenMode.EYE_LINEAR, (0.0, 0.0, 1.0, -5.0))
    assert q == TexGen()
    assert generation_parameter(gl, GL.R, GL.EYE_PLANE) == (0.0, 0.0, 1.0, -5.0)
    assert not refusals(gl)


@pytest.mark.parametrize(
    ("profile", "coordinate", "mode"),
    [
        ("GEFORCE_256", GL.R, GL.SPHERE_MAP),
        ("GEFORCE_256", GL.Q, GL.REFLECTION_MAP),
        ("OPENGL_1_2", GL.S, GL.REFLECTION_MAP),
        ("GEFORCE_256", GL.S, GL.MODULATE),
        ("GEFORCE_256", GL.TEXTURE_GEN_S, GL.EYE_LINEAR),
    ],
)
def test_generation_that_opengl_refuses(profile, coordinate, mode):
    gl = context(profile)
    gl.TexGeni(coordinate, GL.TEXTURE_GEN_MODE, mode)
    assert gl.error == GL.INVALID_ENUM
    gl.TexGeni(GL.S, GL.OBJECT_PLANE, 3)
    assert gl.tally.count("error") == 2


def test_an_eye_plane_needs_an_inverse():
    gl = context()
    gl.Scalef(0, 1, 1)
    gl.TexGenfv(GL.S, GL.EYE_PLANE, [1, 0, 0, 0])
    assert counted(gl, "left out") == [("glTexGenfv: the modelview matrix has no inverse", 1)]


def test_equal_units_are_one_object():
    """A draw with the state of an earlier one finds it again, whatever was changed between."""
    gl = context()
    _texture(gl)
    gl.Enable(GL.TEXTURE_2D)
    before = gl.state()
    gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_WRAP_S, GL.CLAMP)
    gl.TexEnvi(_ENV, GL.TEXTURE_ENV_MODE, GL.REPLACE)
    assert gl.state() is not before
    gl.TexParameteri(GL.TEXTURE_2D, GL.TEXTURE_WRAP_S, GL.REPEAT)
    gl.TexEnvi(_ENV, GL.TEXTURE_ENV_MODE, GL.MODULATE)
    assert gl.state() is before
    gl.TexSubImage2D(GL.TEXTURE_2D, 0, 0, 0, 1, 1, GL.RGBA, GL.UNSIGNED_BYTE, bytes(4))
    assert gl.state() is before  # other texels, and the same state


def test_initial_parameters_are_opengls():
    gl = context("GEFORCE_3")
    assert bound_object(gl, GL.TEXTURE_2D).parameters == Parameters()
    rectangle = bound_object(gl, GL.TEXTURE_RECTANGLE_NV).parameters
    assert (rectangle.min_filter, rectangle.wrap_s) == (GL.LINEAR, GL.CLAMP_TO_EDGE)
    for name, value in (
        (GL.TEXTURE_MIN_FILTER, GL.NEAREST_MIPMAP_LINEAR),
        (GL.TEXTURE_MAX_LEVEL, 1000),
        (GL.TEXTURE_PRIORITY, 1.0),
        (GL.DEPTH_TEXTURE_MODE, GL.LUMINANCE),
        (GL.TEXTURE_COMPARE_FUNC, GL.LEQUAL),
    ):
        assert texture_parameter(gl, GL.TEXTURE_2D, name) == value
    _texture(gl, GL.TEXTURE_RECTANGLE_NV, 3, edge=3)
    gl.Enable(GL.TEXTURE_RECTANGLE_NV)
    assert object_named(gl, _unit(gl).texture).usable().target is TextureTarget.TEXTURE_RECTANGLE


@pytest.mark.parametrize(("function", "scale"), [(GL.DOT3_RGB_EXT, 1.0), (GL.DOT3_RGB_ARB, 2.0)])
def test_only_arbs_products_are_scaled(function, scale):
    gl = context()
    gl.TexEnvi(GL.TEXTURE_ENV, GL.TEXTURE_ENV_MODE, GL.COMBINE)
    gl.TexEnvi(GL.TEXTURE_ENV, GL.COMBINE_RGB, function)
    gl.TexEnvf(GL.TEXTURE_ENV, GL.RGB_SCALE, 2.0)
    held = gl.values[("environment", 0)]
    assert environment_of(held).rgb.scale == scale
