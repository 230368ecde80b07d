"""Random passes, drawn here with OpenGL's rules and by Mesa: equal, or as far apart as roundings explain."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from bench.peers.mesa import PeerError
from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    BlendFactor,
    CombineFunction,
    CombineOperand,
    CombineSource,
    ComparisonFunction,
    InternalFormat,
    PrimitiveType,
    StencilOperation,
    TextureEnvironmentMode,
)
from fixedpipe.pipeline.profiles import OPENGL_1_2
from fixedpipe.pipeline.state import (
    AlphaTest,
    Blending,
    Combine,
    DepthTest,
    PassState,
    StencilTest,
    TextureEnvironment,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d
from tests.opengl.compare import compare, diamond_ties, edge_pixels, example, fold_pixels, perturbed
from tests.opengl.mesa import Mesa
from tests.opengl.passes import EXTENDED, HEIGHT, PROFILES, WIDTH, anywhere, frames, strokes


def _mesa(driver):
    try:
        return Mesa(driver)
    except PeerError as problem:
        pytest.skip(f"no Mesa to compare with: {problem}")


@pytest.fixture(scope="module")
def llvmpipe():
    peer = _mesa("llvmpipe")
    yield peer
    peer.close()


@pytest.fixture(scope="module")
def softpipe():
    peer = _mesa("softpipe")
    yield peer
    peer.close()


profiles = st.sampled_from(PROFILES)


def assert_alike(peer, commands, profile, ignored=None):
    picture = peer.draw(commands, WIDTH, HEIGHT)
    comparison = compare(commands, picture, profile, WIDTH, HEIGHT, ignored)
    assert not comparison.wrong.any(), example(commands, picture, comparison)
    return comparison


def assert_alike_off_edges(peer, commands, profile, within):
    assert_alike(peer, commands, profile, edge_pixels(commands, profile, WIDTH, HEIGHT, within))


def test_a_folded_fan_is_ordered_by_rounding_alone_on_its_fold(llvmpipe):
    """Two triangles on the same side of their common edge, whose pixels' centres lie exactly on it."""
    positions = [
        [-0.03125, 0.5625, 0.46],
        [-0.3125, 0.4375, 0.24],
        [-0.625, 0.5625, -0.33],
        [-0.9, 0.4375, 0.23],
    ]
    mesh = Mesh(np.array(positions), PrimitiveType.TRIANGLE_FAN)
    commands = (Clear(label="clear"), Draw(label="draw", mesh=mesh, state=PassState(depth_test=DepthTest())))
    folds = fold_pixels(commands, OPENGL_1_2, WIDTH, HEIGHT)
    assert np.argwhere(folds).tolist() == [[3, column] for column in range(6, 16)]
    assert_alike(llvmpipe, commands, OPENGL_1_2, folds)
    apart = replace(mesh, positions=np.array([*positions[:3], [-0.9, 0.75, 0.23]]))
    unfolded = (commands[0], replace(commands[1], mesh=apart))
    assert not fold_pixels(unfolded, OPENGL_1_2, WIDTH, HEIGHT).any()


def collapsed(commands):
    """The most triangles of a Draw that name a vertex twice; beside two of them llvmpipe may lose a third."""
    meshes = [command.mesh for command in commands if isinstance(command, Draw)]
    lists = [mesh.indices for mesh in meshes if mesh.indices is not None and mesh.counts is None]
    lists = [indices[: len(indices) - len(indices) % 3].reshape(-1, 3) for indices in lists]
    return max((sum(len(set(corners)) < 3 for corners in each.tolist()) for each in lists), default=0)


@settings(max_examples=150)
@given(st.data(), st.booleans())
def test_passes_are_llvmpipe_s(llvmpipe, data, textured):
    profile = data.draw(profiles)
    commands = data.draw(frames(profile, textured=textured))
    assume(collapsed(commands) < 2)
    assert_alike(llvmpipe, commands, profile, fold_pixels(commands, profile, WIDTH, HEIGHT))


# softpipe finds the ends of its spans in single precision: on which side of an edge a centre lies that is
# exactly on it, is luck. Source: docs/mesa.md.
@settings(max_examples=150)
@given(st.data(), st.booleans())
def test_passes_are_softpipe_s(softpipe, data, textured):
    profile = data.draw(profiles)
    commands = data.draw(frames(profile, offset=False, textured=textured))
    assert_alike_off_edges(softpipe, commands, profile, 0.0)


