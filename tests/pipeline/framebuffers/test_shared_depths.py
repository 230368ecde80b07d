"""Pbuffers that share the window's depths, or another pbuffer's: engines, samples, histories, refusals."""

from dataclasses import replace

import numpy as np
import pytest

from fixedpipe.pipeline.commands import BindTexImage, Clear, Draw, MakeCurrent, Mesh, ReadPixels
from fixedpipe.pipeline.description.describe import describe
from fixedpipe.pipeline.enums import (
    ComparisonFunction,
    DepthFormat,
    InternalFormat,
    PrimitiveType,
    StencilOperation,
    TextureTarget,
)
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.inspection.inspect import history, inspect
from fixedpipe.pipeline.inspection.page import history_page
from fixedpipe.pipeline.inspection.recording import record
from fixedpipe.pipeline.profiles import GEFORCE_3, NV2A, OPENGL_1_2
from fixedpipe.pipeline.state import DepthTest, PassState, Scissor, StencilTest
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState
from tests.support.run_reference import run_reference

WIDTH, HEIGHT = 12, 8
WINDOW = MakeCurrent(label="window")
NEARER = PassState(
    depth_test=DepthTest(ComparisonFunction.LESS),
    stencil_test=StencilTest(depth_pass=StencilOperation.INCR, depth_fail=StencilOperation.INVERT),
)


def sharing(name="s", width=7, height=5, **fields):
    return MakeCurrent(label=name, surface=name, width=width, height=height, shares_depth=True, **fields)


def own(name="p", width=9, height=6, **fields):
    return MakeCurrent(label=name, surface=name, width=width, height=height, **fields)


def slope(z0, z1, color, **state):
    """Whole target, depth from ``z0`` at the left to ``z1`` at the right."""
    corners = [[-1, -1, z0], [1, -1, z1], [1, 1, z1], [-1, 1, z0]]
    mesh = Mesh(corners, PrimitiveType.QUADS, colors=[color] * 4)
    return Draw(label="slope", mesh=mesh, state=replace(NEARER, **state))


RED, GREEN, BLUE = (1.0, 0.0, 0.0, 1.0), (0.0, 1.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0)
CLEARED = Clear(label="clear", color=(0.0,) * 4, depth=0.75, stencil=3)
# There and back, smaller and larger targets, clears of parts, two owners, and both kinds in between.
FRAME = (
    CLEARED,
    slope(-0.8, 0.8, RED),
    sharing(),
    slope(0.8, -0.8, GREEN),
    Clear(label="part", depth=0.25, stencil=200, scissor=Scissor(1, 0, 2, 3), stencil_write_mask=0xF0),
    ReadPixels(label="read", name="depths", format="DEPTH_COMPONENT"),
    WINDOW,
    slope(0.1, 0.1, BLUE),
    sharing("t", 12, 3),
    slope(-0.9, 0.9, RED),
    own(),
    CLEARED,
    sharing("u", 4, 6, depth_of="p"),
    slope(0.3, 0.3, GREEN),
    sharing(),
    slope(-0.2, -0.4, BLUE),
    own(),
    slope(0.2, 0.2, RED),
)


def assert_as_specified(result, commands=FRAME, profile=NV2A, depth_bits=24):
    expected = run_reference(commands, profile, WIDTH, HEIGHT, depth_bits)
    pairs = [(result.framebuffer, expected.target)]
    pairs += [(result.surfaces[name], target) for name, target in expected.surfaces.items()]
    for found, target in pairs:
        for plane in ("color", "depth", "stencil"):
            rows = [row[: target.width] for row in getattr(target, plane)]
            np.testing.assert_array_equal(getattr(found, plane), np.array(rows))
    for name, pixels in expected.pixels.items():
        assert result.pixels[name].tolist() == [row[: result.pixels[name].shape[1]] for row in pixels]


