"""HostStep: commands that depend on what was read, in one frame with the others."""

import numpy as np
import pytest

from fixedpipe.pipeline.commands import (
    Clear,
    CopyTexSubImage,
    DrawPixels,
    HostStep,
    MakeCurrent,
    ReadPixels,
    TexImage,
)
from fixedpipe.pipeline.description.describe import describe
from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.pixel_transfer import Histogram, PixelImage, PixelTransfer
from fixedpipe.pipeline.profiles import GEFORCE_256, NV2A, OCTANE
from fixedpipe.pipeline.state import PassState, RasterPosition, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.pipeline.validation.walk import UnsupportedState, Walk

SIZE = 4
HALF = Clear(label="half", color=(0.5, 0.25, 0.0, 1.0))
READ = ReadPixels(label="read", name="pixels")


def draw(image, label="draw"):
    return DrawPixels(label=label, image=PixelImage(image), position=RasterPosition(window=True))


def doubled(pixels):
    image = pixels["pixels"]
    return (draw(2 * image if image.dtype == np.uint8 else 2.0 * image),)


DOUBLE = HostStep(label="double it", reads=("pixels",), commands=doubled)


def test_the_host_draws_what_it_made_of_what_was_read():
    result = execute((HALF, READ, DOUBLE, ReadPixels(label="again", name="after")), GEFORCE_256, SIZE, SIZE)
    assert (result.pixels["pixels"][..., :3] == (128, 64, 0)).all()
    assert (result.pixels["after"][..., :3] == (0, 128, 0)).all()  # bytes: 256 is 0
    ideal = execute_ideal((HALF, READ, DOUBLE), SIZE, SIZE)
    assert (ideal.color[..., :3] == (1.0, 0.5, 0.0)).all()


def test_the_hosts_commands_take_its_place_among_the_others():
    def issued(pixels):
        return (
            draw(pixels["pixels"], "first"),
            HostStep(label="second", reads=("pixels",), commands=doubled),
        )

    frame = (
        HALF,
        READ,
        HostStep(label="nested", reads=("pixels",), commands=issued),
        draw(np.zeros((1, 1, 4))),
    )
    result = execute(frame, GEFORCE_256, SIZE, SIZE, trace=True, record=True)
    labels = ["half", "read", "nested", "first", "second", "draw", "draw"]
    assert [snapshot.label for snapshot in result.trace] == labels
    assert len(result.records) == 3
    assert (result.trace[3].color[..., :2] == (128, 64)).all()
    assert (result.trace[5].color[..., :2] == (0, 128)).all()
    assert (result.image()[-1, 0] == 0).all()
    # A machine's frame guides the ideal's, though the host drew other values.
    guided = execute_ideal(frame, SIZE, SIZE, guide=result)
    assert (guided.color[0, 0, :2] == (1.0, 0.5)).all()


def test_a_guide_whose_host_drew_otherwise_is_refused():
    def once_on_machines(pixels):
        return doubled(pixels) * (1 if pixels["pixels"].dtype == np.uint8 else 2)

    def twice_on_machines(pixels):
        return doubled(pixels) * (2 if pixels["pixels"].dtype == np.uint8 else 1)

    for commands, drew in (
        (once_on_machines, "drew 1 times and these commands draw 2"),
        (twice_on_machines, "draw 1 times"),
    ):
        frame = (HALF, READ, HostStep(label="host", reads=("pixels",), commands=commands))
        guide = execute(frame, GEFORCE_256, SIZE, SIZE, record=True)
        with pytest.raises(ValueError, match=drew):
            execute_ideal(frame, SIZE, SIZE, guide=guide)


@pytest.mark.parametrize(
    ("frame", "words"),
    [
        ((DOUBLE,), r'Command 1, "double it": nothing has read \'pixels\' before \(read so far: none\)'),
        ((READ, HostStep(label="x", reads=("other",), commands=doubled)), "read so far: 'pixels'"),
        ((HostStep(label="x", reads=(), commands=None),), "commands is None; give a value of type Callable"),
        ((HostStep(label="x", reads="pixels", commands=doubled),), "reads is 'pixels'"),
        ((HostStep(label=" ", reads=(), commands=doubled),), "label"),
    ],
)
def test_what_is_wrong_with_a_step_is_said_before_anything_is_drawn(frame, words):
    machine = Machine(GEFORCE_256, SIZE, SIZE)
    with pytest.raises(UnsupportedState, match=words):
        machine.run((HALF, *frame))
    assert not machine.framebuffer.color.any()


def step(commands):
    return HostStep(label="host", reads=(), commands=lambda pixels: commands)


TEXTURED = PassState(texture_units=(TextureUnit("later"),))


