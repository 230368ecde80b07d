"""``fixedpipe inspect``: everything that happened to a pixel, command by command and stage by stage."""

import click

from fixedpipe.effects.cli.options import changes_of, set_option


@click.command(short_help="Everything that happened to a pixel, every number of it.")
@click.argument("what", metavar="ID|SCRIPT.py")
@click.option(
    "--pixel", metavar="X,Y", required=True, help="From the top left, as in the picture; y downwards."
)
@click.option("--profile", metavar="NAME", help="Machine; otherwise the figure's own, or the script's.")
@click.option("--size", type=click.IntRange(min=1), metavar="N", help="Pixels an edge of a figure's panel.")
@click.option("--command", "number", type=click.IntRange(min=0), metavar="K", help="This command alone.")
@click.option("--surface", metavar="NAME", help="A pbuffer instead of the window.")
@click.option("--json", "json_file", metavar="FILE", help="Write the history as JSON.")
@click.option("--html", "html_file", metavar="FILE", help="Write it as a page: one file, without scripts.")
@set_option
def inspect(what, pixel, profile, size, number, surface, json_file, html_file, settings):
    """Tell what happened to a pixel of figure ID, or of the frame that SCRIPT.py makes.

    Every command that touched it, every fragment there and every stage of each: what the machine read and
    made, as codes and as values, the guided ideal's values, and how much of the error each stage adds, by
    cause.

    A script defines `commands`, `profile` (a Profile or its name), `width` and `height`.
    """
    import json

    from rich.console import Console

    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.cli.history_text import history_text
    from fixedpipe.effects.refusal import Refusal, refusals
    from fixedpipe.pipeline.inspection.history import to_json
    from fixedpipe.pipeline.inspection.inspect import history

    where = _pixel(pixel)
    of = (
        _script(what, profile, size, settings)
        if what.endswith(".py")
        else _figure(what, profile, size, settings)
    )
    announce_compiling()
    with refusals():
        frame, ideal = of.run(surface)
        found = history(frame, where, surface, ideal)
    if number is not None:
        found = _only(found, number, frame)
    if json_file:
        _write(json_file, json.dumps(to_json(found), indent=1) + "\n")
    if html_file:
        from fixedpipe.pipeline.inspection.page import history_page

        _write(html_file, history_page(found, of.title))
    if not (json_file or html_file):
        console = Console(highlight=False)
        console.print(of.title, style="bold", markup=False)
        console.print(history_text(found), soft_wrap=True)
    for file in filter(None, (json_file, html_file)):
        click.echo(f"wrote {file}", err=True)
    if not found.touched:
        raise Refusal("No command touched this pixel; it holds what an empty framebuffer holds.")


class _Frame:
    """A frame to look into: a title, and how it runs."""

    def __init__(self, title, machine, size, commands, ideal):
        self.title, self.machine, self.size, self.commands, self.ideal = title, machine, size, commands, ideal

    def run(self, surface):
        """The RecordedFrame, and the RecordedIdeal where there is one."""
        from fixedpipe.pipeline.inspection.ideal import record_ideal
        from fixedpipe.pipeline.inspection.recording import record
        from fixedpipe.pipeline.profiles import IDEAL
        from fixedpipe.pipeline.validation.validate import validate
        from fixedpipe.pipeline.validation.walk import UnsupportedState

        frame = record(self.commands, self.machine, *self.size)
        if surface is not None:
            return frame, None
        try:
            validate(self.ideal, IDEAL, *self.size)
        except UnsupportedState:  # what only machines draw
            return frame, None
        return frame, record_ideal(self.ideal, frame, self.commands)


def _pixel(text):
    from fixedpipe.effects.refusal import Refusal

    x, comma, y = text.partition(",")
    try:
        if comma:
            return int(x), int(y)
    except ValueError:
        pass
    raise Refusal(f"--pixel is {text!r}; give two whole numbers, as 120,48.")


def _figure(figure_id, profile, size, settings):
    from fixedpipe.effects.cli.options import machine_of
    from fixedpipe.effects.cli.refusal import check_size
    from fixedpipe.effects.figures import FIGURES
    from fixedpipe.effects.refusal import choose, refusals
    from fixedpipe.pipeline.profiles import IDEAL

    figure = choose("figure", figure_id, FIGURES)
    machine = machine_of(profile or figure.machines[0])
    dimensions = figure.dimensions(size)
    check_size(figure.id, dimensions, machine)
    with refusals():
        method = figure.method_for(machine)
        changes = changes_of(settings, figure, (method,))
        commands = figure.commands(machine, size, method, **changes)
        ideal = figure.commands(IDEAL, size, method, **changes)
    changed = f", with {figure.said(method, changes)}" if changes else ""
    title = f"{figure.id}: {figure.title}, on {machine.name}: {method.name}{changed}"
    return _Frame(title, machine, dimensions, commands, ideal)


def _script(path, profile, size, settings):
    import runpy

    from fixedpipe.effects.cli.options import machine_of
    from fixedpipe.effects.refusal import Refusal

    if size is not None or settings:
        raise Refusal("--size and --set are a figure's; a script says its own width, height and values.")
    try:
        made = runpy.run_path(path)
    except OSError as error:
        raise Refusal(f"{path} cannot be read: {error.strerror}.") from None
    except Exception as error:
        raise Refusal(f"{path} raised {type(error).__name__}: {error}") from error
    missing = [name for name in ("commands", "width", "height") if name not in made]
    if missing or not (profile or "profile" in made):
        names = ", ".join(missing or ("profile",))
        raise Refusal(f"{path} does not define {names}; it needs commands, profile, width and height.")
    machine = profile or made["profile"]
    machine = machine_of(machine) if isinstance(machine, str) else machine
    commands = tuple(made["commands"])
    return _Frame(path, machine, (made["width"], made["height"]), commands, commands)


def _only(found, number, frame):
    from dataclasses import replace

    from fixedpipe.effects.refusal import Refusal

    if number >= found.commands:
        raise Refusal(f"There is no command {number}; the commands' numbers are 0 to {found.commands - 1}.")
    touched = tuple(touched for touched in found.touched if touched.number == number)
    if not touched:
        label = frame.steps[number].command.label
        numbers = ", ".join(str(each.number) for each in found.touched) or "none"
        raise Refusal(f'Command {number}, "{label}", did not touch this pixel; these did: {numbers}.')
    return replace(found, touched=touched)


def _write(path, text):
    from pathlib import Path

    from fixedpipe.effects.refusal import Refusal

    try:
        Path(path).write_text(text, encoding="utf-8")
    except OSError as error:
        raise Refusal(f"{path} cannot be written: {error.strerror}.") from None
