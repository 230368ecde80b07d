"""Whole random frames: the machine equals the executable specification, whatever its batches and threads."""

import hashlib
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    ColorWeights,
    ComponentUsage,
    DepthFormat,
    FogArithmetic,
    LineRasterization,
    MagnificationThreshold,
    Mapping,
    ProductRounding,
    Register,
    TextureFilter,
)
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import GEFORCE_256, NV2A
from fixedpipe.pipeline.state import (
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    LineState,
    PassState,
    PolygonState,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d
from tests.support.run_reference import run_reference
from tests.support.strategies import frames, seeds, shaded_frame, stroked_frame, textured_frame

WIDTH, HEIGHT = 16, 8  # powers of two: vertices on pixel centers and corners stay there exactly

# A machine that no one built: every arithmetic field that a profile has, with eight general combiners.
machines = st.builds(
    lambda **fields: GEFORCE_256.changed(
        max_general_combiners=8,
        per_stage_constants=True,
        blue_to_alpha=True,
        combiner_flags=True,
        ycbcr_conversion=True,
        blend_equations=NV2A.fragments.blend_equations,
        surface_formats=NV2A.framebuffers.surface_formats,
        depth_bits=tuple(DepthFormat),
        depth_clamp=True,
        w_buffering=True,
        **fields,
    ),
    expand_half=st.sampled_from((128, 127.5)),
    product_rounding=st.sampled_from(ProductRounding),
    round_before_scale=st.booleans(),
    clamp_low=st.sampled_from((-256, -255)),
    magnification_threshold=st.sampled_from(MagnificationThreshold),
    fog_arithmetic=st.sampled_from(FogArithmetic),
    color_weights=st.sampled_from(ColorWeights),
)


def assert_equal_to_reference(commands, profile, depth_bits, batch):
    result = execute(commands, profile, WIDTH, HEIGHT, depth_bits=depth_bits, threads=1, batch=batch)
    expected = run_reference(commands, profile, WIDTH, HEIGHT, depth_bits)
    assert result.surfaces.keys() == expected.surfaces.keys()
    targets = [(result.framebuffer, expected.target)]
    targets += [(result.surfaces[name], expected.surfaces[name]) for name in expected.surfaces]
    for machine, target in targets:
        for name in ("stencil", "depth", "color"):
            np.testing.assert_array_equal(
                getattr(machine, name), np.array(getattr(target, name)), err_msg=name
            )
    for name, texture in expected.textures.items():
        for level, texels in zip(result.textures[name].levels, texture.levels, strict=True):
            np.testing.assert_array_equal(level, np.array(texels), err_msg=name)
    for name, pixels in expected.pixels.items():
        got = result.pixels[name]
        np.testing.assert_array_equal(got, np.array(pixels).reshape(got.shape), err_msg=name)


batches = st.sampled_from((16, 17, 64, 256))
depths = st.sampled_from(GEFORCE_256.framebuffers.depth_bits)
depth_formats = st.sampled_from(DepthFormat)


@settings(max_examples=250)
@given(frames(WIDTH, HEIGHT), depths, batches)
def test_the_machine_equals_the_specification(commands, depth_bits, batch):
    assert_equal_to_reference(commands, GEFORCE_256, depth_bits, batch)


@settings(max_examples=100)
@given(frames(WIDTH, HEIGHT, 8, True), machines, depth_formats, batches)
def test_other_machines_equal_the_specification(commands, profile, depth_bits, batch):
    assert_equal_to_reference(commands, profile, depth_bits, batch)


@settings(max_examples=300)
@given(seeds, batches)
def test_every_sampler_on_any_mesh_equals_the_specification(seed, batch):
    assert_equal_to_reference(textured_frame(seed, WIDTH, HEIGHT), GEFORCE_256, 24, batch)


@settings(max_examples=300)
@given(seeds, depths, batches)
def test_every_shading_of_any_mesh_equals_the_specification(seed, depth_bits, batch):
    assert_equal_to_reference(shaded_frame(seed, WIDTH, HEIGHT), GEFORCE_256, depth_bits, batch)


@settings(max_examples=300)
@given(seeds, depths, batches)
def test_every_point_line_and_outline_equals_the_specification(seed, depth_bits, batch):
    assert_equal_to_reference(stroked_frame(seed, WIDTH, HEIGHT), NV2A, depth_bits, batch)


def smoothed(commands, lines=True, polygons=True):
    """The same frame with smooth lines and polygons."""
    for command in commands:
        if isinstance(command, Draw):
            state = command.state
            line = LineState(state.line.width, LineRasterization.RECTANGLE, smooth=lines)
            polygon = replace(state.polygon, smooth=polygons)
            command = replace(command, state=replace(state, line=line, polygon=polygon))
        yield command


@settings(max_examples=150)
@given(seeds, depths, batches)
def test_smooth_lines_and_outlines_equal_the_specification(seed, depth_bits, batch):
    assert_equal_to_reference(tuple(smoothed(stroked_frame(seed, WIDTH, HEIGHT))), NV2A, depth_bits, batch)


@settings(max_examples=150)
@given(seeds, depths, batches)
def test_smooth_polygons_equal_the_specification(seed, depth_bits, batch):
    assert_equal_to_reference(tuple(smoothed(shaded_frame(seed, WIDTH, HEIGHT))), NV2A, depth_bits, batch)


@settings(max_examples=100)
@given(seeds, st.sampled_from((stroked_frame, shaded_frame, textured_frame)))
def test_the_column_engine_draws_smooth_primitives_alike(seed, frame):
    commands = tuple(smoothed(frame(seed, WIDTH, HEIGHT)))
    first = execute(commands, NV2A, WIDTH, HEIGHT, threads=1).framebuffer
    again = execute(commands, NV2A, WIDTH, HEIGHT, threads=1, engine="columns").framebuffer
    for name in ("stencil", "depth", "color"):
        np.testing.assert_array_equal(getattr(first, name), getattr(again, name), err_msg=name)


def test_a_smooth_triangles_alpha_is_the_share_of_eight_samples():
    # Right of x = 4 5/16 and above y = 4 3/4, as 3D_primitive's first triangle has its edges.
    corners = np.array([(4.3125, 8.0), (4.3125, -40.0), (64.0, 8.0)]) / (WIDTH / 2, HEIGHT / 2) - 1
    mesh = Mesh(np.column_stack([corners, np.zeros(3)]), colors=np.ones((3, 4)))
    state = PassState(polygon=PolygonState(smooth=True))
    image = execute((Draw(label="edge", mesh=mesh, state=state),), NV2A, WIDTH, HEIGHT).image()
    assert image[2, 3, 3] == 0
    assert image[2, 4, 3] == 255 * 5 // 8
    assert image[2, 5, 3] == 255


def stippled_frame(seed):
    """The same, all lines in steps, most of them stippled."""
    random = np.random.default_rng(seed)
    *before, draw = stroked_frame(seed, WIDTH, HEIGHT)
    pattern = int(random.integers(1 << 16)), (int(random.choice([1, 2, 3, 256])))
    line = replace(
        draw.state.line,
        rasterization=LineRasterization.STEPS,
        stipple=pattern[::-1] if random.random() < 0.7 else None,
    )
    return (*before, replace(draw, state=replace(draw.state, line=line)))


# Lines by diamonds and colours: all pairs that a machine may have.
line_machines = st.sampled_from(
    [
        NV2A.changed(diamond_exit_lines=True, color_weights=ColorWeights.EXACT),
        NV2A,
        NV2A.changed(color_weights=ColorWeights.EXACT),
    ]
)


@settings(max_examples=150)
@given(seeds, line_machines, batches)
def test_lines_by_diamonds_and_stippled_ones_equal_the_specification(seed, profile, batch):
    assert_equal_to_reference(stippled_frame(seed), profile, 24, batch)


@pytest.mark.slow
@settings(max_examples=5000)
@given(seeds, line_machines, batches)
def test_thousands_of_stippled_lines_equal_the_specification(seed, profile, batch):
    assert_equal_to_reference(stippled_frame(seed), profile, 24, batch)


@pytest.mark.slow
@settings(max_examples=5000)
@given(seeds, batches)
def test_thousands_of_samplers_equal_the_specification(seed, batch):
    assert_equal_to_reference(textured_frame(seed, WIDTH, HEIGHT), GEFORCE_256, 24, batch)


@pytest.mark.slow
@settings(max_examples=3000)
@given(frames(WIDTH, HEIGHT), depths, batches)
def test_thousands_of_states_equal_the_specification(commands, depth_bits, batch):
    assert_equal_to_reference(commands, GEFORCE_256, depth_bits, batch)


@pytest.mark.slow
@settings(max_examples=1000)
@given(frames(WIDTH, HEIGHT, 8, True), machines, depth_formats, batches)
def test_thousands_of_other_machines_equal_the_specification(commands, profile, depth_bits, batch):
    assert_equal_to_reference(commands, profile, depth_bits, batch)


def test_the_mux_reads_texture_0_though_no_input_names_it():
    one = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT)
    mux = RGBPortion(
        b=one, c=CombinerInput(Register.CONSTANT_COLOR0), d=one, sum_output=Register.SPARE1, mux_sum=True
    )
    final = FinalCombiner(
        a=CombinerInput(),
        b=CombinerInput(),
        c=CombinerInput(Register.SPARE1),
        g=CombinerInput(Register.PRIMARY_COLOR, usage=ComponentUsage.ALPHA),
    )
    combiners = RegisterCombiners((GeneralCombiner(mux),), final, constant_color0=(0.0, 1.0, 0.0, 0.0))
    nearest = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST)
    state = PassState(texture_units=(TextureUnit("mask", nearest),), register_combiners=combiners)
    corners = np.array([[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]])
    mask = texture_2d(np.array([[[9, 9, 9, 0], [9, 9, 9, 255]]], np.uint8))
    commands = (
        TexImage(label="mask", texture="mask", image=mask),
        Draw(label="select", mesh=Mesh(corners, texture_coordinates=(corners,)), state=state),
    )
    assert_equal_to_reference(commands, GEFORCE_256, 24, 256)


