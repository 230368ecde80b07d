"""``fixedpipe replay --beside mesa``: compare frames with the pictures that Mesa draws of them."""

import click


def check_beside(trace, size):
    """Raise Refusal if glretrace cannot draw the frames. It is called before anything is read."""
    from fixedpipe.effects.refusal import Refusal
    from fixedpipe.effects.replays.glretrace import missing

    if trace == "-":
        raise Refusal("--beside mesa reads the trace a second time, and - is read once; give a file.")
    if size is not None:
        raise Refusal("--beside mesa draws windows as the trace says; leave --size out.")
    if (lacking := missing()) is not None:
        raise Refusal(f"--beside mesa: {lacking}")


def tell_beside(files, records):
    """Compare the pictures that ``records`` name with Mesa's; print a line for each frame, and write both.

    Each record gets the result, under "mesa". Raises Refusal if glretrace fails.
    """
    import numpy as np
    from PIL import Image

    from fixedpipe.effects.refusal import Refusal
    from fixedpipe.effects.replays.beside import difference_picture, mesas_pictures
    from fixedpipe.effects.replays.glretrace import GlretraceError
    from fixedpipe.effects.reports.files import write_whole
    from fixedpipe.pipeline.framebuffers.pictures import png

    if not records:
        return
    try:
        found = mesas_pictures(files.trace, [record["seen_call"] for record in records])
    except GlretraceError as error:
        raise Refusal(f"--beside mesa: {error}") from None
    for record, mesa in zip(records, found, strict=True):
        with Image.open(record["picture"]) as picture:
            ours = np.asarray(picture.convert("RGB"))
        record["mesa"] = mesa.data(ours)
        where = ""
        if mesa.picture is not None:
            path = files.folder / f"{files.stem}-mesa-{record['frame']}.png"
            write_whole(path, png(mesa.picture))
            where = f"; {path}"
            if mesa.agreement(ours) is not None:
                path = files.folder / f"{files.stem}-{files.key}-{record['frame']}-difference.png"
                write_whole(path, png(difference_picture(ours, mesa.picture)))
                where += f", {path}"
        click.echo(f"frame {record['frame']} beside Mesa: {mesa.said(ours)}{where}")
