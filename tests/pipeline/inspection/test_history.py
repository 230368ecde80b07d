"""A pixel's history ends at the framebuffer's codes, on every engine, of every feature; beside it the guided
ideal's; and what an error is said to be made of adds up to it.
"""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from fixedpipe.pipeline.commands import Clear, Draw, HostStep, Mesh, TexImage
from fixedpipe.pipeline.enums import (
    BlendFactor,
    CombinerScale,
    ComparisonFunction,
    ComponentUsage,
    DotProductMapping,
    InternalFormat,
    Mapping,
    Register,
    TextureCompareMode,
    TextureFilter,
    TextureShaderOperation,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.framebuffers.texture_copies import depth_texture
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.inspection.history import json_schema, to_json
from fixedpipe.pipeline.inspection.ideal import record_ideal
from fixedpipe.pipeline.inspection.inspect import history, inspect
from fixedpipe.pipeline.inspection.page import history_page
from fixedpipe.pipeline.inspection.pixel import ReplayedPixel
from fixedpipe.pipeline.inspection.recording import record
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, IDEAL, INFINITE_REALITY, NV2A, PROFILES
from fixedpipe.pipeline.state import (
    Blending,
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    Light,
    Lighting,
    Material,
    PassState,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    SignedComponents,
    TextureShaderStage,
    TextureUnit,
    VertexState,
)
from fixedpipe.pipeline.textures.images import texture_2d
from tests.support.features import FEATURES, SIZE
from tests.support.strategies import frames

WIDTH, HEIGHT = 48, 40
MACHINES = [(name, p) for name, p in PROFILES.items() if not p.arithmetic.exact]
PIXELS = st.lists(
    st.tuples(st.integers(0, WIDTH - 1), st.integers(0, HEIGHT - 1)), min_size=4, max_size=4, unique=True
)
SOME = settings(max_examples=40, suppress_health_check=list(HealthCheck))


def ends_at_the_frame(frame, pixel, ideal=None):
    """The history of a pixel, once it was seen to end at what the frame holds there."""
    found, (x, y), shown = history(frame, pixel, ideal=ideal), pixel, frame.result.framebuffer
    assert found.final.color == tuple(shown.color[y, x].tolist())
    assert (found.final.depth, found.final.stencil) == (shown.depth[y, x], shown.stencil[y, x])
    for touched in found.touched:
        for fragment in touched.fragments:
            if fragment.fate == "written":
                written = fragment.stages[-1].made[0]
                assert written.name == "written"
        if touched.fragments and touched.fragments[-1].fate == "written":
            assert written.codes == touched.after.color
    return found


def errors_of(found):
    """Every Error of a history."""
    quantities = [
        quantity
        for touched in found.touched
        for fragment in touched.fragments
        for stage in fragment.stages
        for quantity in stage.made
    ]
    return [quantity.error for quantity in quantities if quantity.error is not None]


@SOME
@given(frames(WIDTH, HEIGHT), st.sampled_from([None, "portable", "columns"]), PIXELS)
@pytest.mark.filterwarnings("ignore")
def test_histories_end_at_the_framebuffer(commands, engine, pixels):
    frame = record(commands, GEFORCE_256, WIDTH, HEIGHT, engine=engine)
    for pixel in pixels:
        ends_at_the_frame(frame, pixel)


@SOME
@given(frames(32, 64, nv2a=True), PIXELS)
@pytest.mark.filterwarnings("ignore")
def test_histories_of_the_nv2a_end_at_the_framebuffer(commands, pixels):
    frame = record(commands, NV2A, 32, 64)
    for x, y in pixels:
        ends_at_the_frame(frame, (x % 32, y))


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("name", "profile"), MACHINES)
def test_every_feature_of_a_machine_can_be_looked_into(name, profile):
    for feature in FEATURES:
        if not feature.has(profile):
            continue
        commands = feature.commands(profile) if callable(feature.commands) else feature.commands
        frame = record(commands, profile, SIZE, SIZE, **feature.framebuffer)
        for surface in (None, *frame.result.surfaces):
            shown = frame.shown(surface)
            for x, y in ((0, 0), (shown.width // 2, shown.height // 2), (shown.width - 1, shown.height - 1)):
                found = history(frame, (x, y), surface)
                assert found.final.color == tuple(shown.color[y, x].tolist()), feature.name


def test_samples_are_each_told():
    commands = (Clear(label="clear", color=(0.0, 0.0, 0.0, 1.0)), triangle())
    frame = record(commands, INFINITE_REALITY, 16, 16, samples=4)
    edge = [(x, y) for y in range(16) for x in range(16) if len(set(samples(frame, x, y))) > 1]
    assert edge  # some pixel is half covered
    for pixel in edge[:4]:
        ends_at_the_frame(frame, pixel)


def samples(frame, x, y):
    """The samples of a pixel that a Draw touched."""
    return [touched.sample for touched in history(frame, (x, y)).touched if touched.kind == "Draw"]


def triangle(state=None, label="draw", colors=(1.0, 0.5, 0.25, 1.0)):
    """A Draw of a triangle over most of the window."""
    positions = np.array([[-0.9, -0.9, 0.0], [0.9, -0.8, 0.1], [-0.7, 0.9, 0.2]])
    mesh = Mesh(positions, colors=np.array([colors] * 3), texture_coordinates=(positions[:, :2] * 0.7 + 0.5,))
    return Draw(label=label, mesh=mesh, state=state or PassState())


def textured(mipmaps=False):
    """The TexImage of noise."""
    image = np.random.default_rng(3).integers(0, 256, (8, 8, 4)).astype(np.uint8)
    return TexImage(label="texture", texture="t", image=texture_2d(image, mipmaps=mipmaps))


# ------------------------------------------------------------------------------------------ the ideal


@SOME
@given(frames(WIDTH, HEIGHT), PIXELS)
@pytest.mark.filterwarnings("ignore")
def test_beside_it_stands_the_guided_ideal(commands, pixels):
    try:
        guide = execute(commands, GEFORCE_256, WIDTH, HEIGHT, record=True)
        ideal = execute_ideal(commands, WIDTH, HEIGHT, guide=guide)
    except ValueError:  # of what only machines draw
        return
    frame = record(commands, GEFORCE_256, WIDTH, HEIGHT)
    beside = record_ideal(commands, frame)
    if beside is None:
        assert frame.result.surfaces
        return
    for x, y in pixels:
        found = ends_at_the_frame(frame, (x, y), beside)
        np.testing.assert_array_equal(found.ideal, ideal.color[y, x])
        for error in errors_of(found):
            total = np.array(error.brought) + sum(map(np.array, error.added.values()))
            # float64 sums of numbers up to some thousands
            np.testing.assert_allclose(total, error.total, rtol=0, atol=1e-6)


def combiner(**fields):
    """A state whose one general combiner is this, of primary colour and constants, shown as it is."""
    stage = GeneralCombiner(rgb=RGBPortion(**fields))
    zero, one = (
        CombinerInput(Register.ZERO),
        CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT, ComponentUsage.ALPHA),
    )
    final = FinalCombiner(a=zero, b=zero, c=zero, d=CombinerInput(Register.SPARE0), g=one)
    return PassState(register_combiners=RegisterCombiners(general=(stage,), final=final))


def error_of(state, color):
    """The Error of the general combiner's red, and its stage, of a triangle of one colour."""
    found = inspect((triangle(state, colors=color),), GEFORCE_256, 16, 16, (5, 9))
    (fragment,) = found.touched[0].fragments
    (stage,) = [stage for stage in fragment.stages if stage.kind == "RGB portion"]
    return stage.made[0].error, stage, fragment


def test_a_single_rounding_is_the_roundings():
    col0 = CombinerInput(Register.PRIMARY_COLOR, Mapping.SIGNED_IDENTITY)
    # 51/255 times 51/255 is 10.2/255, and becomes 10/255.
    error, _, _ = error_of(combiner(a=col0, b=col0, sum_output=Register.SPARE0), (0.2, 0.2, 0.2, 1.0))
    assert error.added["rounding"] == pytest.approx((-0.2,) * 3, abs=1e-9)
    assert error.added["clamp"] == (0.0,) * 3
    assert error.added["mapping"] == pytest.approx((0.0,) * 3, abs=1e-9)
    assert error.brought == pytest.approx((0.0,) * 3, abs=1e-9)


def test_a_single_clamp_is_the_clamps():
    col0 = CombinerInput(Register.PRIMARY_COLOR, Mapping.SIGNED_IDENTITY)
    one = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT)
    portion = {"a": col0, "b": one, "sum_output": Register.SPARE0, "scale": CombinerScale.SCALE_BY_TWO}
    # 204/255 doubled is 408/255, and becomes 255/255.
    error, stage, fragment = error_of(combiner(**portion), (0.8, 0.8, 0.8, 1.0))
    assert error.added["clamp"] == pytest.approx((-153.0,) * 3)
    assert error.added["rounding"] == error.brought == pytest.approx((0.0,) * 3, abs=1e-9)
    assert [each.name for each in stage.clamped] == ["spare0.r", "spare0.g", "spare0.b"]
    assert fragment.stages[fragment.first_clamped] is stage
    assert fragment.stages[fragment.worst] is stage