# A vertex that lies anywhere is snapped, to 1/16 pixel here and 1/256 there: an edge moves by less than 1/16
# in x and in y. Clipping comes before, on both sides.
@settings(max_examples=150)
@given(anywhere())
def test_coverage_is_llvmpipe_s_wherever_vertices_lie(llvmpipe, commands):
    assert_alike_off_edges(llvmpipe, commands, OPENGL_1_2, 0.1)


@settings(max_examples=150)
@given(strokes())
def test_lines_and_points_are_llvmpipe_s(llvmpipe, commands):
    assert_alike(llvmpipe, commands, OPENGL_1_2, diamond_ties(commands, OPENGL_1_2, WIDTH, HEIGHT))


@pytest.mark.slow
@settings(max_examples=2000)
@given(strokes())
def test_thousands_of_lines_and_points_are_llvmpipe_s(llvmpipe, commands):
    assert_alike(llvmpipe, commands, OPENGL_1_2, diamond_ties(commands, OPENGL_1_2, WIDTH, HEIGHT))


@pytest.mark.parametrize("end", [-1.0, 1.0])
def test_a_primitive_in_the_far_or_the_near_plane_is_not_clipped_where_depths_are_moved(end):
    """A comparison that is a tie is tried the other way by moved depths; the other Draws must stay whole."""
    positions = np.array([[-1, -1, end, 1], [1, -1, end, 1], [0, 2, 2 * end, 2]])
    state = PassState(
        stencil_test=StencilTest(function=ComparisonFunction.NEVER, fail=StencilOperation.ZERO),
        depth_test=DepthTest(function=ComparisonFunction.NEVER, write=False),
    )
    (moved,) = perturbed(
        (Draw(label="in the plane", mesh=Mesh(positions), state=state),), (0,), end, None, (0.0, 0.0)
    )
    np.testing.assert_array_equal(moved.mesh.positions, positions)


@pytest.mark.slow
@pytest.mark.parametrize("textured", [False, True])
@settings(max_examples=3000)
@given(st.data())
def test_thousands_of_passes_are_llvmpipe_s(llvmpipe, textured, data):
    profile = data.draw(profiles)
    commands = data.draw(frames(profile, textured=textured))
    assume(collapsed(commands) < 2)
    assert_alike(llvmpipe, commands, profile, fold_pixels(commands, profile, WIDTH, HEIGHT))


@pytest.mark.slow
@pytest.mark.parametrize("textured", [False, True])
@settings(max_examples=1000)
@given(st.data())
def test_thousands_of_passes_are_softpipe_s(softpipe, textured, data):
    profile = data.draw(profiles)
    commands = data.draw(frames(profile, offset=False, textured=textured))
    assert_alike_off_edges(softpipe, commands, profile, 0.0)


def test_a_signed_sum_of_bytes_lies_between_two_bytes(llvmpipe):
    """(1 - t) + t - 1/2 is one half: 127 here, where one half is 128/255, and 128 of llvmpipe."""
    arguments = (CombineSource.PRIMARY_COLOR,) * 2
    operands = CombineOperand.ONE_MINUS_SRC_ALPHA, CombineOperand.SRC_ALPHA
    signed = Combine(CombineFunction.ADD_SIGNED, arguments, operands)
    environment = TextureEnvironment(TextureEnvironmentMode.COMBINE, rgb=signed, alpha=signed)
    units = (TextureUnit("texture", environment=environment),)
    image = texture_2d(np.full((1, 1, 4), 255, np.uint8), InternalFormat.RGBA8)
    mesh = Mesh(np.array([[-1, -1, 0], [3, -1, 0], [-1, 3, 0]]), colors=np.full((3, 4), 67 / 255))
    mesh = replace(mesh, texture_coordinates=(np.zeros((3, 2)),))
    commands = (
        TexImage(label="texture", texture="texture", image=image),
        Clear(label="clear"),
        Draw(label="draw", mesh=mesh, state=PassState(texture_units=units)),
    )
    comparison = assert_alike(llvmpipe, commands, EXTENDED)
    assert (comparison.differences == 1).all()


