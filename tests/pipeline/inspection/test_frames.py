"""Maps and registers of whole frames say what the histories of their pixels say."""

import re
from collections import defaultdict
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fixedpipe.pipeline.commands import HostStep, TexImage
from fixedpipe.pipeline.enums import BaseFormat, Clamp, InternalFormat, TextureFilter, WrapMode
from fixedpipe.pipeline.inspection.ideal import record_ideal
from fixedpipe.pipeline.inspection.inspect import history
from fixedpipe.pipeline.inspection.maps import KINDS, frame_maps
from fixedpipe.pipeline.inspection.recording import record
from fixedpipe.pipeline.inspection.registers import register_uses
from fixedpipe.pipeline.pixel_transfer import PixelImage
from fixedpipe.pipeline.profiles import GEFORCE_3, GEFORCE_256, IDEAL, NV2A
from fixedpipe.pipeline.state import PassState, Sampler, TextureUnit
from fixedpipe.pipeline.textures.images import texture_cube_map
from fixedpipe.pipeline.validation.walk import UnsupportedState
from tests.pipeline.inspection.test_history import blended_frame, textured, triangle
from tests.support.strategies import frames

SIZE = 5  # every pixel's history is asked for
SOME = settings(max_examples=15, suppress_health_check=list(HealthCheck))


def histories(commands):
    """The history of every pixel, by (x, y)."""
    frame = record(commands, GEFORCE_256, SIZE, SIZE)
    return {(x, y): history(frame, (x, y)) for y in range(SIZE) for x in range(SIZE)}


def fragments_of(found):
    """(command's number, fragment) of a history."""
    return [(touched.number, fragment) for touched in found.touched for fragment in touched.fragments]


def clamped_in_combiners(fragment):
    """How many components general combiners clamped."""
    return sum(len(stage.clamped) for stage in fragment.stages if stage.kind.endswith("portion"))


@SOME
@given(frames(SIZE, SIZE))
@pytest.mark.filterwarnings("ignore")
def test_maps_agree_with_every_history(commands):
    overdraw, clamps = defaultdict(int), defaultdict(int)
    for (x, y), found in histories(commands).items():
        for number, fragment in fragments_of(found):
            overdraw[number, x, y] += 1
            clamps[number, x, y] += clamped_in_combiners(fragment)
    for kind, counted in (("overdraw", overdraw), ("clamps", clamps)):
        drawn = {
            (each.command, x, y): each.values[y, x]
            for each in frame_maps(commands, GEFORCE_256, SIZE, SIZE, kind)
            for y, x in np.argwhere(~np.isnan(each.values)).tolist()
        }
        assert drawn == counted


@SOME
@given(frames(SIZE, SIZE))
@pytest.mark.filterwarnings("ignore")
def test_maps_of_what_is_left_agree_with_every_history(commands):
    found, most = histories(commands), 2.0**GEFORCE_256.widest_depth - 1.0
    for kind in ("depth", "stencil"):
        for each in frame_maps(commands, GEFORCE_256, SIZE, SIZE, kind):
            assert not np.isnan(each.values).any()
            for (x, y), history_of in found.items():
                for touched in history_of.touched:
                    if touched.number == each.command:
                        left = getattr(touched.after, kind) / (most if kind == "depth" else 1.0)
                        assert each.values[y, x] == left


def test_a_map_of_errors_agrees_with_every_history():
    commands, seen = blended_frame(), 0
    frame = record(commands, GEFORCE_256, SIZE, SIZE)
    ideal = record_ideal(commands, frame, commands)
    maps = {each.command: each.values for each in frame_maps(commands, GEFORCE_256, SIZE, SIZE, "error")}
    for y, x in np.ndindex(SIZE, SIZE):
        for touched in history(frame, (x, y), ideal=ideal).touched:
            if touched.number in maps:
                machine, exact = np.array(touched.after.color[:3]) / 255, np.array(touched.ideal[:3])
                largest = 255 * np.abs(machine - np.clip(exact, 0, 1)).max()
                assert maps[touched.number][y, x] == pytest.approx(largest, abs=1e-9)
                seen += largest > 0
    assert len(maps) > 1 and seen > 5


@SOME
@given(frames(SIZE, SIZE))
@pytest.mark.filterwarnings("ignore")
def test_registers_agree_with_every_history(commands):
    held = defaultdict(list)
    for found in histories(commands).values():
        for number, fragment in fragments_of(found):
            for stage in fragment.stages:
                if stage.kind.endswith("portion"):
                    for quantity in stage.made:
                        register, _, components = quantity.name.partition(".")
                        for component, code in zip(components, quantity.codes, strict=True):
                            held[
                                number, f"general combiner {stage.number}", f"{register}.{component}"
                            ].append(code)
    uses = {
        (use.command, use.stage, use.register): use
        for use in register_uses(commands, GEFORCE_256, SIZE, SIZE)
        if use.stage.startswith("general combiner")
    }
    assert set(uses) == set(held)
    for key, codes in held.items():
        use = uses[key]
        assert (use.fragments, use.codes) == (len(codes), len(set(codes)))
        assert (255 * use.least, 255 * use.greatest) == pytest.approx((min(codes), max(codes)))
        assert 255 * use.mean == pytest.approx(np.mean(codes))