def test_a_mappings_constant_is_the_mappings():
    expanded = CombinerInput(Register.PRIMARY_COLOR, Mapping.EXPAND_NORMAL)
    one = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT)
    # 2 c - 256 where exact numbers take 255.
    error, _, _ = error_of(combiner(a=expanded, b=one, sum_output=Register.SPARE0), (0.8, 0.8, 0.8, 1.0))
    assert error.added["mapping"] == pytest.approx((-1.0,) * 3, abs=1e-9)
    assert error.added["rounding"] == pytest.approx((0.0,) * 3, abs=1e-9)


def test_a_filters_causes_add_up():
    texture = textured()
    linear = Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR)
    draw = triangle(PassState(texture_units=(TextureUnit("t", sampler=linear),)))
    found = inspect((texture, draw), GEFORCE_256, 64, 64, (20, 40))
    (stage,) = [stage for stage in found.touched[0].fragments[0].stages if stage.kind == "texture"]
    added = stage.made[0].error.added
    assert set(added) == {"texels", "filter fraction", "rounding"}
    assert not any(added["texels"])  # bytes are what they are
    assert any(added["filter fraction"]) and any(added["rounding"])
    # Three roundings of a half each, and one to the register.
    assert max(map(abs, added["rounding"])) <= 2.0


def adds_up(error):
    """An Error's causes, which add up to its total but for the noise of float64."""
    assert np.add(error.brought, np.sum(list(error.added.values()), axis=0)) == pytest.approx(
        np.array(error.total), abs=1e-6
    )
    return error.added


