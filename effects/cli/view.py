"""``fixedpipe view``: draw a frame live in a browser, while the user changes light, camera and machine."""

import click

from fixedpipe.effects.cli.options import refuse_ignored, set_option, threads_option

_NEEDED = ("starlette", "uvicorn", "websockets")
_USUAL = "F004-4"
_MATERIAL = "ward"


@click.command(short_help="Draw a frame live in a browser: move its light, camera and machine.")
@click.argument("what", required=False, metavar="[ID|FILE.py|MESH|TRACE#N]")
@click.option(
    "--material",
    metavar="NAME",
    help=f"The material of a MESH, from fixedpipe material --list. Default: {_MATERIAL}.",
)
@click.option("--profile", metavar="NAME", help="The machine. Default: the frame's own.")
@click.option("--size", type=click.IntRange(min=8), metavar="N", help="Height of a panel in pixels.")
@click.option(
    "--port",
    type=click.IntRange(1, 65535),
    metavar="N",
    help="The port of 127.0.0.1. Default: any free port.",
)
@click.option(
    "--token",
    metavar="WORD",
    help="The secret in the address, 16 characters or more. Default: a new one. With --port and --token, an "
    "open window finds a viewer that was started again.",
)
@click.option("--no-browser", is_flag=True, help="Print the address, but open no browser.")
@click.option("--once", is_flag=True, help="End when the last window is closed.")
@threads_option
@set_option
def view(what, material, profile, size, port, token, no_browser, once, threads, settings):
    """Show figure ID (default: F004-4) in your browser. The machine draws it again while you change it.

    FILE.py is a script that defines `commands`, `profile`, `width` and `height`, or one that holds your
    FIGURE. MESH is plane, sphere, torus, teapot, or an OBJ or PLY file, with a --material. TRACE#N is frame N
    of a recorded program.

    Drag to turn the light or the camera. Move the divider between machine and ideal, step through the passes,
    or click a pixel for its history. The window saves scripts and pictures as downloads; the viewer itself
    writes no file.

    The viewer listens on 127.0.0.1 only, and only the address that it prints opens it. Ctrl-C ends it.
    """
    from importlib.util import find_spec

    from fixedpipe.effects.refusal import Refusal

    missing = [name for name in _NEEDED if find_spec(name) is None]
    if missing:
        raise Refusal(f"The viewer needs {', '.join(missing)}; install fixedpipe[view].")
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.refusal import refusals
    from fixedpipe.effects.viewer.mesh_subject import is_mesh
    from fixedpipe.effects.viewer.server import Server
    from fixedpipe.effects.viewer.studio import Studio
    from fixedpipe.effects.viewer.subjects import Subjects
    from fixedpipe.effects.viewer.views import View

    context = click.get_current_context()
    what = what or _USUAL
    if _is_directory(what):
        raise Refusal(f"{what} is a directory; give a figure's id, or a script, a mesh or a trace in it.")
    if is_mesh(what):
        refuse_ignored(context, ("settings",), "a mesh's values are set in the window; leave it out")
        subject = _mesh(what, material or _MATERIAL, size)
    else:
        refuse_ignored(context, ("material",), f"{what} is no mesh; leave it out, or name a mesh")
        subject = _frame(what, profile, size, settings)
    from_package = not (is_mesh(what) or _is_file(what))
    studio = Studio(Subjects([subject], figures=from_package), threads)
    start = View(subject.id, profile or subject.machines[0])
    with refusals():
        studio.subject(start)
        studio.about(start)
    server = Server(studio, start, port or 0, token, once)
    announce_compiling(None)
    try:
        with refusals():
            studio.commands(start)
        click.echo(f"{subject.title}\n{server.address}")
        click.echo(
            "Ctrl-C ends the viewer." if not once else "It ends when its last window is closed.", err=True
        )
        server.run(ready=lambda: None if no_browser else _open(server.address))
    except KeyboardInterrupt:
        pass
    click.echo("The viewer has ended.", err=True)


