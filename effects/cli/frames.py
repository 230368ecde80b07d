"""The frame that a subcommand examines: the frame of a figure, of a script or of a trace."""

import re

import click

from fixedpipe.effects.cli.options import changes_of, machine_of


class FrameAsked:
    """A frame that a user wants to examine: a title, a machine, a size and commands.

    ``commands_of``: a function that returns the commands for a machine, or for the ideal.
    """

    def __init__(self, title, machine, size, commands_of):
        from fixedpipe.pipeline.profiles import IDEAL

        self.title, self.machine, self.size, self.commands_of = title, machine, size, commands_of
        self.exact, self.unclamped = (), ()  # stages that are computed without rounding, or without a clamp
        self.commands, self.ideal = commands_of(machine), commands_of(IDEAL)

    def change(self, what_if):
        """Change the machine, the stages or the commands. ``what_if``: as ``what_if_of`` returns it. Raises
        Refusal.
        """
        from fixedpipe.effects.refusal import refusals
        from fixedpipe.pipeline.inspection import what_if as changes
        from fixedpipe.pipeline.profiles import IDEAL

        machine, commands_of = self.machine, self.commands_of
        self.exact, self.unclamped = tuple(what_if["replaced"]), tuple(what_if["unclamped"])
        with refusals():
            for part, bits in what_if["bits"]:
                machine = changes.with_bits(machine, part, bits)
            for name in what_if["without"]:
                machine = changes.without_clamp(machine, name)

            def changed(of):
                commands = commands_of(of)
                for number, color in what_if["constants"]:
                    commands = changes.with_constant(commands, number, color)
                for name, picture in what_if["textures"]:
                    commands = changes.with_texture(commands, name, picture)
                return commands

            self.machine, self.commands_of = machine, changed
            self.commands, self.ideal = changed(machine), changed(IDEAL)

    def run(self, surface):
        """(RecordedFrame, RecordedIdeal). The second is None for a pbuffer, or if the ideal cannot draw."""
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
        except UnsupportedState:  # only machines can draw this frame
            return frame, None
        return frame, record_ideal(self.ideal, frame, self.commands)


# A trace, and the number of a frame of it: FILE.trace#12. Without the number, the first frame that draws.
_TRACE = re.compile(r"(?P<path>.+)#(?P<number>\d+)|.+\.trace(?P<rest>#.*)?", re.DOTALL)
_MACHINE_OF_TRACES = "GEFORCE_256"


def is_own_frame(what):
    """Whether ``what`` names a script or a trace, and not a figure."""
    return what.endswith(".py") or _TRACE.fullmatch(what) is not None


def frame_asked(what, profile, size, settings):
    """The FrameAsked of figure ID, of SCRIPT.py or of FILE.trace#N. ``profile``: a machine's name, or None.
    ``size`` (or None) and ``settings`` are only for a figure. Raises Refusal.
    """
    return (script_frame if is_own_frame(what) else _figure)(what, profile, size, settings)


def _figure(figure_id, profile, size, settings):
    from fixedpipe.effects.cli.refusal import check_size
    from fixedpipe.effects.figures import FIGURES
    from fixedpipe.effects.refusal import choose, refusals

    figure = choose("figure", figure_id, FIGURES)
    machine = machine_of(profile or figure.machines[0])
    dimensions = figure.dimensions(size)
    check_size(figure.id, dimensions, machine)
    with refusals():
        method = figure.method_for(machine)
        changes = changes_of(settings, figure, (method,))
        changed = f", with {figure.said(method, changes)}" if changes else ""
        title = f"{figure.id}: {figure.title}, on {machine.name}: {method.name}{changed}"
        return FrameAsked(title, machine, dimensions, lambda of: figure.commands(of, size, method, **changes))


def _trace_frame(path, number, profile, profile_of):
    """The FrameAsked of a trace's frame, with the commands by which its machine draws it."""
    from fixedpipe.effects.replays.driving import frame_of_trace
    from fixedpipe.pipeline.profiles import PROFILES

    machine = profile_of(profile or _MACHINE_OF_TRACES)
    drawing = PROFILES[_MACHINE_OF_TRACES] if machine.arithmetic.exact else machine
    commands, width, height, found = frame_of_trace(path, number, drawing)
    title = f"{path}, frame {found}, on {machine.name}"
    return FrameAsked(title, machine, (width, height), lambda of: commands)


def script_frame(path, profile, size, settings, profile_of=machine_of):
    """The FrameAsked of SCRIPT.py or FILE.trace#N. ``profile_of`` returns the Profile of a name. Raises
    Refusal.
    """
    import runpy

    from fixedpipe.effects.refusal import Refusal, line_of

    if size is not None or settings:
        raise Refusal("--size and --set are a figure's; a script says its own width, height and values.")
    if (trace := _TRACE.fullmatch(path)) is not None and not path.endswith(".py"):
        if trace["rest"] is not None:
            raise Refusal(f"{path!r}: write the number of a frame, from 0, after #, as in game.trace#12.")
        number = trace["number"]
        return _trace_frame(trace["path"] or path, number and int(number), profile, profile_of)
    try:
        made = runpy.run_path(path)
    except OSError as error:
        raise Refusal(f"{path} cannot be read: {error.strerror}.") from None
    except (Exception, SystemExit) as error:
        raise Refusal(f"{path}{line_of(path, error)} raised {type(error).__name__}: {error}") from error
    from fixedpipe.pipeline.multi_draw import with_draws

    missing = [name for name in ("commands", "width", "height") if name not in made]
    if missing or not (profile or "profile" in made):
        names = ", ".join(missing or ("profile",))
        figure = " Its FIGURE is for figures, animate and parameters." * ("FIGURE" in made)
        raise Refusal(
            f"{path} does not define {names}; it needs commands, profile, width and height.{figure}"
        )
    machine = profile or made["profile"]
    machine = profile_of(machine) if isinstance(machine, str) else machine
    try:
        commands = with_draws(made["commands"])
    except TypeError:
        raise Refusal(f"{path}: commands is {made['commands']!r}; give a list of commands.") from None
    return FrameAsked(path, machine, (made["width"], made["height"]), lambda of: commands)


