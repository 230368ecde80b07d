"""``fixedpipe passes``: a figure's commands in words, and on request what each left in the framebuffer."""

import click

from fixedpipe.effects.cli.options import changes_of, set_option

# Colour, depth and stencil of a pixel, and how much memory a trace may take: 400 commands of 1024x512.
_SNAPSHOT_BYTES, _MOST_BYTES = 9, 1 << 31


@click.command(short_help="Print a figure's passes in words.")
@click.argument("figure_id", metavar="ID")
@click.option("--profile", metavar="NAME", help="Machine; otherwise the figure's own.")
@click.option(
    "--trace", metavar="DIR", help="Write colour, alpha, depth and stencil after each command as PNG."
)
@click.option("--all", "whole", is_flag=True, help="Print commands that are repeated as well.")
@click.option("--size", type=click.IntRange(min=1), metavar="N", help="Edge of a traced panel, pixels.")
@set_option
def passes(figure_id, profile, trace, whole, size, settings):
    """Print the pass sequence of figure ID: every command, and every state that differs from the default.

    Where the same few commands come for polygon after polygon, they are printed once, and how often.
    """
    from fixedpipe.effects.cli.refusal import check_size
    from fixedpipe.effects.figures import FIGURES
    from fixedpipe.effects.refusal import choose, refusals
    from fixedpipe.effects.reports.files import writable_folder
    from fixedpipe.effects.technique import INDEX
    from fixedpipe.pipeline.description.describe import describe
    from fixedpipe.pipeline.profiles import PROFILES

    figure = choose("figure", figure_id, FIGURES)
    key = profile or figure.machines[0]
    machine = choose("profile", key, PROFILES)
    check_size(figure.id, figure.columns, size or figure.size, machine)
    with refusals():
        method = figure.method(key)
        changes = changes_of(settings, figure, (method,))
        commands = figure.commands(machine, size, method, **changes)
    if trace is not None:
        _check_trace(figure, machine, len(commands), size or figure.size)
        writable_folder(trace)
    click.echo(f"{figure.id}: {figure.title} ({', '.join(figure.techniques)})")
    changed = f", with {figure.said(method, changes)}" if changes else ""
    click.echo(f"on {machine.name}: {method.name}{changed}\n")
    click.echo(describe(commands, folded=not whole))
    click.echo(f"{INDEX} says what the ids in brackets are.", err=True)
    if trace is not None:
        with refusals():
            names = _write_trace(commands, machine, figure.dimensions(size), trace)
        click.echo(f"\n{len(names)} pictures in {trace}: {names[0]} to {names[-1]}")


def _check_trace(figure, machine, commands, size):
    """Raise Refusal where the framebuffers of so many commands would not fit into memory."""
    from fixedpipe.effects.refusal import Refusal

    width, height = figure.dimensions(size)
    needed = commands * width * height * _SNAPSHOT_BYTES
    if needed > _MOST_BYTES:
        fits = int(size * (_MOST_BYTES / needed) ** 0.5)
        instead = f"--size {fits} or less, or another --profile" if fits else "another --profile"
        raise Refusal(
            f"{figure.id} on the {machine.name} has {commands} commands; their framebuffers of "
            f"{width}x{height} pixels take {needed / 2**30:.0f} GiB of memory. Give {instead}."
        )


def _write_trace(commands, machine, dimensions, folder):
    """Write the snapshots' pictures, ``03-Draw-depth.png`` and so on; returns their names in order."""
    from pathlib import Path

    from fixedpipe.effects.reports.files import write_whole
    from fixedpipe.pipeline.execution.machine import execute
    from fixedpipe.pipeline.framebuffers.pictures import png

    folder, names = Path(folder), []
    snapshots = execute(commands, machine, *dimensions, trace=True).trace
    digits = max(2, len(str(len(snapshots) - 1)))
    for number, snapshot in enumerate(snapshots):
        for buffer, picture in snapshot.pictures().items():
            names.append(f"{number:0{digits}d}-{snapshot.kind}-{buffer}.png")
            write_whole(folder / names[-1], png(picture))
    return names