@pytest.mark.parametrize("depth_bits", [16, 24, DepthFormat.FLOAT_24])
@pytest.mark.parametrize("engine", [None, "portable", "columns"])
@pytest.mark.parametrize("profile", [NV2A, GEFORCE_3], ids=lambda p: p.name)
def test_every_engine_equals_the_specification(profile, engine, depth_bits):
    def of(command):
        made = isinstance(command, MakeCurrent) and command.surface is not None
        return replace(command, depth_bits=int(depth_bits)) if made else command

    frame = tuple(map(of, FRAME))
    result = execute(frame, profile, WIDTH, HEIGHT, depth_bits=int(depth_bits), engine=engine, threads=2)
    if depth_bits == DepthFormat.FLOAT_24:  # the specification has fixed depths
        plain = execute(frame, profile, WIDTH, HEIGHT, depth_bits=int(depth_bits), threads=1)
        for name, made in [*result.surfaces.items(), (None, result.framebuffer)]:
            other = plain.framebuffer if name is None else plain.surfaces[name]
            assert (made.depth == other.depth).all() and (made.color == other.color).all()
            owner = {None: None, "p": "p", "u": "p"}.get(name)
            whole = result.framebuffer if owner is None else result.surfaces[owner]
            assert (made.depth == whole.depth[: made.height, : made.width]).all()
        return
    assert_as_specified(result, frame, profile, depth_bits)


def test_what_is_shared_is_shared_in_later_runs_and_at_once():
    machine, pixels = Machine(NV2A, WIDTH, HEIGHT, threads=1), {}
    for number, command in enumerate(FRAME):
        # Each run begins with the window.
        current = [c for c in FRAME[:number] if isinstance(c, MakeCurrent)][-1:]
        result = machine.run((*current, command))
        pixels |= result.pixels
    assert_as_specified(replace(result, pixels=pixels))


def test_the_window_and_every_sharer_have_the_same_words_in_the_end():
    result = execute(FRAME, NV2A, WIDTH, HEIGHT)
    for name, owner in (("s", result.framebuffer), ("t", result.framebuffer), ("u", result.surfaces["p"])):
        made = result.surfaces[name]
        both = slice(made.height), slice(made.width)
        assert (made.depth == owner.depth[both]).all() and (made.stencil == owner.stencil[both]).all()
    assert len(np.unique(result.framebuffer.depth)) > WIDTH  # more than one slope's
    assert len(np.unique(result.framebuffer.stencil)) > 4


def test_a_texture_of_shared_depths_has_what_the_owner_s_draws_left():
    bind = BindTexImage(
        label="bind", texture="t", surface="s", internal_format=InternalFormat.DEPTH_COMPONENT24,
        target=TextureTarget.TEXTURE_RECTANGLE,
    )  # fmt: skip
    commands = (CLEARED, sharing(), WINDOW, slope(-0.5, 0.2, RED), bind)
    result = execute(commands, NV2A, WIDTH, HEIGHT, threads=1)
    words = result.textures["t"].levels[0].view("<u4")[0, ..., 0]
    assert (words == result.framebuffer.depth[:5, :7][::-1]).all()
    expected = run_reference(commands, NV2A, WIDTH, HEIGHT, 24).textures["t"].levels[0]
    assert result.textures["t"].levels[0].tolist() == expected


def test_every_sample_is_shared():
    """Each sample is drawn as a frame of its own, with its place."""
    edge = Mesh([[-1, -1, -0.5], [0.97, -1, 0.4], [-1, 0.9, 0.1]], PrimitiveType.TRIANGLES)
    part = Draw(label="part", mesh=edge, state=NEARER)
    several = (CLEARED, part, sharing(samples=2), slope(0.4, -0.8, GREEN), part, WINDOW, slope(0, 0, BLUE))
    machine = Machine(NV2A, WIDTH, HEIGHT, samples=2, threads=1)
    machine.run(several)
    window, pbuffer = machine._samples.targets, machine._surface_samples["s"].targets
    for (of_window, place), (of_pbuffer, _) in zip(window, pbuffer, strict=True):
        expected = run_reference(several, NV2A, WIDTH, HEIGHT, 24, place)
        for plane in ("color", "depth", "stencil"):
            assert getattr(of_window, plane).tolist() == getattr(expected.target, plane), plane
            rows = getattr(expected.surfaces["s"], plane)
            assert getattr(of_pbuffer, plane).tolist() == [row[:7] for row in rows], plane
    assert (window[0][0].depth != window[1][0].depth).any()


