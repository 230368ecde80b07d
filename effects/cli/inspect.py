"""``fixedpipe inspect``: what happened to a pixel, command by command and stage by stage."""

import click

from fixedpipe.effects.cli.frames import (
    check_files,
    check_plots,
    frame_asked,
    sign_beside,
    what_if_of,
    what_if_options,
    write_file,
    write_rows,
)
from fixedpipe.effects.cli.options import refuse_ignored, set_option


@click.command(
    short_help="Show every number of a pixel, every register of a frame, and maps of what happened where."
)
@click.argument("what", metavar="ID|SCRIPT.py|TRACE#N")
@click.option(
    "--pixel", metavar="X,Y", help="The pixel, counted from the top left corner; y grows downwards."
)
@click.option(
    "--brief",
    is_flag=True,
    help="With --pixel: of each fragment only the stage that adds most to the error, and the first clamp.",
)
@click.option(
    "--row",
    type=click.IntRange(min=0),
    metavar="Y",
    help="Print machine and ideal along row Y, counted from the top.",
)
@click.option("--plot", metavar="FILE.png", help="With --row: draw both as lines; needs matplotlib.")
@click.option(
    "--registers", is_flag=True, help="Print what every register held after every stage, over the frame."
)
@click.option(
    "--map",
    "kind",
    metavar="KIND",
    help="Draw a map: clamps, overdraw, lambda, primitive, texels, stages, error, bits, depth or stencil.",
)
@click.option(
    "--attribution", is_flag=True, help="Print which cause adds most to the error: clamps, filters, bits."
)
@click.option("--stages", is_flag=True, help="With --attribution: compare the stages instead.")
@click.option(
    "--out", metavar="FILE", help="With --map: write its picture, the commands' maps one below the other."
)
@click.option("--profile", metavar="NAME", help="The machine. Default: the figure's first, or the script's.")
@click.option("--size", type=click.IntRange(min=1), metavar="N", help="Height of a figure's panel in pixels.")
@click.option(
    "--command", "number", type=click.IntRange(min=0), metavar="K", help="Look at this command only."
)
@click.option("--surface", metavar="NAME", help="Look at this pbuffer instead of the window.")
@click.option("--json", "json_file", metavar="FILE", help="Write the history, or the numbers, as JSON.")
@click.option("--csv", "csv_file", metavar="FILE", help="Write the numbers of a table or of maps as CSV.")
@click.option(
    "--html", "html_file", metavar="FILE", help="Write the history as a page: one file without scripts."
)
@what_if_options
@set_option
def inspect(what, pixel, row, registers, kind, attribution, out, number, **of):
    """Look into figure ID, into the frame that SCRIPT.py makes, or into frame N of a recorded program.

    --pixel prints every command that touched a pixel, every fragment there, and every stage of each fragment.
    For a stage it prints the inputs and results of the machine, as codes and as values, and the values of
    the guided ideal. It also says how much of the error the stage adds, by cause.

    --registers prints a line for every register after every stage: the least, greatest and mean value, the
    shares that were clamped, how many codes it used, and how many bits it leaves unused. --row prints the
    machine and the guided ideal along a row of the picture, which shows banding. --map draws where something
    happened, and names the pixel with most of it.

    --attribution prints the error of the whole picture. It then prints what is left of the error if one part
    of the machine is as exact as it can be. With --stages, the part is one stage, of all passes or of
    --command K.

    --bits, --without, --constant and --texture change the frame before you look into it. Alone, they print
    how the change affects the error. PART is combiner, texture, framebuffer or filter_fraction. --replace and
    --without CLAMP@STAGE change one stage, and print only how that affects the error. STAGE is a name that
    --attribution --stages prints, such as "texture unit 0", "general combiner 1" or "final combiner".

    A script defines `commands`, `profile` (a Profile or its name), `width` and `height`.
    """
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.refusal import Refusal

    asked = [
        name
        for name, given in (
            ("--pixel", pixel),
            ("--row", row),
            ("--registers", registers or None),
            ("--map", kind),
            ("--attribution", attribution or None),
        )
        if given is not None
    ]
    what_if = what_if_of(*(of[name] for name in ("bits", "without", "replace", "constant", "texture")))
    if len(asked) > 1 or not (asked or what_if):
        raise Refusal(
            "Give one of --pixel, --row, --registers, --map and --attribution. Or give only a change: "
            "--bits, --without, --replace, --constant or --texture. You gave "
            f"{' and '.join(asked) or 'none'}."
        )
    context = click.get_current_context()
    if pixel is None:
        refuse_ignored(
            context, ("surface", "html_file"), f"{(*asked, 'a change')[0]} is a table of the window"
        )
    else:
        refuse_ignored(context, ("csv_file",), "a pixel's history is no table; give --json")
    if pixel is None or of["json_file"] or of["html_file"]:
        refuse_ignored(context, ("brief",), "it is of a pixel's history in the terminal")
    if row is None:
        refuse_ignored(context, ("plot",), "it is of a row; give --row Y")
    of_stages = what_if is not None and bool(what_if["replaced"] or what_if["unclamped"])
    if of_stages and asked:
        raise Refusal(f"If you change a stage, only the error is printed; leave {asked[0]} out.")
    if of["stages"] and not attribution:
        raise Refusal("--stages belongs to --attribution; give that too.")
    if (attribution or row is not None or not asked) and not (of["stages"] or of_stages):
        refuse_ignored(context, ("number",), "the error is the whole picture's")
    if kind is None:
        refuse_ignored(context, ("out",), "it is a map's picture; give --map KIND")
    files = of["json_file"], of["csv_file"]
    where = _pixel(pixel) if pixel is not None else None
    check_plots("--plot", of["plot"])
    check_plots("--out", out)
    frame = frame_asked(what, of["profile"], of["size"], of["settings"])
    check_files(*files, of["html_file"], of["plot"], out)
    announce_compiling("portable")  # the column engine takes coverage from this engine
    before = None if asked else frame_error_of(frame)
    if what_if is not None:
        if any(part == "combiner" for part, _ in what_if["bits"]):
            click.echo(sign_beside(frame.machine), err=True)
        frame.change(what_if)
    if where is not None:
        _tell_pixel(frame, where, number, of["surface"], of["json_file"], of["html_file"], of["brief"])
    elif row is not None:
        write_rows(_tell_row(frame, row, of["plot"]), *files)
    elif registers:
        write_rows(_tell_registers(frame, number), *files)
    elif kind is not None:
        write_rows(_tell_maps(frame, kind, number, out), *files)
    elif attribution:
        write_rows(_tell_attribution(frame, of["stages"], number), *files)
    else:
        write_rows(_tell_change(frame, before, number), *files)


