"""A frame that a subcommand looks into: a figure's, or the one that a script makes."""

import click

from fixedpipe.effects.cli.options import changes_of, machine_of


class FrameAsked:
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


def frame_asked(what, profile, size, settings):
    """The FrameAsked of figure ID or of SCRIPT.py. ``profile``: a machine's name, or None; ``size``, or None,
    and ``settings``: a figure's. Raises Refusal.
    """
    return (_script if what.endswith(".py") else _figure)(what, profile, size, settings)


def _figure(figure_id, profile, size, settings):
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
    return FrameAsked(title, machine, dimensions, commands, ideal)


def _script(path, profile, size, settings):
    import runpy

    from fixedpipe.effects.refusal import Refusal

    if size is not None or settings:
        raise Refusal("--size and --set are a figure's; a script says its own width, height and values.")
    try:
        made = runpy.run_path(path)
    except OSError as error:
        raise Refusal(f"{path} cannot be read: {error.strerror}.") from None
    except (Exception, SystemExit) as error:
        raise Refusal(f"{path} raised {type(error).__name__}: {error}") from error
    missing = [name for name in ("commands", "width", "height") if name not in made]
    if missing or not (profile or "profile" in made):
        names = ", ".join(missing or ("profile",))
        raise Refusal(f"{path} does not define {names}; it needs commands, profile, width and height.")
    machine = profile or made["profile"]
    machine = machine_of(machine) if isinstance(machine, str) else machine
    try:
        commands = tuple(made["commands"])
    except TypeError:
        raise Refusal(f"{path}: commands is {made['commands']!r}; give a list of commands.") from None
    return FrameAsked(path, machine, (made["width"], made["height"]), commands, commands)


def write_file(path, content):
    """Write text or bytes, and say so. Raises Refusal."""
    from pathlib import Path

    from fixedpipe.effects.refusal import Refusal

    try:
        Path(path).write_bytes(content if isinstance(content, bytes) else content.encode())
    except OSError as error:
        raise Refusal(f"{path} cannot be written: {error.strerror}.") from None
    click.echo(f"wrote {path}", err=True)