def test_a_mux_is_its_branch_and_the_roundings():
    col0 = CombinerInput(Register.PRIMARY_COLOR, Mapping.SIGNED_IDENTITY)
    one = CombinerInput(Register.ZERO, Mapping.UNSIGNED_INVERT)
    # SPARE0's alpha is that of a disabled unit, 1: CD, 51/255 times 51/255.
    mux = combiner(a=one, b=one, c=col0, d=col0, mux_sum=True, sum_output=Register.SPARE0)
    error, _, _ = error_of(mux, (0.2, 0.2, 0.2, 1.0))
    assert adds_up(error)["rounding"] == pytest.approx((-0.2,) * 3, abs=1e-9)
    assert error.brought == pytest.approx((0.0,) * 3, abs=1e-9)


def test_a_lookup_of_a_texture_shader_is_off_by_its_coordinates():
    """EXPAND_NORMAL of 200 is 72/127 in the machine's dot product, and 145/255 in real numbers."""
    ramp = texture_2d(np.tile(np.arange(256, dtype=np.uint8)[:, None], (1, 1, 4)))
    linear = Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR, *(WrapMode.CLAMP_TO_EDGE,) * 2)
    dot = {"dot_product_mapping": DotProductMapping.EXPAND_NORMAL}
    state = PassState(
        texture_units=(
            TextureUnit("n"),
            TextureUnit(None, coordinates=1),
            TextureUnit("t", sampler=linear, coordinates=2),
        ),
        texture_shader=(
            TextureShaderStage(TextureShaderOperation.TEXTURE_2D),
            TextureShaderStage(TextureShaderOperation.DOT_PRODUCT, **dot),
            TextureShaderStage(TextureShaderOperation.DOT_PRODUCT_TEXTURE_2D, **dot),
        ),
        register_combiners=combiner(
            a=CombinerInput(Register.TEXTURE2), sum_output=Register.SPARE0
        ).register_combiners,
    )
    mesh = triangle(state).mesh
    sets = (mesh.texture_coordinates[0], np.array([[0.5, 0.0, 0.0]] * 3), np.zeros((3, 3)))
    draw = replace(triangle(state), mesh=replace(mesh, texture_coordinates=sets))
    stored = (
        TexImage(label="normals", texture="n", image=texture_2d(np.full((1, 1, 4), 200, np.uint8))),
        TexImage(label="ramp", texture="t", image=ramp),
    )
    found = inspect((*stored, draw), GEFORCE_3, 16, 16, (5, 9))
    stages = [s for s in found.touched[0].fragments[0].stages if s.kind == "texture shader"]
    added = adds_up(stages[2].made[1].error)
    assert list(added) == ["coordinates", "texels", "filter fraction", "rounding"]
    # 24 significant bits of the dot product, times 256 texels.
    assert added["coordinates"] == pytest.approx((256 * 0.5 * (72 / 127 - 145 / 255),) * 4, abs=1e-4)
    assert added["texels"] == (0.0,) * 4
    assert stages[2].made[1].error.brought == pytest.approx((0.0,) * 4, abs=1e-4)
    assert 0 < max(map(abs, added["filter fraction"])) <= 1 / 256 and max(map(abs, added["rounding"])) <= 1.0


