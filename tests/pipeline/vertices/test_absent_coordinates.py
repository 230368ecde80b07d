"""A coordinate set that a unit takes and a mesh lacks is OpenGL's current one, (0, 0, 0, 1)."""

import numpy as np
import pytest

from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import PrimitiveType, TexGenMode, TextureFilter
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import GEFORCE_3, PROFILES
from fixedpipe.pipeline.state import PassState, PointState, Sampler, TexGen, TextureUnit, VertexState
from fixedpipe.pipeline.textures.images import texture_2d

CORNERS = [[-1.0, -1.0, 0.0], [3.0, -1.0, 0.0], [-1.0, 3.0, 0.0]]
TEXELS = np.array([[[10, 20, 30, 255], [40, 50, 60, 255]], [[70, 80, 90, 255], [99, 0, 9, 255]]], np.uint8)
LOAD = TexImage(label="four texels", texture="four", image=texture_2d(TEXELS))
NEAREST = Sampler(min_filter=TextureFilter.NEAREST, mag_filter=TextureFilter.NEAREST)
GIVEN = [[0.0, 0.0, 0.0, 1.0]] * 3
MOVED = ((1.0, 0.0, 0.0, 0.75), (0.0, 1.0, 0.0, 0.25), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
# States whose unit takes a set that the mesh lacks, by what is made of it, and the texel that is read.
STATES = {
    "as it is": (PassState(texture_units=(TextureUnit("four", NEAREST),)), [10, 20, 30]),
    "moved by the texture matrix": (
        PassState(texture_units=(TextureUnit("four", NEAREST, matrix=MOVED),)),
        [40, 50, 60],
    ),
    "with t generated": (
        PassState(
            texture_units=(
                TextureUnit(
                    "four",
                    NEAREST,
                    gen=(TexGen(), TexGen(TexGenMode.OBJECT_LINEAR, (0, 0, 0, 0.75)), TexGen(), TexGen()),
                ),
            )
        ),
        [70, 80, 90],
    ),
    "behind a clip plane": (
        PassState(
            texture_units=(TextureUnit("four", NEAREST),), vertex=VertexState(clip_planes=((0, 0, 0, 1),))
        ),
        [10, 20, 30],
    ),
    "the second of one": (
        PassState(texture_units=(TextureUnit("four", NEAREST, coordinates=1),)),
        [10, 20, 30],
    ),
}


def bare_and_given(state):
    """Frames of a triangle without the set that the unit takes, and with (0, 0, 0, 1) in it."""
    number = state.texture_units[0].coordinates
    others = ([[0.5, 0.5]] * 3,) * number
    for sets in (others, (*others, GIVEN)):
        yield LOAD, Draw(label="a triangle", mesh=Mesh(CORNERS, texture_coordinates=sets), state=state)


@pytest.mark.parametrize("name", STATES)
@pytest.mark.parametrize(
    "profile", [p for p in PROFILES.values() if not p.arithmetic.exact], ids=lambda p: p.name
)
def test_a_machine_reads_the_texel_at_zero(profile, name):
    state, texel = STATES[name]
    bare, given = [execute(frame, profile, 4, 4).image() for frame in bare_and_given(state)]
    np.testing.assert_array_equal(bare, given)
    assert np.abs(bare[..., :3].astype(int) - texel).max() <= (7 if profile.name == "Octane" else 1)


@pytest.mark.parametrize("name", STATES)
def test_the_ideal_reads_the_texel_at_zero(name):
    state, texel = STATES[name]
    bare, given = [execute_ideal(frame, 4, 4).color for frame in bare_and_given(state)]
    np.testing.assert_array_equal(bare, given)
    np.testing.assert_allclose(bare[..., :3] * 255, np.broadcast_to(texel, (4, 4, 3)), atol=1e-9)


@pytest.mark.parametrize("engine", ["portable", "columns"])
def test_every_engine_reads_it(engine):
    for state, _ in STATES.values():
        bare, given = [execute(f, GEFORCE_3, 4, 4, engine=engine).image() for f in bare_and_given(state)]
        np.testing.assert_array_equal(bare, given)


def test_a_point_sprite_needs_no_coordinates():
    units = (None, None, None, TextureUnit("four", NEAREST, coord_replace=True))
    state = PassState(texture_units=units, point=PointState(size=4.0, sprite=True))
    point = Draw(label="a point", mesh=Mesh([[0.0, 0.0, 0.0]], PrimitiveType.POINTS), state=state)
    image = execute((LOAD, point), GEFORCE_3, 4, 4).image()
    assert image[[0, 0, 3, 3], [0, 3, 0, 3], 0].tolist() == [10, 40, 70, 99]
