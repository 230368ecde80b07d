"""A diagram's letters as text: a machine draws them as pixels of a small font, and a page sets them in its
own font.

A frame is drawn without the letters, and the record says where each label stands, how large it is and in
which colour. Greek letters are spelled in the labels of figures, because the machines' font has none.
"""

import re
from dataclasses import replace
from functools import cache

import numpy as np

from fixedpipe.pipeline.commands import Clear, Draw, TexImage

# The texture of the letters (fixedpipe.effects.diagrams.drawing.FONT).
_FONT = "font"
_GREEK = {
    **{"alpha": "\u03b1", "beta": "\u03b2", "gamma": "\u03b3", "delta": "\u03b4", "epsilon": "\u03b5"},
    **{
        "theta": "\u03b8",
        "lambda": "\u03bb",
        "mu": "\u03bc",
        "nu": "\u03bd",
        "pi": "\u03c0",
        "rho": "\u03c1",
    },
    **{"sigma": "\u03c3", "tau": "\u03c4", "phi": "\u03c6", "psi": "\u03c8", "omega": "\u03c9"},
}
# A spelled Greek letter; an index behind "_"; f, s and p along u or v; a numbered r.
_PARTS = re.compile(rf"\b({'|'.join(_GREEK)})\b|_(\w)|\b([fsp])([uv])\b|\b(r)(\d)\b")


def typeset(text):
    """A label as a list of [text, level]: level -1 stands low, as an index does, 0 on the line.

    "su = alpha x d_i" is s with a low u, then " = ", alpha's letter, " x d" and a low i.
    """
    runs, place = [], 0
    for found in _PARTS.finditer(text):
        runs.append([text[place : found.start()], 0])
        greek, low, vector, along, radius, number = found.groups()
        if greek:
            runs.append([_GREEK[greek], 0])
        else:
            runs += [[vector or radius or "", 0], [along or number or low, -1]]
        place = found.end()
    runs.append([text[place:], 0])
    joined = []
    for part, level in runs:
        if part and joined and joined[-1][1] == level:
            joined[-1][0] += part
        elif part:
            joined.append([part, level])
    return joined


def is_label(command):
    """Whether a command draws letters."""
    return isinstance(command, Draw) and any(
        one and one.texture == _FONT for one in command.state.texture_units
    )


def labels_of(commands, height):
    """The labels of a frame whose window is ``height`` pixels high, as labels.js takes them: a list of {runs,
    x, y, size, color, align, halo}, x and y in pixels from the left top; None where the frame does more than
    draw into its window, so that the letters may be a part of another picture.
    """
    if not all(isinstance(command, Clear | Draw | TexImage) for command in commands):
        return None
    return [_label(command, height) for command in commands if is_label(command)]


def _label(command, height):
    text, view = command.label, command.state.vertex.viewport
    corners = np.asarray(command.mesh.positions)[:, :2].reshape(-1, 4, 2)
    colors = np.asarray(command.mesh.colors).reshape(-1, 4, 3)[:, 0]
    letters = len(text.replace(" ", ""))
    halo = colors[0] if len(corners) > letters else None
    corners, color = corners[-letters:], colors[-1]
    rows = _rows(corners, text)
    left, right = corners[..., 0].min(), corners[..., 0].max()
    low, high = corners[..., 1].min(), corners[..., 1].max()
    begins = {round(float(corners[begin:end, :, 0].min()), 3) for begin, end, _ in rows}
    align = -1 if len(rows) > 1 and len(begins) == 1 else 0
    return {
        "runs": typeset("\n".join(line for _, _, line in rows)),
        "x": view.x + float(left if align else (left + right) / 2),
        "y": height - view.y - float((low + high) / 2),
        "size": float(high - low) / len(rows),
        "color": _hexadecimal(color),
        "align": [align, 0],
        **({} if halo is None else {"halo": _hexadecimal(halo)}),
    }


def _rows(corners, text):
    """[(first letter, end, text)] of a label's lines, of letters from the first line down."""
    feet = corners[:, 0, 1]
    ends = [n for n in range(1, len(feet)) if feet[n] != feet[n - 1]]
    out, words, place = [], text.split(" "), 0
    for begin, end in zip([0, *ends], [*ends, len(feet)], strict=True):
        line, count = [], end - begin
        while place < len(words) and sum(map(len, line)) + len(words[place]) <= count:
            line.append(words[place])
            place += 1
        out.append((begin, end, " ".join(line)))
    return out


def _hexadecimal(color):
    return "#" + "".join(f"{round(255 * float(part)):02x}" for part in color[:3])


@cache
def without_letters(method):
    """The Method without its letters, if it only draws into its window; otherwise the Method unchanged."""

    def scene(*given, **values):
        commands = method.scene(*given, **values)
        if labels_of(commands, 0) is None:
            return commands
        return tuple(command for command in commands if not is_label(command))

    return replace(method, scene=scene)