def test_signed_texels_and_depth_comparisons_have_their_causes():
    linear = Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR)
    signed = replace(linear, signed_components=SignedComponents(True, True, True, True))
    compared = replace(
        linear,
        compare_mode=TextureCompareMode.COMPARE_R_TO_TEXTURE,
        compare_function=ComparisonFunction.GEQUAL,  # r is 0
    )
    depths = depth_texture(
        TextureTarget.TEXTURE_2D,
        InternalFormat.DEPTH_COMPONENT16,
        np.random.default_rng(2).integers(0, 2, (8, 8)) * 1.0,
    )
    for sampler, image in ((signed, textured().image), (compared, depths)):
        state = PassState(texture_units=(TextureUnit("t", sampler=sampler),))
        commands = (TexImage(label="t", texture="t", image=image), triangle(state))
        frame = record(commands, GEFORCE_3 if sampler is compared else NV2A, 64, 64)
        beside, caused = record_ideal(commands, frame), set()
        for x in range(14, 26):
            fragment = history(frame, (x, 40), ideal=beside).touched[0].fragments[0]
            (stage,) = [s for s in fragment.stages if s.kind == "texture"]
            added = adds_up(stage.made[0].error)
            assert max(map(abs, added["rounding"])) <= 2.5
            caused |= {cause for cause, values in added.items() if any(values)}
        assert caused == {"filter fraction", "rounding"}


