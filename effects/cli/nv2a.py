"""``fixedpipe nv2a``: draw a frame of the NV2A's register words, vertices and memory."""

import click


@click.command(short_help="Draw a frame of NV2A registers, vertices and memory that an emulator logged.")
@click.argument("file", metavar="FRAME.nv2a")
@click.option(
    "--out", metavar="FILE.png", help="Write the picture. Without it, the command only prints what is drawn."
)
@click.option(
    "--script", metavar="FILE.py", help="Write the frame as a script for fixedpipe inspect and compare."
)
@click.option(
    "--threads",
    type=click.IntRange(min=1),
    metavar="N",
    help="How many threads draw. Any number gives the same bits.",
)
def nv2a(file, out, script, threads):
    """Draw FRAME.nv2a on the NV2A. The file has register words, vertices and memory, in the format of
    docs/nv2a-frames.md.

    An emulator writes such files with one C header, docs/examples/nv2a_frame.h. Vertices are the results of
    vertex programs. --script writes the frame's commands as a script. fixedpipe inspect reads it, and shows
    why a pixel has its colour.
    """
    from pathlib import Path

    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.cli.frames import check_files, write_file
    from fixedpipe.effects.nv2a_frames.reading import MOST_BYTES, read_frame
    from fixedpipe.effects.refusal import Refusal, refusals
    from fixedpipe.effects.replays.scripts import npz_beside, npz_bytes, script_text
    from fixedpipe.effects.reports.files import writable_picture
    from fixedpipe.pipeline.framebuffers.pictures import png

    try:
        with Path(file).open("rb") as opened:
            data = opened.read(MOST_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise Refusal(f"{file!r} cannot be read: {reason}.") from error
    frame = read_frame(data, file)
    if out is not None:
        writable_picture(out, (file,))
    if script is not None and not script.endswith(".py"):
        raise Refusal(f"--script is {script!r}; name a file that ends with .py.")
    check_files(script)
    announce_compiling()
    with refusals():
        image = frame.image(threads)
    kinds = [type(command).__name__ for command in frame.commands]
    counts = ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds)) or "nothing"
    click.echo(f"{file}: {frame.width}x{frame.height} pixels, {counts}")
    if out is not None:
        write_file(out, png(image))
    if script is not None:
        text, arrays = script_text(frame.commands, "NV2A", frame.width, frame.height, file)
        write_file(script, text)
        write_file(str(npz_beside(Path(script))), npz_bytes(arrays))
