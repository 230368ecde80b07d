"""What Direct3D's validator refuses in a pixel shader, or defines otherwise, and the machine does not.

Source: the DirectX 8.1 reference of pixel shaders: register port limits, texbem, texkill, cmp.
"""

# How many different texture registers an instruction may read; three from ps.1.2 on.
_TEXTURE_PORTS = {"1.0": 2, "1.1": 2}
_OFFSETS = ("texbem", "texbeml")


def validator_notes(listing):
    """(line, sentence) of each, in the order of the program."""
    offsets = {}
    for instruction in listing.texture:
        name, line = instruction.name, instruction.token.line
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
    for instruction in listing.arithmetic:
        name, line = instruction.name, instruction.token.line
        if instruction.destination[0] == "v":
            yield line, f"{name} writes v{instruction.unit}, which Direct3D lets a program only read."
        read = {source.register for source in instruction.sources}
        textures = sum(letter == "t" for letter, _ in read)
        if textures > _TEXTURE_PORTS.get(listing.version, 3):
            yield (
                line,
                f"{name} reads {textures} texture registers; ps.{listing.version} reads two at once.",
            )
        if name == "cmp" and instruction.destination in read:
            yield line, "cmp writes one of its sources, which Direct3D refuses."
        yield from _read_again(instruction, offsets)
        offsets.pop(instruction.destination, None)


def unwritten_note(line, register, half):
    """(line, sentence) of a half, "rgb" or "a", of r0 or r1 that is read before anything is written to it.
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