def test_texels_that_were_clamped_when_they_were_stored_are_their_textures_error():
    """A table of 1.5 that a machine stores as 1, and the ideal as it is (P1 of the catalogue)."""
    linear = Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR)
    state = PassState(texture_units=(TextureUnit("t", sampler=linear),))
    stored = TexImage(label="table", texture="t", image=texture_2d(np.full((4, 4, 3), 1.0)))
    real = tuple(1.5 * level for level in stored.image.ideal)
    meant = replace(stored, image=replace(stored.image, ideal=real))
    commands = triangle(state, colors=(1.0, 1.0, 1.0, 1.0))
    found = inspect((stored, commands), GEFORCE_256, 64, 64, (20, 40), ideal=(meant, commands))
    fragment = found.touched[0].fragments[0]
    (place,) = [n for n, stage in enumerate(fragment.stages) if stage.kind == "texture"]
    error = fragment.stages[place].made[0].error
    assert error.added["texels"] == pytest.approx((-127.5,) * 4, abs=0.1) and fragment.worst == place
    assert error.brought == pytest.approx((0.0,) * 4, abs=0.1)
    # A texture of another size is another texture: what it holds is brought.
    smaller = replace(meant, image=replace(texture_2d(np.full((2, 2, 3), 1.0)), ideal=(real[0][:, :2, :2],)))
    found = inspect((stored, commands), GEFORCE_256, 64, 64, (20, 40), ideal=(smaller, commands))
    error = found.touched[0].fragments[0].stages[place].made[0].error
    assert not any(error.added["texels"]) and error.brought == pytest.approx((-127.5,) * 4, abs=0.1)


# ------------------------------------------------------------------------------------ what is written


def blended_frame():
    """A clear and two triangles, the second blended."""
    add = PassState(blending=Blending(source=BlendFactor.ONE, destination=BlendFactor.ONE))
    clear = Clear(label="a <clear>", color=(0.2, 0.2, 0.2, 1.0), depth=1.0)
    return clear, triangle(label="first"), triangle(add, "second")


def test_json_and_page_have_everything():
    found = inspect(blended_frame(), GEFORCE_256, 16, 16, (5, 9))
    text = json.dumps(to_json(found), allow_nan=False)
    read = json.loads(text)
    assert [touched["label"] for touched in read["touched"]] == ["a <clear>", "first", "second"]
    assert read["touched"][2]["fragments"][0]["stages"][-1]["made"][0]["codes"] == list(found.final.color)
    page = history_page(found, "A & B")
    assert "A &amp; B" in page and "a &lt;clear&gt;" in page and "<script" not in page
    assert "blending" in page and found._repr_html_() in page


def test_a_prompt_prints_which_pixel_it_is_and_not_all_of_it():
    found = inspect(blended_frame(), GEFORCE_256, 16, 16, (5, 9))
    assert repr(found) == (
        "<history of pixel (5, 9) on GeForce 256: 3 of 3 commands touched it, "
        f"color {found.final.color} in the end>"
    )


def test_a_blend_that_clamps_says_so():
    found = inspect(blended_frame(), GEFORCE_256, 16, 16, (5, 9))
    fragment = found.touched[2].fragments[0]
    (stage,) = [stage for stage in fragment.stages if stage.kind == "blending"]
    # 1.0 + 1.0 and 0.5 + 0.5 of bytes 255 and 128; alpha 1.0 + 1.0
    assert [(each.name, each.before, each.after) for each in stage.clamped] == [
        ("blended.r", 2.0, 1.0),
        ("blended.g", 256 / 255, 1.0),
        ("blended.a", 2.0, 1.0),
    ]


def test_what_a_host_issues_is_told():
    def again(read):
        return (triangle(label="issued"),)

    commands = (triangle(label="first"), HostStep(label="host", reads=(), commands=again))
    found = inspect(commands, GEFORCE_256, 16, 16, (5, 9))
    assert [touched.label for touched in found.touched] == ["first", "issued"]


@pytest.mark.parametrize("pixel", [(-1, 0), (16, 0), (0, 16)])
def test_a_pixel_outside_is_refused(pixel):
    with pytest.raises(ValueError, match=r"lies outside: this framebuffer is 16x16 pixels"):
        inspect((triangle(),), GEFORCE_256, 16, 16, pixel)


@pytest.mark.parametrize("pixel", [(0.5, 0), (0, float("nan")), ("1", 0), (None, 0)])
def test_a_pixel_between_pixels_is_refused(pixel):
    with pytest.raises(ValueError, match=r"The pixel's [xy] is .*; give a whole number"):
        inspect((triangle(),), GEFORCE_256, 16, 16, pixel)


