"""The framebuffer after every command of a frame, as pictures and a page that shows them."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from html import escape

import numpy as np

from fixedpipe.effects.figures import difference
from fixedpipe.effects.figures.rendering import delta_of, gain_for
from fixedpipe.effects.refusal import refusals
from fixedpipe.effects.reports.files import write_whole
from fixedpipe.effects.reports.style import STYLE
from fixedpipe.pipeline.commands import Accum, Bitmap, Clear, CopyPixels, Draw, DrawPixels, Saturate
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.framebuffers.pictures import png
from fixedpipe.pipeline.ideal.evaluate import execute_ideal

# The commands that change the framebuffer; the others have no picture.
DRAWING = (Clear, Draw, DrawPixels, CopyPixels, Bitmap, Accum, Saturate)
BUFFERS = ("color", "alpha", "depth", "stencil")
OF_THE_IDEAL = BUFFERS[:2]
# Bytes of a pixel in the four pictures, and in the sheet of machine, ideal and difference.
_PICTURE_BYTES, _SHEET_BYTES = 6, 9
_GAP = 4  # pixels between the pictures of a sheet
_SHEET = "beside the ideal"


@dataclass(frozen=True)
class Plan:
    """What a trace will write: how many commands are chosen, how many of them draw, and no more than so many
    files and bytes (equal pictures are written once, and PNG is smaller).
    """

    commands: int
    drawing: int
    files: int
    bytes: int


def plan(commands, chosen, dimensions, sheets):
    """The Plan of a trace of the ``chosen`` numbers of commands; ``sheets``: each picture next to the
    ideal's.
    """
    numbers = [n for n in range(len(commands)) if n in chosen]
    drawing = sum(isinstance(commands[n], DRAWING) for n in numbers)
    pixels = dimensions[0] * dimensions[1] * drawing
    size = pixels * (_PICTURE_BYTES + _SHEET_BYTES * sheets)
    return Plan(len(numbers), drawing, drawing * (len(BUFFERS) + sheets) + 1, size)


class _Pages:
    """The pictures of a trace in a folder, equal ones written once, and the rows of its page."""

    def __init__(self, folder, digits, chosen, step):
        self.folder, self.digits, self.chosen, self.step = folder, digits, chosen, step
        self.number, self.files, self.rows, self.notes = -1, {}, {}, {}

    def next_of(self, command):
        """Whether the next command, which is this one, is chosen and draws."""
        self.number += 1
        if self.number not in self.chosen or not isinstance(command, DRAWING):
            return False
        self.step(f"{self.number}. {command.label}")
        return True

    def add(self, command, pictures):
        """Keep pictures, {what: uint8 image}, of the command."""
        _, row = self.rows.setdefault(self.number, (command, {}))
        for what, picture in pictures.items():
            key = picture.shape, hashlib.sha256(np.ascontiguousarray(picture).tobytes()).digest()
            if key not in self.files:
                kind, end = type(command).__name__, what.replace(" ", "-")
                self.files[key] = f"{self.number:0{self.digits}d}-{kind}-{end}.png"
                write_whole(self.folder / self.files[key], png(picture))
            row[what] = self.files[key]

    def page(self, title):
        columns = list(dict.fromkeys(what for _, row in self.rows.values() for what in row))
        head = "".join(f"<th>{escape(c)}</th>" for c in ("", "command", *columns))
        seen, rows = set(), ""
        for number, (command, row) in self.rows.items():
            cells = "".join(
                _cell(row.get(what), seen, self.notes.get((number, what), "")) for what in columns
            )
            label = f"{type(command).__name__}<br>{escape(command.label)}"
            rows += f'<tr id="{number}"><td>{number}</td><td>{label}</td>{cells}</tr>'
        style = f"{STYLE} td img {{ max-width: 24rem; image-rendering: pixelated }}"
        return (
            '<!doctype html><html lang="en"><head><meta charset="utf-8">'
            f"<title>{escape(title)}</title><style>{style}</style></head><body><h1>{escape(title)}</h1>"
            "<p>What each command left. Commands that draw nothing are left out, and of equal pictures only "
            "the first is shown. Beside the ideal: the machine, the same fragments in float64, and "
            "(machine - ideal) about middle grey, so many times as large as is written under it.</p>"
            f'<div class="table"><table><tr>{head}</tr>{rows}</table></div></body></html>\n'
        )


def _cell(name, seen, note):
    if name is None:
        return "<td></td>"
    if name in seen:
        return f'<td><a href="{escape(name)}">as {escape(name.split("-")[0])}</a></td>'
    seen.add(name)
    image = f'<a href="{escape(name)}"><img src="{escape(name)}" loading="lazy" alt=""></a>'
    return f"<td>{image}{f'<br>{escape(note)}' * bool(note)}</td>"


@dataclass(frozen=True)
class Traced:
    """A frame to trace: ``commands`` for the profile, and ``ideal``, the same for the exact one, or None if
    the ideal is not shown.
    """

    title: str
    profile: object
    commands: tuple
    dimensions: tuple
    ideal: tuple | None = None


def write_trace(traced: Traced, folder, chosen, step: Callable[[str], None]):
    """Write the pictures of the ``chosen`` numbers of commands and index.html; returns how many pictures.

    ``step``: called with a line of text for each picture's command. Raises Refusal.
    """
    pages = _Pages(folder, max(2, len(str(len(traced.commands) - 1))), chosen, step)
    with refusals():
        if traced.profile.arithmetic.exact:
            _trace_ideal(traced, pages)
        else:
            _trace_machine(traced, pages)
    write_whole(folder / "index.html", pages.page(traced.title).encode())
    return len(pages.files)


def _trace_ideal(traced, pages):
    def watch(command, color):
        if pages.next_of(command):
            image = _bytes(color)
            pages.add(command, dict(zip(OF_THE_IDEAL, (image[..., :3], image[..., 3]), strict=True)))

    execute_ideal(traced.commands, *traced.dimensions, trace=watch)


def _trace_machine(traced, pages):
    beside = traced.ideal is not None

    def watch(command, take):
        if pages.next_of(command):
            pages.add(command, take().pictures())

    guide = execute(traced.commands, traced.profile, *traced.dimensions, trace=watch, record=beside)
    if not beside:
        return
    again = _Pages(pages.folder, pages.digits, pages.chosen, pages.step)
    again.rows, again.files, again.notes = pages.rows, pages.files, pages.notes

    def watch_ideal(command, color):
        if again.next_of(command):
            machine = _read(again.folder / again.rows[again.number][1]["color"])
            sheet, again.notes[again.number, _SHEET] = _sheet(machine, color)
            again.add(command, {_SHEET: sheet})

    execute_ideal(traced.ideal, *traced.dimensions, guide=guide, trace=watch_ideal)


def _bytes(color):
    return np.floor(np.clip(color, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)


def _read(path):
    """A picture that was written, uint8 [h, w, 3]: of thousands none has to stay in memory."""
    from PIL import Image

    with Image.open(path) as picture:
        return np.asarray(picture)


def _sheet(machine, ideal):
    """Machine, ideal and their difference beside each other, uint8 [h, 3 w + gaps, 3], and the difference's
    gain in words; where nothing differs, the first two alone.
    """
    pictures, note = [machine, _bytes(ideal)[..., :3]], "identical"
    delta = delta_of(machine, ideal)
    if delta.any():
        gain = gain_for(delta)
        pictures.append(difference(machine, ideal, gain)[..., :3])
        note = f"difference x {gain}"
    gap = np.full((machine.shape[0], _GAP, 3), 255, np.uint8)
    parts = [part for picture in pictures for part in (gap, picture)][1:]
    return np.concatenate(parts, axis=1), note