def _open(address):
    import threading
    import webbrowser

    threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()


def _is_directory(what):
    """Whether a word names a directory, and neither a figure nor a mesh of the package."""
    import os

    from fixedpipe.effects.figures import FIGURES
    from fixedpipe.effects.user_pictures.shown_material import MESHES

    return os.path.isdir(what) and what not in FIGURES and what not in MESHES


def _is_file(what):
    from fixedpipe.effects.cli.frames import is_own_frame

    return is_own_frame(what)


def _mesh(what, material, size):
    from fixedpipe.effects.viewer.mesh_subject import mesh_subject

    return mesh_subject(what, material, size or 0)


def _frame(what, profile, size, settings):
    """The subject of a figure, of a script or of a trace. Raises Refusal."""
    from fixedpipe.effects.reports.own_figures import figure_of

    if not _is_file(what):
        return _figure(figure_of(what), size, settings)
    if what.endswith(".py") and _holds_figure(what):
        return _figure(figure_of(what), size, settings, what)
    return _own(what, profile, size, settings)


def _holds_figure(path):
    """Whether the source of a file assigns FIGURE at the top level of its module. The file is not run."""
    import ast

    try:
        with open(path, "rb") as file:
            tree = ast.parse(file.read())
    except (OSError, SyntaxError, ValueError):
        return False  # the error is reported when the file is run
    named = (target for node in tree.body if isinstance(node, ast.Assign) for target in node.targets)
    return any(isinstance(target, ast.Name) and target.id == "FIGURE" for target in named)


def _figure(figure, size, settings, path=""):
    from fixedpipe.effects.cli.options import changes_of
    from fixedpipe.effects.viewer.subjects import FigureSubject

    changes_of(settings, figure, figure.methods[:1])  # raises Refusal for wrong settings
    given = dict(setting.partition("=")[::2] for setting in settings)
    given = {name.strip(): text.strip() for name, text in given.items()}
    return FigureSubject(figure, given, size or 0, path)


def _own(what, profile, size, settings):
    from fixedpipe.effects.cli.frames import script_frame
    from fixedpipe.effects.refusal import Refusal
    from fixedpipe.effects.replays.driving import frame_of_trace
    from fixedpipe.effects.viewer.subjects import FrameSubject
    from fixedpipe.effects.viewer.views import machines
    from fixedpipe.pipeline.profiles import PROFILES

    frame = script_frame(what, profile, size, settings)
    keys = [key for key, machine in machines().items() if machine == frame.machine]
    if not keys:
        raise Refusal(
            f"{what} draws on {frame.machine.name}, which is none of the machines here; give --profile NAME."
        )
    if what.endswith(".py"):
        imports = ("import runpy",)
        defining = (
            f"made = runpy.run_path({what!r})",
            "",
            "",
            "def commands_of(machine):",
            '    """The frame, the same for every machine."""',
            '    return tuple(made["commands"])',
            "",
            "",
        )
        return FrameSubject(what, what, frame.commands_of, frame.size, keys[0], imports, defining)
    path, number = _trace(what, frame.title)
    imports = ("from fixedpipe.effects.replays.driving import frame_of_trace",)
    defining = (
        "",
        "",
        "def commands_of(machine):",
        '    """The frame as this machine is asked to draw it; the ideal takes the view\'s machine\'s."""',
        "    drawing = profile if machine.arithmetic.exact else machine",
        f"    return frame_of_trace({path!r}, {number}, drawing)[0]",
        "",
        "",
    )
    own = PROFILES[keys[0]]

    def made(machine):
        return frame_of_trace(path, number, own if machine.arithmetic.exact else machine)[0]

    return FrameSubject(what, frame.title, made, frame.size, keys[0], imports, defining)


def _trace(what, title):
    """(file, number) of a frame of a trace, whose title ends in ", frame N, on MACHINE"."""
    import re

    number = int(re.findall(r", frame (\d+), on ", title)[-1])
    path, mark, after = what.rpartition("#")
    return (path if mark and after.isdigit() else what), number
