"""Pixel shaders that Direct3D's validator refuses, or defines in another way, and the machine runs.

Source: the DirectX 8.1 reference of pixel shaders: read port limit, instruction pairing, counting
instructions, texbem, texkill, cmp.
"""

from fixedpipe.pipeline.notations.pixel_shaders import OVER_TWO_COMBINERS, grouped

# The number of different registers of a kind that an instruction may read, by version. Other versions allow
# two, and three texture registers.
_PORTS = {"1.0": {"t": 1, "v": 1}, "1.1": {"t": 2}}
_MOST_TEXTURES, _MOST_OTHERS, _MOST_OF_A_PAIR = 3, 2, 3
_KINDS = {"t": "texture", "v": "color", "c": "constant"}
_MOST_COMPARISONS, _SLOTS = 3, 8
_OFFSETS = ("texbem", "texbeml")


def most_read(version, letter):
    """How many different registers of a kind, "t", "v" or "c", an instruction of a version may read."""
    return _PORTS.get(version, {}).get(letter, _MOST_TEXTURES if letter == "t" else _MOST_OTHERS)


def validator_notes(listing):
    """(line, sentence) of each such place, in the order of the program."""
    offsets, given = {}, set()
    for instruction in listing.texture:
        name, line = instruction.name, instruction.token.line
        for source in instruction.sources:
            if source.letter == "t" and source.register not in given:
                yield (
                    line,
                    f"{name} reads t{source.number} before the text gives it, which Direct3D refuses; units "
                    "work in the order of their numbers.",
                )
        given.add(instruction.destination)
        if name == "texkill":
            yield (
                line,
                f"texkill t{instruction.unit} tests three coordinates in Direct3D, and all four here; a "
                "fourth that is not negative, 1 for instance, changes nothing.",
            )
        if name == "texcoord":
            yield (
                line,
                f"the alpha of texcoord t{instruction.unit} is 1 whatever the fourth coordinate, by "
                "definition.",
            )
        yield from _read_again(instruction, {} if name in _OFFSETS else offsets)
        if name in _OFFSETS:
            offsets[instruction.sources[0].register] = name
    if not listing.texture:
        yield from _of_no_texture(listing)
    for instruction in listing.arithmetic:
        name, line = instruction.name, instruction.token.line
        if instruction.destination[0] == "v":
            yield line, f"{name} writes v{instruction.unit}, which Direct3D lets a program only read."
        read = {source.register for source in instruction.sources}
        for letter, kind in _KINDS.items():
            most = most_read(listing.version, letter)
            registers = sum(register[0] == letter for register in read)
            if registers > most:
                at_once = f"ps.{listing.version} reads {('', 'one', 'two', 'three')[most]} at once"
                yield line, f"{name} reads {registers} {kind} registers; {at_once}."
        if name == "cmp" and instruction.destination in read:
            yield line, "cmp writes one of its sources, which Direct3D refuses."
        yield from _read_again(instruction, offsets)
        offsets.pop(instruction.destination, None)
    yield from _of_pairs(listing)
    yield from _of_slots(listing)


def _of_no_texture(listing):
    """Notes on a program without texture instructions, whose texture registers hold the units' samples.

    Source: the DirectX 8.1 reference of ps.1.x, Registers; the assembler's error X5036.
    """
    known = set()
    for instruction in listing.arithmetic:
        for source in instruction.sources:
            if source.letter == "t" and source.register not in known:
                known.add(source.register)
                yield (
                    instruction.token.line,
                    f"t{source.number} is read and no texture instruction gives it, which Direct3D refuses "
                    f"(X5036); write tex t{source.number}. Here unit {source.number} samples what is bound "
                    "to it.",
                )
        known.add(instruction.destination)


def _of_pairs(listing):
    for group in grouped(listing.arithmetic):
        read = {source.register for instruction in group for source in instruction.sources}
        line = group[-1].token.line
        for letter, kind in _KINDS.items():
            registers = sum(register[0] == letter for register in read)
            if len(group) == 2 and registers > _MOST_OF_A_PAIR:
                yield line, f"the pair reads {registers} {kind} registers; Direct3D lets a pair read three."
        if listing.version == "1.0" and len({instruction.destination for instruction in group}) == 2:
            yield line, "the pair writes two registers; in ps.1.0 both write one."


def _of_slots(listing):
    """Notes on slots that the chip's stages do not count."""
    comparisons = [instruction for instruction in listing.arithmetic if instruction.name == "cmp"]
    if len(comparisons) > _MOST_COMPARISONS:
        yield comparisons[_MOST_COMPARISONS].token.line, "a fourth cmp; Direct3D takes three."
    arithmetic = sum(
        1 + (instruction.name in OVER_TWO_COMBINERS)
        for instruction in listing.arithmetic
        if not instruction.paired
    )
    luminance = sum(instruction.name == "texbeml" for instruction in listing.texture)
    line = listing.end.line
    if luminance and arithmetic + luminance > _SLOTS:
        yield (
            line,
            f"texbeml takes one of Direct3D's {_SLOTS} slots of arithmetic, and the instructions take "
            f"{arithmetic}.",
        )
    # Of texture instructions, tex takes none of these slots, and an offset takes two.
    addresses = sum(1 + (i.name in _OFFSETS) for i in listing.texture if i.name != "tex")
    if listing.version == "1.0" and arithmetic + luminance + addresses > _SLOTS:
        yield line, f"{arithmetic + luminance + addresses} slots without tex; ps.1.0 has {_SLOTS} in all."


def unwritten_note(line, register, half):
    """(line, sentence) for a half, "rgb" or "a", of r0 or r1 that is read before it is written.

    ``register``: letter and number.
    """
    name, what = "".join(map(str, register)), "alpha" if half == "a" else "color"
    value = "texture 0's alpha" if (name, half) == ("r0", "a") else "zero"
    return (
        line,
        f"{name}'s {what} is read before anything is written to it, which Direct3D refuses; the register "
        f"begins as {value}.",
    )


def _read_again(instruction, offsets):
    for source in instruction.sources:
        if source.register in offsets:
            name = "".join(map(str, source.register))
            yield (
                instruction.token.line,
                f"{name} is read again after {offsets[source.register]} of it, which Direct3D refuses.",
            )
