"""Multisampling: a window with several samples in each pixel, beside as many windows of shifted scenes."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline.commands import (
    Accum,
    BindTexImage,
    Clear,
    CopyPixels,
    CopyTexImage,
    Draw,
    DrawPixels,
    MakeCurrent,
    Mesh,
    ReadPixels,
    TexImage,
)
from fixedpipe.pipeline.enums import (
    AccumOperation,
    BlendFactor,
    ColorBuffer,
    ComparisonFunction,
    InternalFormat,
    PrimitiveType,
    StencilOperation,
    TextureFilter,
    TextureTarget,
)
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.framebuffers.multisample import SAMPLE_POSITIONS, mean
from fixedpipe.pipeline.pixel_transfer import PixelImage
from fixedpipe.pipeline.profiles import GEFORCE_256, INFINITE_REALITY, NV2A
from fixedpipe.pipeline.state import (
    Blending,
    DepthTest,
    PassState,
    RasterPosition,
    Sampler,
    StencilTest,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState
from fixedpipe.pipeline.vertices import stage
from tests.reference import multisample as reference
from tests.support.run_reference import run_reference

SIZE = 16  # a power of two: positions on the 1/16-pixel grid stay there
PICTURE = np.random.Generator(np.random.PCG64(3)).random((8, 8, 4))
TEXTURED = TextureUnit(texture="noise", sampler=Sampler(min_filter=TextureFilter.LINEAR))
STORE = TexImage(label="store", texture="noise", image=texture_2d(PICTURE))
COUNTS = [4, 8]
# Its arithmetic with windows of 8 bits, which draw faster.
MULTISAMPLED = INFINITE_REALITY.changed(color_bits=(8,))


def scene(position, seed=5, primitive=PrimitiveType.TRIANGLES):
    """Clears and draws of a scene moved so that ``position`` (1/16 pixel) lies where the middle was."""
    random = np.random.Generator(np.random.PCG64(seed))
    steps = random.integers(-40, 16 * SIZE + 40, (12, 2))  # window coordinates in 1/16 pixel
    moved = steps - np.array(position)
    positions = np.column_stack([moved / (8.0 * SIZE) - 1.0, random.uniform(-1, 1, 12)])
    mesh = Mesh(
        positions,
        primitive,
        colors=random.random((12, 4)),
        texture_coordinates=(random.uniform(-1, 2, (12, 2)),),
    )
    blending = Blending(BlendFactor.SRC_ALPHA, BlendFactor.ONE_MINUS_SRC_ALPHA)
    counted = StencilTest(depth_fail=StencilOperation.INCR, depth_pass=StencilOperation.INVERT)
    near = DepthTest(ComparisonFunction.LESS)
    return (
        STORE,
        Clear(label="clear", color=(0.2, 0.4, 0.6, 0.8), depth=0.7, stencil=3),
        Draw(label="opaque", mesh=mesh, state=PassState(depth_test=near, stencil_test=counted)),
        Draw(
            label="blended",
            mesh=replace(mesh, positions=mesh.positions * np.array([1.0, 1.0, -1.0])),
            state=PassState(texture_units=(TEXTURED,), depth_test=near, blending=blending),
        ),
    )


def averaged(images):
    """What reading samples gives, one component at a time."""
    words = zip(*(image.ravel().tolist() for image in images), strict=True)
    return np.array([reference.read(samples) for samples in words]).reshape(images[0].shape)


@pytest.mark.parametrize("primitive", [PrimitiveType.TRIANGLES, PrimitiveType.LINES, PrimitiveType.POINTS])
@pytest.mark.parametrize("count", COUNTS)
def test_it_is_the_mean_of_shifted_scenes(count, primitive):
    def drawn(position, samples):
        commands = scene(position, primitive=primitive)
        return execute(commands, MULTISAMPLED, SIZE, SIZE, samples=samples).framebuffer

    single = [drawn(position, 1) for position in SAMPLE_POSITIONS[count]]
    together = drawn((0, 0), count)
    assert np.array_equal(together.image(), averaged([f.color for f in single]))
    assert np.array_equal(together.depth, single[0].depth)
    assert np.array_equal(together.stencil, single[0].stencil)
    assert not np.array_equal(together.image(), single[0].image())


def test_buffers_of_twelve_bits_have_samples():
    single = [
        execute(scene(position), INFINITE_REALITY, SIZE, SIZE, color_bits=12).framebuffer.color
        for position in SAMPLE_POSITIONS[4]
    ]
    together = execute(
        scene((0, 0)), INFINITE_REALITY, SIZE, SIZE, color_bits=12, samples=4
    ).framebuffer.color
    assert together.max() > 255
    assert np.array_equal(together, averaged(single))


def test_a_rectangle_of_pixels_covers_every_sample():
    image = PixelImage(np.full((4, 4, 4), 0.5))
    drawn = DrawPixels(
        label="rectangle", image=image, position=RasterPosition((2.0, 2.0, 0.5, 1.0), window=True)
    )
    first = execute((edge(8.5), drawn), MULTISAMPLED, SIZE, SIZE, samples=8).image()
    assert (first[10:14, 2:6] == 128).all()
    assert (first[:, 8] == 128).all()
    copied = CopyPixels(
        label="copy", x=8, width=1, height=4, position=RasterPosition((12.0, 0.0, 0.5, 1.0), window=True)
    )
    second = execute((edge(8.5), copied), MULTISAMPLED, SIZE, SIZE, samples=8).image()
    assert (second[12:, 12] == 128).all()


@pytest.mark.parametrize("engine", [None, "portable", "columns"])
def test_both_engines_draw_the_same_samples(engine):
    first = execute(scene((0, 0)), MULTISAMPLED, SIZE, SIZE, samples=4, threads=1)
    again = execute(scene((0, 0)), MULTISAMPLED, SIZE, SIZE, samples=4, engine=engine, threads=2)
    assert np.array_equal(first.image(), again.image())


@pytest.mark.parametrize("count", COUNTS)
def test_samples_lie_where_the_specification_says(count):
    assert SAMPLE_POSITIONS[count] == reference.POSITIONS[count]
    seen = stage.process(edge(8.5).mesh, PassState(), MULTISAMPLED, SIZE, SIZE)
    for position in reference.POSITIONS[count]:
        moved = stage.process(edge(8.5).mesh, PassState(), MULTISAMPLED, SIZE, SIZE, position)
        expected = [reference.seen_from(x, y, position) for x, y in zip(seen.x, seen.y, strict=True)]
        assert list(zip(moved.x, moved.y, strict=True)) == expected


@pytest.mark.parametrize("engine", [None, "columns"])
@pytest.mark.parametrize("primitive", [PrimitiveType.TRIANGLES, PrimitiveType.LINES, PrimitiveType.POINTS])
def test_a_machine_that_shades_pixels_draws_them_by_each_samples_place(primitive, engine):
    commands = scene((0, 0), primitive=primitive)
    together = execute(commands, NV2A, SIZE, SIZE, samples=2, engine=engine).framebuffer
    apart = [run_reference(commands, NV2A, SIZE, SIZE, 24, place).target for place in reference.POSITIONS[2]]
    assert np.array_equal(together.image(), averaged([np.array(target.color) for target in apart]))
    assert np.array_equal(together.depth, np.array(apart[0].depth))
    assert SAMPLE_POSITIONS[2] == reference.POSITIONS[2]


def test_a_pbuffers_samples_lie_side_by_side_in_a_texture_of_it():
    make = MakeCurrent(label="make", surface="s", width=SIZE, height=SIZE, samples=2)
    bind = BindTexImage(label="bind", texture="t", surface="s", target=TextureTarget.TEXTURE_RECTANGLE)
    commands = (*scene((0, 0)), make, *scene((0, 0))[1:], bind)
    texels = execute(commands, NV2A, SIZE, SIZE).textures["t"].levels[0][0]
    assert texels.shape == (SIZE, 2 * SIZE, 4)
    for k, place in enumerate(reference.POSITIONS[2]):
        apart = run_reference(scene((0, 0)), NV2A, SIZE, SIZE, 24, place).target
        assert np.array_equal(texels[::-1, k::2], np.array(apart.color))


def test_a_point_covers_both_samples_of_the_pixel_whose_middle_it_holds():
    """Measured: Swath_width captures. The square's corners are the middles of four pixels; the upper left one
    is inside (N11.10).
    """
    make = MakeCurrent(label="make", surface="s", width=SIZE, height=SIZE, samples=2)
    bind = BindTexImage(label="bind", texture="t", surface="s", target=TextureTarget.TEXTURE_RECTANGLE)
    point = Draw(label="point", mesh=Mesh(np.zeros((1, 2)), PrimitiveType.POINTS), state=PassState())
    texels = execute((make, point, bind), NV2A, SIZE, SIZE).textures["t"].levels[0][0][::-1]
    middle = SIZE // 2
    assert np.argwhere(texels[..., 0]).tolist() == [
        [middle - 1, 2 * middle - 2],
        [middle - 1, 2 * middle - 1],
    ]


def test_a_pbuffer_of_several_samples_keeps_their_number_and_becomes_no_depth_texture():
    make = MakeCurrent(label="make", surface="s", width=8, height=8, samples=2)
    with pytest.raises(UnsupportedState, match="2 samples in each pixel"):
        validate((make, replace(make, samples=1)), NV2A, 8, 8, 24)
    with pytest.raises(UnsupportedState, match="3 samples in each pixel; NV2A has 1 or 2"):
        validate((replace(make, samples=3),), NV2A, 8, 8, 24)
    depths = BindTexImage(
        label="bind", texture="t", surface="s", internal_format=InternalFormat.DEPTH_COMPONENT24
    )
    with pytest.raises(UnsupportedState, match="whose colours alone become a texture"):
        validate((make, depths), NV2A, 8, 8, 24)


@pytest.mark.parametrize("count", COUNTS)
def test_no_two_samples_share_a_row_or_a_column_and_their_mean_is_the_middle(count):
    for coordinates in zip(*SAMPLE_POSITIONS[count], strict=True):
        assert len(set(coordinates)) == count
        assert sum(coordinates) == 0
        assert max(map(abs, coordinates)) < 8


def test_means_are_rounded_to_nearest():
    words = [np.array([v], np.int32) for v in (0, 1, 4095, 4095)]
    assert mean(words) == 2048  # 2047.75
    assert mean([np.array([v], np.uint8) for v in (0, 1, 0, 1)]) == 1  # a half goes up
    assert mean([np.array([v], np.int32) for v in (-3, 0, 0, 0)]) == -1


def edge(x):
    """A rectangle from the left to window x, white."""
    right = x * 2.0 / SIZE - 1.0
    corners = np.array([[-1.0, -1.0], [right, -1.0], [right, 1.0], [-1.0, 1.0]])
    return Draw(label="edge", mesh=Mesh(corners, PrimitiveType.QUADS), state=PassState())


def test_an_edge_through_a_pixels_middle_covers_half_of_its_samples():
    image = execute((edge(8.5),), MULTISAMPLED, SIZE, SIZE, samples=8).image()
    assert (image[:, :8] == 255).all()
    assert (image[:, 8] == 128).all()  # 127.5
    assert (image[:, 9:] == 0).all()


def test_what_reads_colours_reads_the_mean():
    read = ReadPixels(label="read", name="pixels", x=8, y=0, width=1, height=1)
    copy = CopyTexImage(label="copy", texture="copied", x=8, y=0, width=1, height=1)
    load = Accum(label="load", operation=AccumOperation.LOAD, value=1.0)
    wipe = Clear(label="wipe", color=(0.0, 0.0, 0.0, 0.0))
    back = Accum(label="return", operation=AccumOperation.RETURN, value=0.5)
    result = execute((edge(8.5), read, copy, load, wipe, back), MULTISAMPLED, SIZE, SIZE, samples=8)
    assert (result.pixels["pixels"] == 128).all()
    assert (result.textures["copied"].levels[0] == 128).all()
    assert (result.image()[:, :8] == 128).all()
    assert (result.image()[:, 8] == 64).all()


def test_a_pixels_samples_persist_from_run_to_run():
    # Drawn over again, an edge stays an edge; a mean drawn over would grow.
    machine = Machine(MULTISAMPLED, SIZE, SIZE, samples=8)
    for _ in range(2):
        image = machine.run((edge(8.5),)).image()
    assert (image[:, 8] == 128).all()


def test_auxiliary_buffers_have_samples_too():
    edged = edge(8.5)
    aside = replace(edged, state=replace(edged.state, draw_buffer=ColorBuffer.AUX0))
    read = ReadPixels(label="read", name="pixels", read_buffer=ColorBuffer.AUX0)
    result = execute((aside, read), MULTISAMPLED, SIZE, SIZE, samples=8)
    assert (result.pixels["pixels"][:, 8] == 128).all()
    assert (result.image() == 0).all()


def test_a_trace_shows_the_mean():
    trace = execute((edge(8.5),), MULTISAMPLED, SIZE, SIZE, samples=8, trace=True).trace
    assert (trace[0].color[:, 8] == 128).all()


def test_a_number_of_samples_that_a_machine_lacks_is_refused():
    words = "has 4 samples in each pixel; GeForce 256 has 1. Give one of these"
    with pytest.raises(UnsupportedState, match=words):
        execute((), GEFORCE_256, SIZE, SIZE, samples=4)
    with pytest.raises(UnsupportedState, match="SGI InfiniteReality has 1 or 4 or 8"):
        validate((), INFINITE_REALITY, SIZE, SIZE, samples=2)
    with pytest.raises(UnsupportedState, match="samples is 'four'; give an integer"):
        validate((), INFINITE_REALITY, SIZE, SIZE, samples="four")


def test_fragments_are_recorded_of_one_sample():
    with pytest.raises(ValueError, match="give samples=1"):
        execute((edge(8.5),), MULTISAMPLED, SIZE, SIZE, samples=4, record=True)
