"""A window's request: a frame's parameters, its machine with widths and clamps, and its last command."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

from fixedpipe.effects.refusal import Refusal, choose, refusals
from fixedpipe.pipeline.inspection.what_if import PARTS, with_bits, without_clamp
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.profiles.profile import Profile

# Limits of what a page may request. A page is a program, and anyone's address may be opened in a browser.
LONGEST_TEXT = 4000  # characters of a parameter's value; an arc of ten directions has some hundred
MOST_VALUES = 100  # parameters; no figure has so many
MOST_PIXELS = 1 << 22  # of a picture: 16 MB, as many as a screen of 2048 x 2048 shows
LEAST_SIZE, MOST_SIZE = 8, 2048  # a panel's height in pixels


@dataclass(frozen=True)
class View:
    """A frame that a window requests.

    id       the subject's id
    machine  key of ``PROFILES``; not the ideal, which is computed in addition
    size     a panel's height in pixels; 0: the subject's own
    values   (name, text) of parameters that differ from the subject's own, in the form of ``--set``
    bits     (part, bits) of widths that differ from the machine's, by names of ``what_if.PARTS``
    without  names of clamps that the machine must not have
    upto     number of the last command to draw; None: all commands are drawn
    """

    id: str
    machine: str
    size: int = 0
    values: tuple[tuple[str, str], ...] = ()
    bits: tuple[tuple[str, int], ...] = ()
    without: tuple[str, ...] = ()
    upto: int | None = None

    def whole(self) -> "View":
        """The same View with all commands."""
        return replace(self, upto=None)

    def on(self, machine: str) -> "View":
        """The same View on another machine, with that machine's own widths and clamps."""
        return replace(self, machine=machine, bits=(), without=())

    def profile(self) -> Profile:
        """The machine's Profile. Raises Refusal for widths and clamps that it cannot have."""
        return _changed(self.machine, self.bits, self.without)


@lru_cache(maxsize=64)
def _changed(key: str, widths: tuple[tuple[str, int], ...], clamps: tuple[str, ...]) -> Profile:
    """The Profile with these changes. Equal changes give the same object, because caches of textures and
    states compare it by identity.
    """
    found: Profile = machine_of(key)
    with refusals():
        for part, bits in widths:
            found = with_bits(found, part, bits)
        for name in clamps:
            found = without_clamp(found, name)
    return found


def machines() -> dict[str, Profile]:
    """The machines by key: all profiles without the ideal."""
    return {key: profile for key, profile in PROFILES.items() if not profile.arithmetic.exact}


def machine_of(key: str) -> Profile:
    """The Profile of a key. Raises Refusal for an unknown key, and for the ideal."""
    found: Profile = choose("machine", key, machines())
    return found


def to_object(view: View) -> dict[str, Any]:
    """A View as the JSON object that ``view_of`` reads."""
    return {
        "id": view.id,
        "machine": view.machine,
        "size": view.size,
        "values": dict(view.values),
        "bits": dict(view.bits),
        "without": list(view.without),
        "upto": view.upto,
    }


def view_of(given: Any) -> View:
    """The View that a page's JSON object describes. Raises Refusal for any other value."""
    if not isinstance(given, Mapping):
        raise Refusal("The view is no JSON object; send id, machine, size, values, bits, without, upto.")
    values, bits = (_mapping(given, name) for name in ("values", "bits"))
    for name, text in values.items():
        if type(text) is not str or len(text) > LONGEST_TEXT:
            raise Refusal(f"The value of {name[:40]!r} is no text of at most {LONGEST_TEXT} characters.")
    for part, width in bits.items():
        if part not in PARTS or type(width) is not int:
            raise Refusal(f"{part[:40]!r} has no width to set; give whole numbers of {', '.join(PARTS)}.")
    return View(
        _text(given, "id"),
        _text(given, "machine"),
        _whole(given, "size", 0, MOST_SIZE) or 0,
        tuple(sorted(values.items())),
        tuple(sorted(bits.items())),
        tuple(sorted(set(_texts(given, "without")))),
        _whole(given, "upto", 0, 10**7),
    )


def _text(given, name):
    text = given.get(name)
    if type(text) is not str or len(text) > LONGEST_TEXT:
        raise Refusal(f"{name} is no text of at most {LONGEST_TEXT} characters.")
    return text


def _texts(given, name):
    texts = given.get(name, [])
    if type(texts) is not list or len(texts) > MOST_VALUES or not all(type(each) is str for each in texts):
        raise Refusal(f"{name} is no list of at most {MOST_VALUES} names.")
    return texts


def _mapping(given, name):
    found = given.get(name, {})
    if type(found) is not dict or len(found) > MOST_VALUES:
        raise Refusal(f"{name} is no object with at most {MOST_VALUES} names.")
    return found


def _whole(given, name, low, high):
    number = given.get(name)
    if number is None:
        return None
    if type(number) is not int or not low <= number <= high:
        raise Refusal(f"{name} is {str(number)[:40]}; give a whole number from {low} to {high}, or none.")
    return number