def test_the_final_combiner_has_its_own_constants_beside_a_single_stage_s():
    profile = GEFORCE_256.changed(per_stage_constants=True)
    final = FinalCombiner(
        a=CombinerInput(), b=CombinerInput(), c=CombinerInput(Register.CONSTANT_COLOR0), d=CombinerInput()
    )
    stage = GeneralCombiner(constant_color0=(1.0, 0.0, 0.0, 0.0))
    combiners = RegisterCombiners((stage,), final, constant_color0=(0.0, 1.0, 0.0, 0.0))
    corners = np.array([[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]])
    state = PassState(register_combiners=combiners)
    commands = (Draw(label="constant", mesh=Mesh(corners), state=state),)
    assert execute(commands, profile, 4, 4).framebuffer.color[0, 0, :3].tolist() == [0, 255, 0]
    assert_equal_to_reference(commands, profile, 24, 256)


def digest(framebuffer):
    buffers = (framebuffer.color, framebuffer.depth, framebuffer.stencil)
    return hashlib.sha256(b"".join(np.ascontiguousarray(b).tobytes() for b in buffers)).hexdigest()


@settings(max_examples=15)
@given(frames(160, 130), depths)
def test_neither_threads_nor_batches_change_a_bit(commands, depth_bits):
    digests = {
        digest(
            execute(commands, GEFORCE_256, 160, 130, depth_bits=depth_bits, threads=t, batch=b).framebuffer
        )
        for t, b in ((1, 256), (2, 256), (3, 16), (1, 1000))
    }
    assert len(digests) == 1