@pytest.mark.parametrize(
    ("commands", "words"),
    [
        (None, 'HostStep "host": A frame is a tuple of commands; this is None'),
        (HALF, 'HostStep "host": A frame is a tuple of commands; this is one Clear'),
        ((HALF, "draw"), "Command 1 from HostStep \"host\" on: 'draw' is no command"),
        (
            (HALF, READ),
            'Command 1 from HostStep "host" on, "read": an earlier ReadPixels or GetTexImage already',
        ),
        (
            (HALF, DrawPixels(label="x", image=PixelImage(np.zeros((1, 1, 4))), state=TEXTURED)),
            "'later'",
        ),
        ((MakeCurrent(label="p", surface="p", width=4, height=4),), "has no pbuffers"),
    ],
)
@pytest.mark.parametrize("ideal", [False, True])
def test_what_the_host_issues_is_validated_before_it_is_drawn(commands, words, ideal):
    blue = Clear(label="blue", color=(0.0, 0.0, 1.0, 1.0))
    frame = (READ, blue, step(commands))
    if ideal:
        with pytest.raises(UnsupportedState, match=words):
            execute_ideal(frame, SIZE, SIZE)
        return
    machine = Machine(OCTANE, SIZE, SIZE)
    with pytest.raises(UnsupportedState, match=words):
        machine.run(frame)
    assert (machine.framebuffer.color == (0, 0, 255, 255)).all()  # what came before is drawn, the rest is not


def test_what_follows_is_validated_again_as_the_machine_then_is():
    flat, cube = texture_2d(np.zeros((4, 4, 4), np.uint8)), texture_2d(np.zeros((1024, 2, 4), np.uint8))
    store = TexImage(label="store", texture="later", image=flat)
    patch = CopyTexSubImage(label="patch", texture="later", x_offset=2, width=2, height=2)
    changed = step((TexImage(label="other", texture="later", image=cube), HALF))
    machine = Machine(GEFORCE_256, SIZE, SIZE)
    with pytest.raises(UnsupportedState, match='from HostStep "host" on, "patch"'):
        machine.run((store, changed, patch))
    assert not machine.framebuffer.color.any()


def test_a_step_in_a_pbuffer_and_one_of_pixels_that_a_histogram_took_are_refused():
    pbuffer = MakeCurrent(label="p", surface="p", width=4, height=4)
    with pytest.raises(UnsupportedState, match="make the window current first"):
        execute((READ, pbuffer, DOUBLE), NV2A, SIZE, SIZE)
    sunk = ReadPixels(
        label="count", name="pixels", transfer=PixelTransfer(histogram=Histogram("h", sink=True))
    )
    with pytest.raises(UnsupportedState, match="nothing has read 'pixels'"):
        execute((sunk, DOUBLE), OCTANE, SIZE, SIZE)


def test_a_step_is_printed_by_its_label_and_what_it_reads():
    text = describe((READ, DOUBLE, step(())))
    assert '1. HostStep "double it"\n   the host reads "pixels";' in text
    assert "the host reads nothing" in text


def test_what_was_read_stays_what_the_framebuffer_held():
    def commands(pixels):
        pixels["pixels"][:] = 0
        return ()

    frame = (HALF, READ, HostStep(label="host", reads=("pixels",), commands=commands))
    for run in (lambda: execute(frame, GEFORCE_256, SIZE, SIZE), lambda: execute_ideal(frame, SIZE, SIZE)):
        with pytest.raises(ValueError, match="read-only") as raised:
            run()
        # Whose function it was is said, whatever it raised.
        assert raised.value.__notes__ == ['in the function of HostStep "host"']


def test_a_step_cannot_run_the_machine_that_waits_for_it():
    machine = Machine(GEFORCE_256, SIZE, SIZE)

    def commands(_):
        machine.run((HALF,))
        return ()

    with pytest.raises(ValueError, match=r"HostStep's function runs commands on its own machine"):
        machine.run((HostStep(label="host", reads=(), commands=commands),))
    machine.run((HALF,))
    assert machine.framebuffer.color[0, 0, 0] == 128


def test_what_waits_is_looked_at_again_only_where_a_step_changed_what_is_known(monkeypatch):
    seen = []
    takes = Walk.takes

    def counted(walk, command):
        seen.append(command.label)
        return takes(walk, command)

    monkeypatch.setattr(Walk, "takes", counted)
    steps = [HostStep(label=f"step {n}", reads=("pixels",), commands=doubled) for n in range(8)]
    execute((HALF, READ, *steps), GEFORCE_256, SIZE, SIZE)
    # Ten commands of the frame, and one that each of eight steps issues.
    assert len(seen) == 18

    def loads(pixels):
        # Nested, so that what is known after the inner steps is kept in order too.
        new = TexImage(label="new", texture="t", image=texture_2d(np.zeros((4, 4, 3))))
        return (steps[0], new, steps[1])

    seen.clear()
    execute((HALF, READ, HostStep(label="load", reads=(), commands=loads), *steps), GEFORCE_256, SIZE, SIZE)
    # Eleven; three that the first issues, and then the eight that wait; one of each of ten steps.
    assert len(seen) == 11 + 3 + 8 + 10
