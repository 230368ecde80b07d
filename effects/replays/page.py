"""A page with frames of a trace, drawn by several machines, the ideal and Mesa, and a summary of the calls.

The page is one file without scripts, and loads no other file.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.replays.asked import FramesAsked
from fixedpipe.effects.replays.beside import Agreement, Beside, difference_picture, mesas_pictures
from fixedpipe.effects.replays.driving import frames_of, no_such_frame, opened
from fixedpipe.effects.replays.recording import frame_commands
from fixedpipe.effects.replays.replay import Frame, Replay
from fixedpipe.effects.replays.summary import summary_lines
from fixedpipe.effects.reports.conformance import inline_picture
from fixedpipe.effects.reports.style import STYLE
from fixedpipe.pipeline.commands import Command
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.messages import count
from fixedpipe.pipeline.profiles import PROFILES

# Machines that a page shows in addition to the chosen one: without register combiners, with them, and a later
# one.
SHOWN_BESIDE = ("OPENGL_1_2", "GEFORCE_256", "GEFORCE_3")
# The most frames of a page. Assumed: nobody reads a page with more pictures.
MOST_FRAMES = 24


@dataclass
class _Drawn:
    """A frame on several machines. ``ideal``: its picture without rounding, or None; ``mesa``: that of Mesa,
    or None.
    """

    frame: Frame
    images: dict[str, NDArray[np.uint8]] = field(default_factory=dict)
    ideal: NDArray[np.uint8] | None = None
    mesa: Beside | None = None


def trace_page(path: str, chosen: str, frames: FramesAsked, *, mesa: bool, threads: int | None = None) -> str:
    """The page's HTML. ``chosen``: the first machine's key; ``mesa``: whether glretrace draws too.

    Raises Refusal if the trace cannot be read, lacks a frame, or if more frames are requested than a page can
    have; GlretraceError if glretrace fails.
    """
    if frames.count is None or frames.count > MOST_FRAMES:
        raise Refusal(f"A page has up to {MOST_FRAMES} frames; give their numbers, as --frames 3,10-20.")
    keys = list(dict.fromkeys((chosen, *SHOWN_BESIDE)))
    drawn: dict[int, _Drawn] = {}
    summaries = {key: _draw(path, key, frames, drawn, key == chosen, threads) for key in keys}
    if mesa:
        found = mesas_pictures(path, [each.frame.seen_call for each in drawn.values()])
        for each, beside in zip(drawn.values(), found, strict=True):
            each.mesa = beside
    sections = "".join(_section(number, each, chosen) for number, each in drawn.items())
    name = escape(path.rpartition("/")[2])
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{name}</title>'
        f'<meta name="viewport" content="width=device-width"><style>{STYLE}</style></head><body>'
        f'<h1>{name}</h1><p class="quiet">Frames of a recorded OpenGL program on emulated machines. Below '
        f"each picture stands how far the {escape(PROFILES[chosen].name)} differs from it; a picture of "
        f"differences shows them 16 times as large.</p>{sections}{_calls(summaries)}</body></html>\n"
    )


def _draw(path, key, asked, drawn, is_chosen, threads):
    """Draw the frames on a machine into ``drawn``. Returns lines that say what happened to the calls."""
    replay = Replay(
        PROFILES[key],
        wanted=asked.wants,
        needed=asked.may_want,
        recorded=asked.may_want if is_chosen else lambda number: False,
        threads=threads,
    )
    with opened(path) as (trace, _):
        for frame in frames_of(trace, replay, asked):
            if frame.image is None:
                continue
            if is_chosen:
                drawn[frame.number] = _Drawn(frame, ideal=_ideal(frame))
            if frame.number in drawn:
                drawn[frame.number].images[key] = frame.image[..., :3]
        damage = trace.damage
    missing = asked.missing(drawn)
    if missing or not drawn:
        why = no_such_frame(missing[0] if missing else None, replay.frames)
        raise Refusal(f"{path} {why}{f' {damage}' if damage else ''}")
    return [*summary_lines(replay.tally), *([damage] if damage else [])]


def _ideal(frame: Frame) -> NDArray[np.uint8] | None:
    """The frame's picture without rounding; None if only machines can draw it."""
    assert frame.recording is not None
    commands: Sequence[Command] = frame_commands(frame.recording, frame.shown)
    try:
        return execute_ideal(commands, frame.width, frame.height).image()[..., :3]
    except ValueError:
        return None


def _section(number, each, chosen):
    ours, frame = each.images[chosen], each.frame
    figures = [_figure(ours, escape(PROFILES[chosen].name), "")]
    others: list[tuple[str, Any, str]] = [
        (PROFILES[key].name, image, "") for key, image in each.images.items() if key != chosen
    ]
    if each.ideal is not None:
        others.append(("The ideal, which rounds nothing", each.ideal, ""))
    if each.mesa is not None and each.mesa.picture is not None:
        others.append(("Mesa's llvmpipe", each.mesa.picture, each.mesa.doubt))
    for name, image, doubt in others:
        figures += _compared(ours, name, image, doubt)
    if each.mesa is not None and each.mesa.picture is None:
        figures.append(f"<figure><figcaption>Mesa: {escape(each.mesa.doubt)}</figcaption></figure>")
    refused = f", {frame.refused} of them refused" if frame.refused else ""
    return (
        f"<section><h2>Frame {number} <span>{count(frame.draws, 'draw')}{refused}, calls {frame.first_call} "
        f'to {frame.last_call}</span></h2><div class="pictures">{"".join(figures)}</div></section>'
    )


def _compared(ours, name, image, doubt):
    """The figures for another picture of the frame: the picture, and if it differs the difference."""
    if doubt or image.shape != ours.shape:
        yield _figure(image, escape(name), escape(doubt or "it has another size"))
        return
    found = Agreement.of(image, ours)
    yield _figure(image, escape(name), escape(str(found)))
    if found.largest:
        yield _figure(difference_picture(image, ours), f"Difference: {escape(name)}", "")


def _figure(image, title, said):
    more = f"<br>{said}" if said else ""
    return f"<figure>{inline_picture(image, title)}<figcaption>{title}{more}</figcaption></figure>"


def _calls(summaries):
    """A list for each machine that says what happened to the calls."""
    parts = []
    for key, lines in summaries.items():
        items = "".join(f"<li>{escape(line)}</li>" for line in lines)
        parts.append(f"<h3>{escape(PROFILES[key].name)}</h3><ul>{items}</ul>")
    return f"<section><h2>What became of the calls</h2>{''.join(parts)}</section>"
