"""``fixedpipe passes``: a frame's commands in words, and on request a picture after each of them."""

from dataclasses import dataclass

import click

from fixedpipe.effects.cli.frames import is_own_frame, script_frame
from fixedpipe.effects.cli.options import changes_of, refuse_ignored, set_option

# Limits of a trace without --all. Assumed: more files are too many to look at, more bytes too many to store.
_MOST_FILES, _MOST_BYTES = 1000, 4000 << 20


@click.command(short_help="Print the passes of a frame in words.")
@click.argument("what", metavar="ID|SCRIPT.py|TRACE#N")
@click.option(
    "--profile", metavar="NAME", help="The machine, or IDEAL. Default: the figure's own, or the script's."
)
@click.option(
    "--trace", metavar="DIR", help="Write colour, alpha, depth and stencil after each command as PNG."
)
@click.option(
    "--commands", "numbers", metavar="A:B", help="With --trace: only commands A to B, both included."
)
@click.option(
    "--every",
    type=click.IntRange(min=1),
    metavar="N",
    default=1,
    help="With --trace: only every N-th command.",
)
@click.option(
    "--ideal", is_flag=True, help="With --trace: also write machine, ideal and difference next to each other."
)
@click.option(
    "--all",
    "whole",
    is_flag=True,
    help="Print repeated commands too. With --trace: draw all commands, however many there are.",
)
@click.option(
    "--size", type=click.IntRange(min=1), metavar="N", help="With --trace: height of a panel in pixels."
)
@set_option
def passes(what, profile, trace, numbers, every, ideal, whole, size, settings):
    """Print the passes of figure ID, of the frame that SCRIPT.py makes, or of frame N of a recorded program:
    every command, and every state that differs from its default.

    If the same few commands repeat for polygon after polygon, they are printed once, with their number.

    --trace writes pictures and a page, index.html. Commands that draw nothing have no picture, and equal
    pictures are written once.

    A script defines `commands`, `profile` (a Profile or its name), `width` and `height`.
    """
    from fixedpipe.effects.reports.files import writable_folder
    from fixedpipe.effects.technique import INDEX
    from fixedpipe.pipeline.description.describe import describe

    if trace is None:
        names = "numbers", "every", "ideal"
        refuse_ignored(click.get_current_context(), names, "nothing is traced without --trace DIR; give one")
    of_script = is_own_frame(what)
    of = (_script if of_script else _figure)(what, profile, size, settings)
    if trace is not None:
        chosen = _chosen(numbers, every, len(of.commands))
        beside = _of_the_ideal(of) if ideal else None
        announcement, drawing = _planned(of, chosen, ideal, whole)
        folder = writable_folder(trace)
    click.echo(f"{of.heading}\non {of.machine.name}{of.by}\n")
    click.echo(describe(of.commands, folded=not whole))
    if not of_script:
        click.echo(f"{INDEX} says what the ids in brackets are.", err=True)
    if trace is not None:
        from fixedpipe.effects.cli.compiling import announce_compiling
        from fixedpipe.effects.cli.progress import progress

        announce_compiling()
        from fixedpipe.effects.reports.trace import Traced, write_trace

        click.echo(announcement, err=True)
        title = f"{of.name} on {of.machine.name}{of.by}"
        traced = Traced(title, of.machine, of.commands, of.size, beside)
        with progress(drawing * (1 + ideal)) as step:
            written = write_trace(traced, folder, chosen, step)
        click.echo(f"\n{written} pictures in {folder}; open {folder / 'index.html'}")


@dataclass(frozen=True)
class _Passes:
    """A frame to describe: its name, the line above its passes, the machine and the words after it.

    It also has (width, height), ``commands_of``, a function that returns the commands for a machine, and
    ``commands``, those for this machine.
    """

    name: str
    heading: str
    machine: object
    by: str
    size: tuple
    commands_of: object
    commands: tuple


