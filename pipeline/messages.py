"""Small words that the sentences of errors and descriptions share."""

from fixedpipe.pipeline.enums import DepthFormat


def shown(value):
    """A value as a sentence shows it: its beginning, where it is long."""
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."


def listed(members):
    """Names of members of an enum, in its order."""
    return ", ".join(m.name for m in sorted(members)) or "none"


def quoted(names):
    """Names as they are given, in their order."""
    return ", ".join(map(repr, names)) or "none"


def count(number, noun, many=None):
    """A number and its noun. ``many``: the noun of several, where it is not made by an s."""
    return f"{number} {noun if number == 1 else many or noun + 's'}"


def nearest_power_of_two(edge):
    """The power of two nearest to edge."""
    above = 1 << (edge - 1).bit_length()
    return above if above - edge <= edge - above // 2 else above // 2


def surface_words(name: str | None) -> str:
    """A framebuffer in words: a pbuffer's name, or None."""
    return "the window" if name is None else f"pbuffer {name!r}"


def depth_words(depth_bits):
    """A depth buffer's format."""
    if depth_bits in (DepthFormat.FLOAT_16, DepthFormat.FLOAT_24):
        return f"{DepthFormat(depth_bits).name} depths"
    return f"{int(depth_bits)} bits of depth"
