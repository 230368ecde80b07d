"""``fixedpipe print``: compose a figure or a frame for a page or a slide, with labels and its source."""

from pathlib import Path

import click

from fixedpipe.effects.cli.frames import is_own_frame, script_frame
from fixedpipe.effects.cli.options import changes_of, refuse_ignored, set_option, threads_option

_STYLES = "paper: 170 mm wide, white, the caption below; slide, light-slide: 16:9, the title on top"

# What a sheet needs beside the machine's picture, and the pictures that need it.
_NEEDED = {"ideal": {"ideal", "difference"}, "reference": {"reference", "reference-difference"}}


@click.command(short_help="Compose a figure for a page or a slide: PNG, PDF or SVG.")
@click.argument("what", metavar="ID|SCRIPT.py|TRACE#N")
@click.option(
    "--profile", metavar="NAME", help="The machine, or IDEAL. Default: the figure's own, or the script's."
)
@click.option("--style", metavar="STYLE", default="paper", show_default=True, help=f"{_STYLES}.")
@click.option("--width", type=float, metavar="MM", help="Width of the sheet. Default: the style's.")
@click.option(
    "--dpi",
    type=float,
    metavar="N",
    help="Dots per inch of a PNG file. Default: the smallest number with which the panels fill the sheet.",
)
@click.option(
    "--pictures",
    metavar="NAME,...",
    help="Any of machine, ideal, reference, difference, reference-difference. Default: machine, reference "
    "(or ideal) and their difference; for a diagram and on a slide, machine only.",
)
@click.option(
    "--palette",
    type=click.Choice(["screen", "paper"]),
    default="screen",
    show_default=True,
    help="Colours of a diagram. screen: on a dark background, as in the gallery. paper: on white, darker.",
)
@click.option(
    "--out",
    metavar="FILE",
    help="A .png, .pdf or .svg file. Default: a PNG file named after the figure or script and the machine.",
)
@click.option(
    "--size", type=click.IntRange(min=1), metavar="N", help="Height of the figure's panels in pixels."
)
@set_option
@threads_option
def print(what, profile, style, width, dpi, pictures, palette, out, size, settings, threads):
    """Put pictures of figure ID on one sheet, with labels and their source. Or put machine, ideal and
    difference there, of the frame that SCRIPT.py makes or of frame N of a recorded program.

    No pixel is filtered. A PNG file shows each pixel of the figure as a square of whole pixels. PDF and SVG
    files hold the figure's own pixels.

    The file's own fields hold the caption, the command and the paper's BibTeX entry. A file that ends in .bib
    has the entry too.

    A script defines `commands`, `profile` (a Profile or its name), `width` and `height`, and has no paper.
    The command needs matplotlib: pip install 'fixedpipe[plots]'.
    """
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.cli.progress import progress_of_long
    from fixedpipe.effects.presentation.pictures import is_diagram, names_of
    from fixedpipe.effects.presentation.sheet import asked_of, sheet
    from fixedpipe.effects.presentation.sheet_files import KINDS, file_of
    from fixedpipe.effects.presentation.typesetting import drawing_library
    from fixedpipe.effects.refusal import Refusal, refusals
    from fixedpipe.effects.reports.files import writable_file, write_whole
    from fixedpipe.effects.reports.letters import labels_of, without_letters
    from fixedpipe.effects.reports.paper_palette import with_paper_palette
    from fixedpipe.pipeline.profiles import PROFILES

    look, _ = asked_of(style, width, dpi)
    of_script = is_own_frame(what)
    figure, machine, method, changes, stem = (_script if of_script else _figure)(
        what, profile, size, settings
    )
    if palette == "paper":
        if not any(is_diagram(figure, PROFILES[key]) for key in figure.machines[:1]):
            raise Refusal(f"{figure.id} is no diagram, and only diagrams have palettes; leave out --palette.")
        method = with_paper_palette(method)
    named = None if pictures is None else tuple(word.strip() for word in pictures.split(","))
    names = names_of(figure, machine, named, look.fixed)
    name = Path(out or f"{stem}-{style}.png")
    kind = name.suffix.lower().removeprefix(".")
    if kind not in KINDS:
        raise Refusal(f"The name {name} must end with one of .{', .'.join(KINDS)}.")
    if kind != "png":
        refuse_ignored(
            click.get_current_context(),
            ("dpi",),
            f"a {kind.upper()} file keeps pixels as they are; leave it out",
        )
    drawing_library()
    path, beside = writable_file(name), writable_file(name.with_suffix(".bib"))
    announce_compiling()
    beside_it = [what for what, of in _NEEDED.items() if of & {*names}]
    with progress_of_long(2 + len(beside_it)) as step, refusals():
        step(f"{figure.id} on {machine.name}")
        # The sheet draws letters in its own type, so the machine does not draw them.
        commands = figure.commands(machine, size, method, **changes)
        letters = labels_of(commands, figure.dimensions(size)[1]) or ()
        if palette == "paper":  # dark letters may stand over a dark picture
            letters = [{"halo": "#ffffff", **label} for label in letters]
        bare = without_letters(method) if letters else method
        drawn = figure.render(machine, size, method=bare, threads=threads, **changes)
        for what in beside_it:  # reading the attribute computes it
            step(f"the {what}")
            getattr(drawn, what)
        step("the sheet")
        asked = {"style": style, "width": width, "dpi": dpi, "pictures": named, "palette": palette}
        composed = sheet(drawn, kind, **asked, letters=letters)
    write_whole(path, file_of(composed, kind))
    write_whole(beside, composed.bib.encode())
    click.echo(f"{path}: {composed.said}")
    entry = (
        "its caption and its command"
        if of_script
        else "its caption, its command and the paper's BibTeX entry"
    )
    click.echo(f"{beside}: {entry}")


def _figure(figure_id, profile, size, settings):
    """(Figure, machine, its Method, changed parameters, name for a file of it)."""
    from fixedpipe.effects.cli.refusal import check_size
    from fixedpipe.effects.figures import FIGURES
    from fixedpipe.effects.refusal import choose, refusals
    from fixedpipe.effects.reports.figure_record import variant_name
    from fixedpipe.pipeline.profiles import PROFILES

    figure = choose("figure", figure_id, FIGURES)
    key = profile or figure.machines[0]
    machine = choose("profile", key, PROFILES)
    with refusals():
        method = figure.method(key)
    changes = changes_of(settings, figure, (method,))
    check_size(figure.id, figure.dimensions(size), machine)
    return figure, machine, method, changes, f"{variant_name(figure, changes)}-{key}"


def _script(path, profile, size, settings):
    """As ``_figure``, for the frame of a script: a Figure that belongs to no paper."""
    from fixedpipe.effects.figures import Figure, Method
    from fixedpipe.effects.refusal import choose, refusals
    from fixedpipe.pipeline.profiles import PROFILES
    from fixedpipe.pipeline.validation.validate import validate

    of = script_frame(path, profile, size, settings, lambda key: choose("profile", key, PROFILES))
    method = Method("the script's commands", lambda profile, size: of.commands, ())
    with refusals():
        validate(of.commands, of.machine, *of.size)
        figure = Figure(
            id=path,
            title="A script's frame",
            caption=f"The frame that {Path(path).name} makes.",
            must_see="",
            source="",
            techniques=(),
            size=of.size[1],
            aspect=of.size,
            methods=(method,),
            acceptance=lambda figure, renderer: (),
        )
    key = next((key for key, known in PROFILES.items() if known == of.machine), "own-machine")
    return figure, of.machine, method, {}, f"{Path(path).stem}-{key}"