@pytest.mark.slow
@settings(max_examples=2000)
@given(anywhere())
def test_thousands_of_meshes_cover_what_llvmpipe_covers(llvmpipe, commands):
    assert_alike_off_edges(llvmpipe, commands, OPENGL_1_2, 0.1)


def test_softpipe_s_alpha_may_lie_beside_its_vertices_one_alpha(softpipe):
    """Where w varies, softpipe's alpha is a last place beside the vertices', so that rows of LESS pass."""
    positions = np.array([[4.0, -4.0, 4.0, 4.0], [-0.25, -4.0, 4.0, 4.0], [0.9375, 0.25, 1.0, 1.0]])
    mesh = Mesh(positions, colors=np.full((3, 4), 1 / 255.0), secondary_colors=np.zeros((3, 3)))
    state = PassState(alpha_test=AlphaTest(ComparisonFunction.LESS, 1 / 255.0))
    commands = (Clear(label="clear"), Draw(label="draw", mesh=mesh, state=state))
    assert assert_alike(softpipe, commands, OPENGL_1_2).undecided.any()


def test_llvmpipe_loses_a_triangle_beside_two_that_are_none(llvmpipe):
    """Of three vertices in another order nothing is lost, and softpipe draws them all."""
    positions = np.array([[1.75, 4.0, 2.0, 4.0], [0.40625, 0.0, 0.25, 0.5], [0.9375, 1.0, 0.5, 1.0]])

    def drawn(*indices):
        mesh = Mesh(positions, indices=np.array(indices), colors=np.ones((3, 4)))
        commands = Clear(label="clear"), Draw(label="draw", mesh=mesh, state=PassState())
        picture = llvmpipe.draw(commands, WIDTH, HEIGHT)
        return collapsed(commands), compare(commands, picture, OPENGL_1_2, WIDTH, HEIGHT).wrong.any()

    assert drawn(2, 1, 0) == (0, False)
    assert drawn(2, 1, 0, 2, 2, 0) == (1, False)
    assert drawn(2, 1, 0, 2, 2, 0, 2, 2, 0) == (2, True)


# -------------------------------------------------------------------------------------- does it see anything?

_CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0]])
_GRAY = np.full((3, 4), 100 / 255.0)


@pytest.mark.parametrize(
    ("drawn", "meant"),
    [
        pytest.param(
            PassState(stencil_test=StencilTest(depth_pass=StencilOperation.INCR)),
            PassState(stencil_test=StencilTest(depth_pass=StencilOperation.INVERT)),
            id="another stencil operation",
        ),
        pytest.param(
            PassState(blending=Blending(BlendFactor.ONE, BlendFactor.ONE)),
            PassState(blending=Blending(BlendFactor.ONE, BlendFactor.ONE_MINUS_SRC_ALPHA)),
            id="another blend factor",
        ),
        pytest.param(
            PassState(), PassState(blending=Blending(BlendFactor.ONE, BlendFactor.ONE)), id="two more"
        ),
    ],
)
def test_the_comparison_sees(llvmpipe, drawn, meant):
    clear = Clear(label="clear", color=(40 / 255.0,) * 4, depth=1.0, stencil=3)
    mesh = Mesh(_CORNERS, colors=_GRAY, secondary_colors=np.zeros((3, 3)))
    here, there = ((clear, Draw(label="draw", mesh=mesh, state=state)) for state in (drawn, meant))
    comparison = compare(here, llvmpipe.draw(there, WIDTH, HEIGHT), EXTENDED, WIDTH, HEIGHT)
    assert comparison.wrong.sum() > 100
    assert not compare(there, llvmpipe.draw(there, WIDTH, HEIGHT), EXTENDED, WIDTH, HEIGHT).wrong.any()


@pytest.mark.parametrize("blending", [None, Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE_MINUS_SRC_ALPHA)])
def test_the_comparison_sees_one_pixel_two_bytes_off(llvmpipe, blending):
    mesh = Mesh(_CORNERS, colors=_GRAY, secondary_colors=np.zeros((3, 3)))
    commands = (Draw(label="draw", mesh=mesh, state=PassState(blending=blending)),)
    picture = llvmpipe.draw(commands, WIDTH, HEIGHT)
    color = picture["color"].copy()
    color[-1, 0] += 2
    assert compare(commands, {**picture, "color": color}, OPENGL_1_2, WIDTH, HEIGHT).wrong.sum() == 1
