"""A table of what a program of the time computes for given inputs, in the words of ``fixedpipe inspect``."""

import click

_SHOWN = ("RGB portion", "alpha portion", "combiner", "color sum", "final combiner")
_REGISTERS = ("t0", "t1", "t2", "t3", "v0", "v1")


def tell_table(program, machine, inputs):
    """Print the inputs and results of each combiner of a Program on a machine. ``inputs``: the values of
    ``--input``.

    The program's combiners draw one point, and the table is the history of its pixel. The inputs set the
    texture registers, so texture shaders have no effect. Raises Refusal for wrong inputs.
    """
    from rich.console import Console

    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.cli.history_text import fragment_text
    from fixedpipe.effects.refusal import Refusal, refusals
    from fixedpipe.pipeline.inspection.inspect import inspect
    from fixedpipe.pipeline.inspection.program_point import program_point

    if program.combiners is None:
        raise Refusal("This program has texture shaders alone; --table is of register combiners.")
    values = _inputs(inputs, machine)
    names = ", ".join(f"{name} {' '.join(map(str, color))}" for name, color in values.items())
    click.echo(f"\nOf {names}:")
    announce_compiling("portable")
    with refusals():
        history = inspect(program_point(program.combiners, machine, values), machine, 1, 1, (0, 0))
    (fragment,) = history.touched[-1].fragments
    shown = [stage for stage in fragment.stages if stage.kind in _SHOWN]
    Console(highlight=False).print(fragment_text(fragment, shown), soft_wrap=True)


def _inputs(options, machine):
    """{register: four bytes}, from texts ``REGISTER=R,G,B,A``. Raises Refusal for another form."""
    from fixedpipe.effects.refusal import Refusal

    found, units = {}, machine.textures.max_texture_units
    for given in options:
        name, _, color = given.partition("=")
        try:
            components = [int(component) for component in color.split(",")]
        except ValueError:
            components = []
        components *= 4 if len(components) == 1 else 1
        if name not in _REGISTERS or len(components) != 4 or not all(0 <= c <= 255 for c in components):
            raise Refusal(
                f"--input {given} is no REGISTER=R,G,B,A; write --input t0=255,128,0,255: t0 to t3, v0 or "
                "v1, and whole numbers from 0 to 255."
            )
        if name[0] == "t" and int(name[1]) >= units:
            raise Refusal(f"--input {name}: {machine.name} has {units} texture units, t0 to t{units - 1}.")
        if name in found:
            raise Refusal(f"--input gives {name} twice; give it once.")
        found[name] = tuple(components)
    return {name: found.get(name, (0, 0, 0, 0)) for name in _REGISTERS}