@pytest.mark.parametrize("surface", [None, "s", "t", "u", "p"])
def test_a_pixel_s_history_has_what_was_drawn_to_others(surface):
    frame = record(FRAME, NV2A, WIDTH, HEIGHT)
    shown, elsewhere = frame.shown(surface), set()
    for y in range(shown.height):
        for x in range(shown.width):
            found = history(frame, (x, y), surface)  # raises where the pixel is not the frame's
            for touched in found.touched:
                before, after = touched.before, touched.after
                if touched.surface != surface:
                    elsewhere.add(touched.surface)
                    assert (before.depth, before.stencil) != (after.depth, after.stencil)
    others = {None: {"s", "t"}, "s": {None, "t"}, "t": {None, "s"}, "u": {"p"}, "p": {"u"}}
    assert elsewhere == others[surface]


def test_a_history_says_where_others_drew():
    found = inspect(FRAME, NV2A, WIDTH, HEIGHT, (0, 0))
    headings = [touched.heading(None) for touched in found.touched]
    assert headings[:3] == [
        "command 0, Clear: clear",
        "command 1, Draw: slope",
        "command 3, Draw to pbuffer 's': slope",
    ]
    assert "command 3, Draw to pbuffer &#x27;s&#x27;: slope" in history_page(found, "pixel")


def test_the_description_says_whose_depths_they_are():
    words = describe((sharing(), sharing("u", depth_of="p")))
    assert 'pbuffer "s": 7x5, A8R8G8B8, depth 24 bits, shared with the window' in words
    assert 'shared with pbuffer "p"' in words


REFUSED = {
    "no such pbuffer": ((sharing(depth_of="q"),), "shares the depths of 'q', and there is no such pbuffer"),
    "its own": ((sharing(depth_of="s"),), r"of 's', and there is no such pbuffer yet \(made so far: none\)"),
    "one that shares": (
        (sharing(), sharing("t", depth_of="s")),
        "whose depths are those of the window; name",
    ),
    "too wide": ((sharing(width=13),), "'s' is 13x5, and the window, whose depths it shares, 12x8"),
    "too high": ((own(), sharing(height=7, depth_of="p")), "is 7x7, and pbuffer 'p', .* shares, 9x6"),
    "other bits": ((sharing(depth_bits=16),), "has depth_bits 16, and the window, .* 24; give that"),
    "other samples": ((sharing(samples=2),), "has samples 2, and the window, whose depths it shares, 1"),
    "not sharing": ((own(), own("q", depth_of="p")), "'q' names the depths of 'p' and shares none"),
    "the window": ((replace(WINDOW, shares_depth=True),), "the window has its own depths"),
    "another's later": ((sharing(), own("s", 7, 5)), "those of the window since it was made"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_shared_is_refused(case):
    commands, words = REFUSED[case]
    with pytest.raises(UnsupportedState, match=words):
        validate(commands, NV2A, WIDTH, HEIGHT)


def test_machines_that_share_none_refuse_it():
    with pytest.raises(UnsupportedState, match="has no pbuffers"):
        validate((sharing(),), OPENGL_1_2, WIDTH, HEIGHT)
    with pytest.raises(UnsupportedState, match=r"every pbuffer of NV2A.* has its own depths; leave"):
        validate((sharing(),), NV2A.changed(shared_depth=False), WIDTH, HEIGHT)


def test_a_machine_remembers_who_shares():
    machine = Machine(NV2A, WIDTH, HEIGHT, threads=1)
    machine.run((sharing(),))
    with pytest.raises(UnsupportedState, match="those of the window since it was made"):
        machine.run((own("s", 7, 5),))
