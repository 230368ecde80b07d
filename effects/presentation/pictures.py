"""The pictures of a figure on a sheet, each cut into its panels, and their labels."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.refusal import Refusal, choose
from fixedpipe.pipeline.profiles import PROFILES

# By name, what a sheet may show, in the order in which it does.
PICTURES = {
    "machine": "what the machine drew",
    "ideal": "the same fragments in float64",
    "reference": "what the algorithm approximates, computed without it",
    "difference": "machine - ideal, about middle grey",
    "reference-difference": "machine - reference, about middle grey",
}
# Shown where nothing else is asked for: of a figure with a reference, and of another.
WITH_REFERENCE = ("machine", "reference", "reference-difference")
WITHOUT = ("machine", "ideal", "difference")
# The texture of a diagram's letters (fixedpipe.effects.diagrams.drawing.FONT).
_LETTERS = "font"
_SMALL = 64  # pixels of a panel: the commands of a small picture tell what kind of figure it is


@dataclass(frozen=True, eq=False)
class Shown:
    """A picture of a sheet.

    name      one of PICTURES
    heading   what it is, in a few words
    note      what is written below it; ""
    panels    uint8 [height, width, 3] each, top row first, None for an absent one. It is empty if words
              replace the picture, as for a difference of zero
    """

    name: str
    heading: str
    note: str
    panels: tuple[NDArray[np.uint8] | None, ...]


def _cut(pixels, columns, there=None):
    """A picture's panels. ``there``: [h, w], zero all over a panel that it has not."""
    width = pixels.shape[1] // columns
    spans = [slice(i * width, (i + 1) * width) for i in range(columns)]
    return tuple(
        np.ascontiguousarray(pixels[:, span, :3]) if there is None or there[:, span].any() else None
        for span in spans
    )


def _difference(drawn, name, columns):
    """A difference as it is shown: "identical" is written, not drawn."""
    of, found = {
        "difference": ("ideal", lambda: drawn.difference),
        "reference-difference": ("reference", lambda: drawn.reference_difference),
    }[name]
    difference = found()
    if difference.identical:
        note = f"{drawn.profile.name} and {of} are identical: no bit of any pixel differs."
        return Shown(name, f"difference from the {of}", note, ())
    note = (
        f"({drawn.profile.name} \N{MINUS SIGN} {of}) \N{MULTIPLICATION SIGN} {difference.gain:g} about "
        f"middle grey; rms {255 * difference.rms:.2g}, largest {255 * difference.largest:.3g} of 255"
    )
    what = "difference" if of == "ideal" else f"difference from {of}"
    heading = f"{what} \N{MULTIPLICATION SIGN}\N{NO-BREAK SPACE}{difference.gain:g}"
    there = drawn.reference[..., 3] if of == "reference" else None
    return Shown(name, heading, note, _cut(difference.image(), columns, there))


def _shown(drawn, name):
    """One picture of a rendering."""
    columns = drawn.figure.columns
    if name == "machine":
        return Shown(name, drawn.profile.name, "", _cut(drawn.image(), columns))
    if name == "ideal":
        return Shown(name, "ideal", "", _cut(drawn.ideal.image(), columns))
    if name == "reference":
        return Shown(name, "reference", "", _cut(_bytes(drawn.reference), columns, drawn.reference[..., 3]))
    return _difference(drawn, name, columns)


def _bytes(colors):
    """Float64 RGBA, 1.0 = full, as uint8: rounded to nearest."""
    return np.floor(255.0 * np.clip(colors, 0.0, 1.0) + 0.5).astype(np.uint8)


def is_diagram(figure, profile):
    """Whether a figure is a drawing with letters and no rendering that something could be compared with."""
    if figure.reference is not None or not any(profile == PROFILES[m] for m in figure.machines):
        return False
    return any(getattr(command, "texture", None) == _LETTERS for command in figure.commands(profile, _SMALL))


def names_of(figure, profile, names=None, alone=False):
    """Names of the pictures of a sheet: the requested ones, or else those that show the figure's subject.

    These are the machine's picture, the reference and their difference; without a reference the ideal and
    the difference from it; of a diagram the machine's picture alone. ``alone``: of any figure the machine's,
    as on a slide.

    Raises Refusal for another name, for a name given twice, and for a picture that the figure lacks on that
    machine.
    """
    there = list(PICTURES)
    if figure.reference is None:
        there = [name for name in there if "reference" not in name]
    if profile.arithmetic.exact:
        there = ["ideal"]
    if names is None:
        usual = WITHOUT if figure.reference is None else WITH_REFERENCE
        if there != ["ideal"] and (alone or is_diagram(figure, profile)):
            usual = usual[:1]
        return tuple(name for name in usual if name in there) or tuple(there)
    for name in names:
        choose("picture", name, PICTURES)
        if name not in there:
            why = "the ideal draws one picture" if profile.arithmetic.exact else "the figure has no reference"
            raise Refusal(
                f"{figure.id} has no picture {name!r} on the {profile.name}: {why}. Give {', '.join(there)}."
            )
    if not names or len(set(names)) < len(names):
        raise Refusal(
            f"The pictures are {', '.join(names) or 'none'}; name each once, of {', '.join(there)}."
        )
    return tuple(names)


def pictures_of(drawn, names):
    """The pictures of those names of a Rendering: a Shown each."""
    return tuple(_shown(drawn, name) for name in names)
