"""What a driver did between OpenGL and the chip."""

from dataclasses import replace

import pytest

from fixedpipe.pipeline.enums import CombineSource, LightingArithmetic, Register
from fixedpipe.pipeline.execution.machine import Machine
from fixedpipe.pipeline.opengl import driver
from fixedpipe.pipeline.opengl import tokens as t
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.state import (
    Light,
    PassState,
    PointState,
    RegisterCombiners,
    TextureUnit,
    environment,
)
from tests.pipeline.opengl.drawn import context, refusals, textured

GEFORCE_3, GEFORCE_256 = PROFILES["GEFORCE_3"], PROFILES["GEFORCE_256"]
SPRITE = TextureUnit("flare", coord_replace=True)
PLAIN = TextureUnit("wall")


def placed(profile=GEFORCE_3, sprite=True, **state):
    return driver.place_sprite(profile, PassState(point=PointState(sprite=sprite), **state))


@pytest.mark.parametrize("unit", [0, 1, 2])
def test_a_sprite_moves_to_the_unit_that_shows_sprites(unit):
    units = (PLAIN,) * unit + (SPRITE,)
    assert placed(texture_units=units).texture_units == (*units[:unit], *(None,) * (3 - unit), SPRITE)


@pytest.mark.parametrize(
    "units",
    [(SPRITE, PLAIN), (SPRITE, None, None, PLAIN), (SPRITE, SPRITE), (None, None, None, SPRITE), (PLAIN,)],
)
def test_a_sprite_that_cannot_move_stays(units):
    assert placed(texture_units=units).texture_units == units


def test_without_sprites_no_coordinates_are_replaced():
    assert placed(sprite=False, texture_units=(SPRITE,)).texture_units == (
        replace(SPRITE, coord_replace=False),
    )
    assert placed(GEFORCE_256, texture_units=(SPRITE,)).texture_units == (
        replace(SPRITE, coord_replace=False),
    )


def test_combiners_and_environments_name_the_sprite_s_texture_by_its_new_number():
    words = ("MODULATE", "TEXTURE0", "PREVIOUS"), ("REPLACE", "TEXTURE0")
    named = replace(SPRITE, environment=environment(*words))
    found = placed(texture_units=(named,)).texture_units[3].environment
    assert found.rgb.sources == (CombineSource.TEXTURE3, CombineSource.PREVIOUS)
    assert found.alpha.sources == (CombineSource.TEXTURE3,)
    program = RegisterCombiners()
    read = replace(program.final.a, register=Register.TEXTURE0)
    portion = replace(program.general[0].rgb, a=read, cd_output=Register.TEXTURE3)
    program = replace(program, general=(replace(program.general[0], rgb=portion),))
    found = placed(texture_units=(SPRITE,), register_combiners=program).register_combiners
    assert found.general[0].rgb.a.register is Register.TEXTURE3
    assert found.general[0].rgb.cd_output is Register.TEXTURE0
    assert found.final == program.final


def test_a_sprite_of_unit_0_is_drawn():
    gl = context("GEFORCE_3", 16, 16)
    gl.PixelStorei(t.UNPACK_ALIGNMENT, 1)
    gl.TexImage2D(
        *(t.TEXTURE_2D, 0, t.RGB, 2, 2, 0, t.RGB, t.UNSIGNED_BYTE),
        bytes((255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 0)),
    )
    for name in (t.TEXTURE_MIN_FILTER, t.TEXTURE_MAG_FILTER):
        gl.TexParameteri(t.TEXTURE_2D, name, t.NEAREST)
    gl.Enable(t.TEXTURE_2D)
    gl.Enable(t.POINT_SPRITE_ARB)
    gl.TexEnvi(t.POINT_SPRITE_ARB, t.COORD_REPLACE_ARB, 1)
    gl.PointSize(8.0)
    gl.Begin(t.POINTS)
    gl.Vertex2f(0.0, 0.0)
    gl.End()
    assert refusals(gl) == []
    image = Machine(GEFORCE_3, 16, 16).run(gl.take_commands()).image()
    # The first row of texels is the upper one of a sprite.
    corners = [image[y, x, :3].tolist() for y in (5, 10) for x in (5, 10)]
    assert corners == [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 0]]


def test_texture_0_is_another_unit_s_business_where_nothing_is_a_sprite():
    gl = context("GEFORCE_3")
    textured(gl, 0)
    assert gl.state().texture_units[0].texture == "texture 1"


def test_only_a_lighting_unit_needs_directional_spotlights_as_colours():
    spot = Light(spot_cutoff=45.0, spot_exponent=3.0)
    assert driver.light(GEFORCE_256, spot) == spot
    assert driver.light(GEFORCE_3, replace(spot, position=(0.0, 0.0, 1.0, 1.0))).spot_cutoff == 45.0
    assert driver.light(GEFORCE_3, spot) == Light()  # the light shines along its axis: a factor of one
    assert GEFORCE_3.arithmetic.lighting is LightingArithmetic.LIGHTING_UNIT
    assert driver.light(GEFORCE_3, replace(spot, spot_direction=(0.0, 0.0, 1.0))).diffuse == (
        0.0,
        0.0,
        0.0,
        1.0,
    )
    half_space = replace(spot, spot_cutoff=90.0, spot_exponent=0.0, spot_direction=(1.0, 0.0, 0.0))
    assert driver.light(GEFORCE_3, half_space).diffuse == (1.0, 1.0, 1.0, 1.0)


def test_sizes_of_points():
    assert driver.point_size(GEFORCE_3, 2.49) == 2.0
    assert driver.point_parameters(GEFORCE_3, 4.0, (1.0, 0.0, 0.0), 5.0, 5.0) is None