def _script(path, profile, size, settings):
    from fixedpipe.effects.refusal import choose, refusals
    from fixedpipe.pipeline.profiles import PROFILES
    from fixedpipe.pipeline.validation.validate import validate

    of = script_frame(path, profile, size, settings, lambda key: choose("profile", key, PROFILES))
    with refusals():
        validate(of.commands, of.machine, *of.size)
    return _Passes(path, path, of.machine, "", of.size, of.commands_of, of.commands)


def _figure(figure_id, profile, size, settings):
    from fixedpipe.effects.cli.refusal import check_size
    from fixedpipe.effects.figures import FIGURES
    from fixedpipe.effects.refusal import choose, refusals
    from fixedpipe.pipeline.profiles import PROFILES

    figure = choose("figure", figure_id, FIGURES)
    machine = choose("profile", profile or figure.machines[0], PROFILES)
    dimensions = figure.dimensions(size)
    check_size(figure.id, dimensions, machine)
    with refusals():
        method = figure.method_for(machine)
        changes = changes_of(settings, figure, (method,))
        commands = figure.commands(machine, size, method, **changes)
    changed = f", with {figure.said(method, changes)}" if changes else ""
    return _Passes(
        figure.id,
        f"{figure.id}: {figure.title} ({', '.join(figure.techniques)})",
        machine,
        f": {method.name}{changed}",
        dimensions,
        lambda of: figure.commands(of, size, method, **changes),
        commands,
    )


def _chosen(text, every, commands):
    """The numbers of the commands that ``A:B`` and ``--every`` choose, as a range. Raises Refusal."""
    from fixedpipe.effects.refusal import Refusal

    first, colon, last = (text or ":").partition(":")
    try:
        begin = int(first or 0)
        end = begin if not colon else int(last) if last else max(begin, commands - 1)
    except ValueError:
        begin = end = -1
    if not 0 <= begin <= end:
        raise Refusal(f"--commands is {text!r}; give the first and the last command's number, as 10:60.")
    if begin >= commands:
        raise Refusal(f"--commands begins at {begin}; the commands' numbers are 0 to {commands - 1}.")
    return range(begin, min(end, commands - 1) + 1, every)


def _of_the_ideal(of):
    """The commands that the ideal evaluates for comparison. Raises Refusal if the ideal cannot draw the frame
    or draws it with other commands.
    """
    from fixedpipe.effects.refusal import Refusal, refusals
    from fixedpipe.pipeline.profiles import IDEAL
    from fixedpipe.pipeline.validation.validate import validate

    if of.machine.arithmetic.exact:
        raise Refusal(
            "--ideal shows a machine beside the ideal; give a machine as --profile, or leave it out."
        )
    with refusals():
        ideal = of.commands_of(IDEAL)
        validate(ideal, IDEAL, *of.size)
    if [type(c) for c in ideal] != [type(c) for c in of.commands]:
        raise Refusal(
            f"For {of.name} the ideal draws other commands than the {of.machine.name}; leave --ideal out."
        )
    return ideal


def _planned(of, chosen, ideal, whole):
    """(a sentence about the files to write, how many commands draw). Raises Refusal if it is too much."""
    from fixedpipe.effects.refusal import Refusal
    from fixedpipe.effects.reports.trace import plan
    from fixedpipe.pipeline.messages import count

    found = plan(of.commands, chosen, of.size, ideal)
    if not found.drawing:
        raise Refusal(f"None of the {count(found.commands, 'command')} chosen draws; choose others.")
    what = (
        f"{of.name} on the {of.machine.name} has {count(len(of.commands), 'command')}; of {found.commands} "
        f"chosen {found.drawing} draw, which is at most {found.files} files and "
        f"{-(-found.bytes // 1_000_000)} MB before compression"
    )
    if not whole and (found.files > _MOST_FILES or found.bytes > _MOST_BYTES):
        raise Refusal(
            f"{what}. Choose some with --commands 10:60 or --every {max(2, len(of.commands) // 100)}, make "
            "them smaller with --size, or write them with --all."
        )
    return f"{what}.", found.drawing
