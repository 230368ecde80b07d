"""``fixedpipe passes``: a figure's commands in words, and on request what each left in the framebuffer."""

import click


@click.command(short_help="Print a figure's passes in words.")
@click.argument("figure_id", metavar="ID")
@click.option("--profile", metavar="NAME", help="Machine; otherwise the figure's own.")
@click.option(
    "--trace", metavar="DIR", help="Write colour, alpha, depth and stencil after each command as PNG."
)
@click.option("--size", type=click.IntRange(min=1), metavar="N", help="Edge of a traced panel, pixels.")
def passes(figure_id, profile, trace, size):
    """Print the pass sequence of figure ID: every command, and every state that differs from the default."""
    from effects.cli.refusal import choose, refusals
    from effects.figures import FIGURES
    from pipeline.describe import describe
    from pipeline.profiles import PROFILES

    figure = choose("figure", figure_id, FIGURES)
    key = profile or figure.machines[0]
    machine = choose("profile", key, PROFILES)
    with refusals():
        method = figure.method(key)
        commands = figure.commands(machine, size, method)
    click.echo(f"{figure.id}: {figure.title} ({', '.join(figure.techniques)})")
    click.echo(f"on {machine.name}: {method.name}\n")
    click.echo(describe(commands))
    if trace is not None:
        with refusals():
            names = _write_trace(commands, machine, figure.dimensions(size), trace)
        click.echo(f"\n{len(names)} pictures in {trace}: {names[0]} to {names[-1]}")


def _write_trace(commands, machine, dimensions, folder):
    """Write the snapshots' pictures, ``03-Draw-depth.png`` and so on; returns their names in order."""
    from effects.cli.files import png, writable_folder, write_whole
    from pipeline.execute import execute

    folder = writable_folder(folder)
    names = []
    for number, snapshot in enumerate(execute(commands, machine, *dimensions, trace=True).trace):
        for buffer, picture in snapshot.pictures().items():
            names.append(f"{number:02d}-{snapshot.kind}-{buffer}.png")
            write_whole(folder / names[-1], png(picture))
    return names