def test_an_unknown_pbuffer_is_refused():
    with pytest.raises(ValueError, match="no pbuffer 'p'; there are: none"):
        inspect((triangle(),), GEFORCE_256, 16, 16, (0, 0), surface="p")


def test_another_pixel_than_the_frames_is_noticed():
    frame = record(blended_frame(), GEFORCE_256, 16, 16)
    frame.result.framebuffer.color[9, 5, 0] ^= 1
    with pytest.raises(AssertionError, match=r"Pixel \(5, 9\), BACK"):
        history(frame, (5, 9))


def test_watching_changes_nothing():
    frame = record(blended_frame(), GEFORCE_256, 16, 16)
    watched, unwatched = (ReplayedPixel(frame, 5, 9) for _ in range(2))
    told = []
    list(watched.run(lambda: lambda stage, /, **columns: told.append(stage)))
    list(unwatched.run(lambda: lambda stage, /, **columns: None))
    assert watched.value() == unwatched.value()
    assert "blending" in told


# ------------------------------------------------------------------------------------------------ vertices


def vertices_of(mesh, pixel=(3, 3), profile=GEFORCE_256, **state):
    """{name: values} of what is told of the corners of a Draw's first fragment at a pixel, and the Stage."""
    found = inspect([Draw(label="d", mesh=mesh, state=PassState(**state))], profile, 16, 16, pixel)
    stage = found.touched[0].fragments[0].stages[0]
    assert stage.title == "vertices"
    return {quantity.name: quantity.values for quantity in (*stage.read, *stage.made)}, stage


MOVED = ((1.0, 0.0, 0.0, 0.25), (0.0, 2.0, 0.0, 0.0), (0.0, 0.0, 1.0, -2.0), (0.0, 0.0, 0.0, 1.0))
SEEN = ((1.5, 0.0, 0.0, 0.0), (0.0, 1.5, 0.0, 0.0), (0.0, 0.0, -1.5, -2.5), (0.0, 0.0, -1.0, 0.0))


def test_vertices_are_told_from_object_to_window():
    corners = np.array([[-1.0, -0.5, 0.0], [1.0, -0.5, 0.25], [-1.0, 0.5, 0.5]])
    mesh = Mesh(corners, colors=[[0.5, 0.25, 2.0]] * 3, texture_coordinates=([[0.5], [0.25], [0.75]],))
    told, stage = vertices_of(mesh, (5, 7), vertex=VertexState(MOVED, SEEN))
    assert stage.says == ""
    for k, corner in enumerate(corners):
        eye = np.array(MOVED) @ [*corner, 1.0]
        clip = np.array(SEEN) @ eye
        assert told[f"vertex {k}: object coordinates"] == tuple(corner)
        np.testing.assert_allclose(told[f"vertex {k}: eye coordinates"], eye, rtol=1e-15)
        np.testing.assert_allclose(told[f"vertex {k}: clip coordinates"], clip, rtol=1e-15)
        np.testing.assert_allclose(told[f"vertex {k}: window z"], clip[2] / clip[3] / 2 + 0.5, rtol=1e-15)
        assert told[f"vertex {k}: lit color"] == (0.5, 0.25, 1.0, 1.0)  # clamped to [0, 1]
        assert told[f"vertex {k}: color"] == (0.5, 0.25, 2.0)
        assert told[f"vertex {k}: coordinate set 0"] == (mesh.texture_coordinates[0][k, 0],)