def _tell_pixel(of, where, number, surface, json_file, html_file, brief):
    import json

    from rich.console import Console

    from fixedpipe.effects.cli.history_text import history_text
    from fixedpipe.effects.refusal import Refusal, refusals
    from fixedpipe.pipeline.inspection.history import to_json
    from fixedpipe.pipeline.inspection.inspect import history
    from fixedpipe.pipeline.inspection.page import history_page

    with refusals():
        frame, ideal = of.run(surface)
        found = history(frame, where, surface, ideal)
    if number is not None:
        found = _only(found, number, frame)
    if json_file:
        write_file(json_file, json.dumps(to_json(found), indent=1) + "\n")
    if html_file:
        write_file(html_file, history_page(found, of.title))
    if not (json_file or html_file):
        console = Console(highlight=False)
        console.print(of.title, style="bold", markup=False)
        console.print(history_text(found, brief), soft_wrap=True)
    if not found.touched:
        raise Refusal("No command touched this pixel; it holds what an empty framebuffer holds.")


def _tell_row(of, row, plot):
    from fixedpipe.effects.refusal import Refusal, refusals
    from fixedpipe.effects.reports.rows import pixel_rows
    from fixedpipe.pipeline.inspection.what_if import frame_colors

    if row >= of.size[1]:
        raise Refusal(f"There is no row {row}; the rows of {of.size[1]} pixels are 0 to {of.size[1] - 1}.")
    with refusals():
        machine, ideal = (colors[row] for colors in frame_colors(of.commands, of.machine, *of.size))
    title = f"{of.title}, row {row}"
    click.echo(f"{title}\n{_ROW}")
    for name, drawn, meant in zip(("red", "green", "blue"), 255 * machine.T, 255 * ideal.T, strict=True):
        numbers = "".join(f"{value:10.3f}" for v in (drawn, meant) for value in (v.min(), v.max()))
        click.echo(f"{name:8}{numbers}{abs(drawn - meant).max():10.3f}{len(set(drawn)):12}")
    if plot is not None:
        from fixedpipe.effects.reports.row_picture import row_png

        write_file(plot, row_png(machine, ideal, title))
    return pixel_rows(machine, ideal)


_ROW = f"""\
1/255 of full intensity, the ideal not clamped; each pixel with --csv or --json

{"":8}{"machine":>20}{"ideal":>20}{"largest":>10}{"machine's":>12}
{"":8}{"least":>10}{"greatest":>10}{"least":>10}{"greatest":>10}{"apart":>10}{"values":>12}"""


def _tell_registers(of, number):
    from fixedpipe.effects.refusal import refusals
    from fixedpipe.effects.reports.rows import register_rows
    from fixedpipe.pipeline.inspection.registers import register_uses

    with refusals():
        uses = register_uses(of.commands, of.machine, *of.size)
    uses = _of_command(uses, number)
    click.echo(of.title)
    for last, use in zip((None, *uses), uses, strict=False):
        if last is None or last.command != use.command:
            click.echo(f"\ncommand {use.command}: {use.label}\n{_REGISTERS}")
        headroom = "" if use.headroom is None else use.headroom
        click.echo(
            f"{use.stage:22}{use.register:20}{use.least:8.3f}{use.greatest:9.3f}{use.mean:8.3f}"
            f"{_share(use.clamped_low)}{_share(use.clamped_high)}{use.codes:8} of {use.of:<5}{headroom:>5}"
        )
    return register_rows(uses)