def test_the_share_that_was_clamped_is_told():
    uses = register_uses(blended_frame(), GEFORCE_256, SIZE, SIZE)
    (red,) = [use for use in uses if (use.command, use.stage, use.register) == (2, "blending", "blended.r")]
    assert (red.clamped_low, red.clamped_high, red.least, red.greatest, red.codes) == (0.0, 1.0, 1.0, 1.0, 1)
    (primary,) = [use for use in uses if (use.command, use.register) == (1, "primary color.b")]
    assert (primary.codes, primary.headroom) == (1, 1)  # a quarter of the range, and a half in bytes of 64


def test_lambda_and_primitives_are_told():
    mipmapped = TextureUnit("t", sampler=Sampler(TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.LINEAR))
    commands = (textured(mipmaps=True), triangle(PassState(texture_units=(mipmapped,))))
    (found,) = frame_maps(commands, GEFORCE_256, SIZE, SIZE, "lambda")
    known = found.values[~np.isnan(found.values)]
    assert len(np.unique(known)) == 1  # without perspective it is the same everywhere
    (found,) = frame_maps(commands, GEFORCE_256, SIZE, SIZE, "primitive")
    assert found.numbers()["greatest"] == 0.0 and found.numbers()["reached"] > 0.0
    found.values[2, 1] = 3.0
    assert found.greatest_at() == (1, 2)  # x, y


READ = re.compile(r"texel \(column (\d+), row (\d+), layer (\d+)\)")


@pytest.mark.parametrize("linear", [False, True])
def test_texels_are_read_where_histories_say(linear):
    kind = TextureFilter.LINEAR if linear else TextureFilter.NEAREST
    commands = (
        textured(),
        triangle(PassState(texture_units=(TextureUnit("t", sampler=Sampler(kind, kind)),))),
    )
    counted = np.zeros((8, 8))
    for found in histories(commands).values():
        for _, fragment in fragments_of(found):
            for quantity in (q for stage in fragment.stages for q in stage.read):
                if said := READ.fullmatch(quantity.name):
                    column, row, _ = map(int, said.groups())
                    counted[7 - row, column] += 1
    (found,) = frame_maps(commands, GEFORCE_256, SIZE, SIZE, "texels")
    assert found.label == "draw: t, unit 0, level 0" and counted.sum() >= 10
    assert (np.nan_to_num(found.values) == counted).all()
    assert (np.isnan(found.values) == (counted == 0)).all()


def test_a_border_is_no_texel():
    wide = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST, *[WrapMode.CLAMP_TO_BORDER] * 2)
    far = triangle(PassState(texture_units=(TextureUnit("t", sampler=wide),)))
    far = replace(far, mesh=replace(far.mesh, texture_coordinates=(np.full((3, 2), 3.0),)))
    (found,) = frame_maps((textured(), far), NV2A, SIZE, SIZE, "texels")
    assert found.numbers() == {"reached": 0.0}


def test_levels_and_faces_of_textures_have_maps():
    mipmapped = TextureUnit("t", sampler=Sampler(TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.LINEAR))
    commands = (textured(mipmaps=True), triangle(PassState(texture_units=(mipmapped,))))
    found = frame_maps(commands, GEFORCE_256, SIZE, SIZE, "texels")
    assert [each.values.shape for each in found] == [
        (8 >> level, 8 >> level) for level in map(int, (each.label[-1] for each in found))
    ]
    cube = TexImage(label="cube", texture="t", image=texture_cube_map(np.zeros((6, 4, 4, 3)), mipmaps=True))
    found, *_ = frame_maps((cube, commands[1]), GEFORCE_256, SIZE, SIZE, "texels")
    assert found.label.endswith("level 0") and found.values.shape == (24, 4)


@SOME
@given(frames(SIZE, SIZE))
@pytest.mark.filterwarnings("ignore")
def test_errors_of_stages_agree_with_every_history(commands):
    frame = record(commands, GEFORCE_256, SIZE, SIZE)
    if (ideal := record_ideal(commands, frame)) is None:
        return
    drawn = {(each.command, each.label): each.values for each in frame_maps(commands, *ON_SIZE, "stages")}
    told = {}
    for y, x in np.ndindex(SIZE, SIZE):
        for number, fragment in fragments_of(history(frame, (x, y), None, ideal)):
            told |= {  # later fragments' are kept
                (number, f"{commands[number].label}: {name}", x, y): error
                for name, error in errors_of(fragment).items()
            }
    for (number, label, x, y), error in told.items():
        assert drawn[number, label][y, x] == pytest.approx(error, abs=1e-6)
    assert sum(int((~np.isnan(values)).sum()) for values in drawn.values()) == len(told)