def test_eye_coordinates_are_weighted_and_weights_told():
    corners = np.array([[-1.0, -0.5, 0.0], [1.0, -0.5, 0.25], [-1.0, 0.5, 0.5]])
    still = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, -2.0), (0.0, 0.0, 0.0, 1.0))
    vertex = VertexState(MOVED, SEEN, modelview1=still)
    told, _ = vertices_of(Mesh(corners, weights=[0.5, 1.0, 0.25]), (5, 7), vertex=vertex)
    for k, (corner, weight) in enumerate(zip(corners, (0.5, 1.0, 0.25), strict=True)):
        eye = weight * (np.array(MOVED) @ [*corner, 1.0]) + (1 - weight) * (np.array(still) @ [*corner, 1.0])
        assert told[f"vertex {k}: weight"] == (weight,)
        np.testing.assert_allclose(told[f"vertex {k}: eye coordinates"], eye, rtol=1e-15)
        np.testing.assert_allclose(told[f"vertex {k}: clip coordinates"], np.array(SEEN) @ eye, rtol=1e-15)
    told, _ = vertices_of(Mesh(corners), (5, 7), vertex=vertex)
    np.testing.assert_allclose(told["vertex 0: eye coordinates"], np.array(MOVED) @ [*corners[0], 1.0])


def test_lit_colors_are_those_of_lighting():
    light = Light(diffuse=(0.5, 0.5, 0.5, 1.0))
    mesh = Mesh([[-1, -1], [3, -1], [-1, 3]], normals=[[0, 0, 1], [0, 0, 1], [0.6, 0, 0.8]])
    material = Material(diffuse=(1.0, 0.0, 1.0, 1.0), ambient=(0.0, 0.0, 0.0, 1.0))
    lighting = Lighting(lights=(light,), front=material, model_ambient=(0.0, 0.0, 0.0, 1.0))
    told, _ = vertices_of(mesh, vertex=VertexState(lighting=lighting))
    for vertex, full in ((0, 1.0), (1, 1.0), (2, 0.8)):
        expected = (0.5 * full, 0.0, 0.5 * full, 1.0)
        np.testing.assert_allclose(told[f"vertex {vertex}: lit color"], expected, rtol=1e-12)
        assert told[f"vertex {vertex}: normal"] == tuple(mesh.normals[vertex])


def test_vertices_that_clipping_made_are_told_as_such():
    told, stage = vertices_of(Mesh([[-1, -1, 0], [3, -1, 0], [-1, 3, -3]]), (2, 13))
    assert stage.says.startswith("made by clipping, as their numbers say: 3")
    assert not any("object" in name or "clip coordinates" in name for name in told)
    assert all(told[name] == (1.0,) * 4 for name in told if name.endswith("lit color"))


# -------------------------------------------------------------------------------------------------- JSON

SCHEMA = Path(__file__).resolve().parents[3] / "docs" / "pixel-history.schema.json"


def test_the_published_schema_is_that_of_histories():
    assert json.loads(SCHEMA.read_text()) == json_schema()
    Draft202012Validator.check_schema(json_schema())


@pytest.mark.filterwarnings("ignore")
def test_histories_are_as_the_schema_says():
    validator, touched = Draft202012Validator(json_schema()), 0
    for feature in FEATURES:
        if not feature.has(NV2A):
            continue
        commands = feature.commands(NV2A) if callable(feature.commands) else feature.commands
        frame = record(commands, NV2A, SIZE, SIZE, **feature.framebuffer)
        both = feature.ideal and feature.has(IDEAL)
        beside = record_ideal(commands, frame, commands) if both else None
        found = history(frame, (SIZE // 2, SIZE // 2), ideal=beside)
        validator.validate(json.loads(json.dumps(to_json(found), allow_nan=False)))
        touched += len(found.touched)
    assert touched > 50


def test_the_schema_refuses_what_no_history_is():
    mesh = Mesh([[-1, -1], [3, -1], [-1, 3]])
    found = inspect([Draw(label="d", mesh=mesh, state=PassState())], GEFORCE_256, 8, 8, (3, 3))
    validator, written = Draft202012Validator(json_schema()), json.loads(json.dumps(to_json(found)))
    validator.validate(written)
    for change in ({"x": 1.5}, {"surface": 3}, {"more": 1}, {"touched": [{}]}, {"ideal": ["much"]}):
        assert not validator.is_valid(written | change)
    assert not validator.is_valid({name: value for name, value in written.items() if name != "final"})