_REGISTERS = " " * 45 + "least greatest    mean clamped low        high   codes     bits left"


def _share(share):
    return f"{share:12.2%}" if share else f"{'':12}"


def frame_error_of(of, number=None):
    """The Error of a FrameAsked. ``number``: the command whose stages are replaced; None: all commands."""
    from fixedpipe.effects.refusal import refusals
    from fixedpipe.pipeline.inspection.what_if import frame_error, with_stages

    given = of.commands, of.machine, *of.size
    with refusals():
        if of.exact or of.unclamped:
            return with_stages(*given, exact=of.exact, unclamped=of.unclamped, number=number)
        return frame_error(*given)


_UNIT = "Machine minus ideal, root mean square, 1/255 of full intensity"
_ERRORS = f"{'':28}{'shown':>9}{'red':>9}{'green':>9}{'blue':>9}{'largest':>9}{'computed':>10}"


def _errors(what, error, last=""):
    numbers = "".join(f"{255 * value:9.3f}" for value in (error.shown, *error.channels, error.largest))
    return f"{what:28}{numbers}{255 * error.computed:10.3f}{last}"


def _tell_change(of, before, number):
    from fixedpipe.effects.reports.rows import error_rows

    after = frame_error_of(of, number)
    click.echo(f"{of.title}\n{_UNIT}\n\n{_ERRORS}")
    click.echo(_errors("as it is", before))
    click.echo(_errors("changed", after))
    return error_rows(before, [("changed", after)])


def _tell_attribution(of, stages, number):
    from fixedpipe.effects.refusal import refusals
    from fixedpipe.effects.reports.rows import error_rows, share_gone
    from fixedpipe.pipeline.inspection.what_if import attribution, stage_attribution

    with refusals():
        if stages:
            own, found = stage_attribution(of.commands, of.machine, *of.size, number=number)
        else:
            own, found = attribution(of.commands_of, of.machine, *of.size)
    click.echo(f"{of.title}\n{_UNIT}\n{_most(own, found)}\n\n{_ERRORS}     goes")
    click.echo(_errors("as it is", own))
    for what, error in found:
        click.echo(_errors(what, error, f"{share_gone(error, own):9.1%}"))
    return error_rows(own, found)


def _most(own, found):
    """A sentence that names the one part or stage which causes most of the error."""
    from fixedpipe.effects.reports.rows import share_gone

    alone = ((what, share_gone(error, own)) for what, error in found if not what.startswith("all "))
    what, share = max(alone, key=lambda one: one[1])
    if share <= 0.0:
        return "No one thing, as exact as it can be, makes the error smaller."
    return f"Most of it goes with {what} alone: {share:.1%}."


def _tell_maps(of, kind, number, out):
    from fixedpipe.effects.refusal import Refusal, refusals
    from fixedpipe.effects.reports.rows import map_rows
    from fixedpipe.pipeline.inspection.maps import KINDS, SHARES, frame_maps

    with refusals():
        maps = frame_maps(of.commands, of.machine, *of.size, kind, ideal=of.ideal)
    click.echo(f"{of.title}\n{kind}: {KINDS[kind]}\n")
    maps = [each for each in maps if number in (None, each.command)]
    if not maps:
        raise Refusal(f"No fragment was made by {'any command' if number is None else f'command {number}'}.")
    for each in maps:
        numbers = ", ".join(
            f"{name} {100 * value:.4g} %" if name in SHARES else f"{name} {value:.4g}"
            for name, value in each.numbers().items()
        )
        # A map of texels has no pixels of the frame, and nobody looks for the pixel with the most bits.
        if kind not in ("texels", "bits") and "greatest" in each.numbers():
            numbers += " at pixel {},{}".format(*each.greatest_at())
        click.echo(f"command {each.command}: {each.label}\n    {numbers}")
    if out is not None:
        from fixedpipe.effects.reports.map_picture import maps_png

        shown = [(f"{each.command}: {each.label}", each.values) for each in maps]
        write_file(out, maps_png(shown, of.title, kind))
    return map_rows(maps)


def _pixel(text):
    from fixedpipe.effects.refusal import Refusal

    x, comma, y = text.partition(",")
    try:
        if comma:
            return int(x), int(y)
    except ValueError:
        pass
    raise Refusal(f"--pixel is {text!r}; give two whole numbers, as 120,48.")


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


def _of_command(uses, number):
    """The uses in command ``number``, or all if it is None. Raises Refusal if there are none."""
    from fixedpipe.effects.refusal import Refusal

    uses = [use for use in uses if number in (None, use.command)]
    if not uses:
        raise Refusal(f"No fragment was made by {'any command' if number is None else f'command {number}'}.")
    return uses