def what_if_options(command):
    """The options of a subcommand that change a frame. Each may be given several times."""
    options = (
        click.option(
            "--bits",
            multiple=True,
            metavar="PART=N",
            help="Another width of a part's numbers, 4 to 16 bits. Combiners have a sign in addition.",
        ),
        click.option(
            "--without",
            multiple=True,
            metavar="CLAMP[@STAGE]",
            help="Leave this clamp out, everywhere or in one stage.",
        ),
        click.option(
            "--replace", multiple=True, metavar="STAGE=IDEAL", help="Compute this stage without rounding."
        ),
        click.option(
            "--constant", multiple=True, metavar="K=R,G,B,A", help="Another constant colour; K is 0 or 1."
        ),
        click.option(
            "--texture", multiple=True, metavar="NAME=FILE", help="Another picture for the 2D texture NAME."
        ),
    )
    for option in reversed(options):
        command = option(command)
    return command


def what_if_of(bits, without, replace, constant, texture):
    """The values of ``what_if_options`` as ``FrameAsked.change`` takes them; None: none was given. Raises
    Refusal.
    """
    if not (bits or without or replace or constant or texture):
        return None
    example = '"general combiner 0=IDEAL"'
    return {
        "bits": [_assigned("--bits", text, "combiner=12", str, int) for text in bits],
        "without": [text for text in without if "@" not in text],
        "unclamped": [_stage_of_clamp(text) for text in without if "@" in text],
        "replaced": [_assigned("--replace", text, example, str, _the_ideal)[0] for text in replace],
        "constants": [_assigned("--constant", text, "1=0.5,0.5,0.5,1", int, _color) for text in constant],
        "textures": [_assigned("--texture", text, "normals=bumps.png", str, _picture) for text in texture],
    }


def sign_beside(machine):
    """A sentence about the width of combiners, which says that their bits do not include the sign."""
    own = machine.arithmetic.combiner_bits
    return (
        f"combiner: bits beside the sign. combiner={own}, registers of {own + 1} bits with the sign, is the "
        f"{machine.name} itself."
    )


def _assigned(option, text, example, name, value):
    from fixedpipe.effects.refusal import Refusal

    left, equals, right = text.partition("=")
    try:
        if equals:
            return name(left), value(right)
    except Refusal:
        raise
    except ValueError:
        pass
    raise Refusal(f"{option} is {text!r}; give it as in {option} {example}.")


# The clamps that --without can leave out in a single stage, and how the names of such stages begin.
_CLAMPS = {"GENERAL_COMBINER": "general combiner", "FINAL_COMBINER": "final combiner"}


def _stage_of_clamp(text):
    from fixedpipe.effects.refusal import Refusal

    clamp, _, stage = text.partition("@")
    if not stage.startswith(_CLAMPS.get(clamp.upper(), "?")):
        raise Refusal(
            f'--without is {text!r}; of one stage give "GENERAL_COMBINER@general combiner 0" (or 1, ...) or '
            '"FINAL_COMBINER@final combiner".'
        )
    return stage


def _the_ideal(text):
    if text.upper() != "IDEAL":
        raise ValueError
    return text


def _color(text):
    color = tuple(float(word) for word in text.split(","))
    if len(color) != 4:
        raise ValueError
    return color


def _picture(path):
    from fixedpipe.effects.user_pictures.inputs import read_picture

    picture = read_picture(path)[::-1]  # a texture's first row is its lowest
    return picture[..., None] if picture.ndim == 2 else picture


def check_files(*names):
    """Raise Refusal if one of these files cannot be written. It is called before anything is computed. A name
    may be None.
    """
    from fixedpipe.effects.reports.files import writable_file

    for name in filter(None, names):
        writable_file(name)


def check_plots(option, given):
    """Raise Refusal if ``option`` was given, which needs matplotlib, and matplotlib is not installed."""
    from importlib.util import find_spec

    from fixedpipe.effects.refusal import Refusal

    if given and find_spec("matplotlib") is None:
        raise Refusal(f"{option} needs matplotlib; install fixedpipe[plots], or leave it out.")


def write_file(name, content):
    """Write text or bytes to a file, and print its name. Raises Refusal."""
    from fixedpipe.effects.reports.files import writable_file, write_whole

    write_whole(writable_file(name), content if isinstance(content, bytes) else content.encode())
    click.echo(f"wrote {name}", err=True)


def write_rows(rows, json_file, csv_file):
    """Write rows to the files of ``--json`` and ``--csv``, if they were given. Raises Refusal."""
    from fixedpipe.effects.reports.rows import csv_text, json_text

    if json_file:
        write_file(json_file, json_text(rows))
    if csv_file:
        write_file(csv_file, csv_text(rows))
