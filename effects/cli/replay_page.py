"""``fixedpipe replay --page FILE.html``: write a page of a trace's frames on several machines."""

import click


def write_page(trace, key, asked, file, threads):
    """Write the page, and print its name. Raises Refusal."""
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.refusal import Refusal
    from fixedpipe.effects.replays.glretrace import GlretraceError, missing
    from fixedpipe.effects.replays.page import trace_page
    from fixedpipe.effects.reports.files import writable_file, write_whole

    if trace == "-":
        raise Refusal("--page reads the trace once for each machine, and - is read once; give a file.")
    if not file.lower().endswith((".html", ".htm")):
        raise Refusal(f"The name {file} must end with .html.")
    path, lacking = writable_file(file), missing()
    announce_compiling()
    if lacking is not None:
        click.echo(f"Without Mesa's pictures: {lacking}", err=True)
    try:
        text = trace_page(trace, key, asked, mesa=lacking is None, threads=threads)
    except GlretraceError as error:
        click.echo(f"Without Mesa's pictures: {error}", err=True)
        text = trace_page(trace, key, asked, mesa=False, threads=threads)
    write_whole(path, text.encode())
    click.echo(f"{file} shows the frames; open it in a browser.")