def test_a_host_step_s_commands_have_maps_of_stages():
    mapped = PassState(
        texture_units=(TextureUnit("t", sampler=Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST)),)
    )
    step = HostStep(label="step", reads=(), commands=lambda pixels: (triangle(mapped, label="issued"),))
    found = frame_maps(iter([textured(), step]), *ON_SIZE, "stages")
    assert {(each.command, each.label.split(":")[0]) for each in found} == {(2, "issued")}


ON_SIZE = GEFORCE_256, SIZE, SIZE


def test_depths_read_without_a_comparison_are_told_and_mapped():
    depths = np.random.default_rng(4).random((8, 8))
    load = TexImage(
        label="depths",
        texture="t",
        internal_format=InternalFormat.DEPTH_COMPONENT16,
        pixels=PixelImage(depths, "DEPTH_COMPONENT"),
    )
    sampler = Sampler(TextureFilter.LINEAR, TextureFilter.LINEAR, depth_texture_mode=BaseFormat.LUMINANCE)
    commands = load, triangle(PassState(texture_units=(TextureUnit("t", sampler),)))
    on = GEFORCE_3, SIZE, SIZE
    frame, seen = record(commands, *on), []
    ideal = record_ideal(commands, frame, commands)
    for y, x in np.ndindex(SIZE, SIZE):
        (touched, *_) = history(frame, (x, y), ideal=ideal).touched or [None]
        if touched is not None:
            seen.append(255 * touched.ideal[0] - touched.after.color[0])
    # A depth of 16 bits is cut to its byte, 0 to 1 less; filter, weights and product round by a half each.
    assert len(seen) > 3 and min(seen) > -2.0 and max(seen) < 3.0 and max(map(abs, seen)) > 0.0
    for kind in KINDS:
        assert frame_maps(commands, *on, kind), kind


def errors_of(fragment):
    """The greatest error of what each stage of a fragment made, by what a map calls it."""
    found = defaultdict(float)
    combined = any(stage.kind == "final combiner" for stage in fragment.stages)
    for stage in fragment.stages if combined else ():
        name = None
        if stage.kind == "texture":
            name = f"texture unit {stage.number}"
        elif stage.kind.endswith("portion"):
            name = f"general combiner {stage.number}"
        elif stage.kind == "final combiner":
            name = "final combiner"
        for quantity in stage.made if name else ():
            error = [abs(255 * (a - b)) for a, b in zip(quantity.values, quantity.ideal, strict=False)]
            if error:  # the ideal computes it as well
                found[name] = max(found[name], *error)
    return found


def test_bits_are_those_of_the_error():
    commands = blended_frame()
    for error, bits in zip(
        *(frame_maps(commands, GEFORCE_256, SIZE, SIZE, kind) for kind in ("error", "bits")), strict=True
    ):
        assert np.allclose(bits.values, np.minimum(8.0, -np.log2(np.maximum(error.values / 255.0, 1e-9))))


def test_what_there_is_not_is_refused():
    with pytest.raises(ValueError, match=f"There is no map 'nono'; there are: {', '.join(KINDS)}."):
        frame_maps((), GEFORCE_256, SIZE, SIZE, "nono")
    with pytest.raises(ValueError, match="general combiners do not clamp"):
        register_uses((), GEFORCE_256.without_clamps(Clamp.GENERAL_COMBINER), SIZE, SIZE)
    with pytest.raises(ValueError, match="execute_ideal"):
        frame_maps((), IDEAL, SIZE, SIZE, "clamps")


def test_nothing_drawn_is_no_map():
    assert frame_maps((), GEFORCE_256, SIZE, SIZE, "clamps") == ()
    assert register_uses((), GEFORCE_256, SIZE, SIZE) == ()


@given(st.sampled_from(sorted(KINDS)))
@settings(max_examples=len(KINDS))
def test_a_pbuffer_larger_than_the_window_does_no_harm(kind):
    from fixedpipe.pipeline.commands import MakeCurrent
    from fixedpipe.pipeline.profiles import NV2A

    current = MakeCurrent(label="pbuffer", surface="p", width=64, height=64)
    commands = current, triangle(), MakeCurrent(label="window"), triangle()
    if kind == "stages":
        with pytest.raises(ValueError, match="A stage has no error in a frame with pbuffers"):
            frame_maps(commands, NV2A, 8, 8, kind)
        return
    if kind in ("error", "bits"):
        with pytest.raises(UnsupportedState, match="pbuffer"):
            frame_maps(commands, NV2A, 8, 8, kind)
        return
    maps = frame_maps(commands, NV2A, 8, 8, kind)
    assert [each.command for each in maps] == ([] if kind == "texels" else [3])
