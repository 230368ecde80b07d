"""``fixedpipe environment``: make cube maps, parabolic or filtered maps of a panorama or a light probe."""

import click

from fixedpipe.effects.cli.options import limit_option, refuse_ignored, threads_option

_KINDS = ("cube", "parabolic", "prefilter")
_LAYOUTS = ("latlong", "ball", "mirror", "cross", "strip")


@click.command(short_help="Make environment maps of a panorama or a light probe.")
@click.argument("image")
@click.option(
    "--to", "kind", metavar="KIND", required=True, help=f"{', '.join(_KINDS[:-1])} or {_KINDS[-1]}."
)
@click.option("--out", metavar="FILE", required=True, help="Write FILE.png, a picture, or FILE.npz, floats.")
@click.option(
    "--as",
    "layout",
    metavar="LAYOUT",
    help=f"Layout of IMAGE: {', '.join(_LAYOUTS[:-1])} or {_LAYOUTS[-1]}. Default: latlong if IMAGE is twice "
    "as wide as high, ball if it is square.",
)
@click.option(
    "--exponent",
    type=float,
    metavar="N",
    default=100.0,
    show_default=True,
    help="For --to prefilter: Phong's exponent. 1 is diffuse light.",
)
@click.option(
    "--size",
    type=click.IntRange(1, 1024),
    metavar="N",
    default=256,
    show_default=True,
    help="Width and height of a face or a disc in texels.",
)
@click.option(
    "--exposure",
    type=float,
    metavar="E",
    help="A number that multiplies a picture. Default: 1, or so that 99.5 % of it are below one.",
)
@limit_option
@threads_option
def environment(image, kind, out, layout, exponent, size, exposure, threads):
    """Make environment maps of IMAGE: a panorama, a light probe, or the faces of a cube.

    Radiance (.hdr) and OpenEXR (pip install 'fixedpipe[probes]') files keep their range. PNG, TIFF, JPEG and
    NPY files are read too. The middle of a panorama (--as latlong), or of a square light probe (--as ball),
    shows the direction -z. Other layouts are:

    \b
    --as mirror  the photograph of a mirroring ball from +z
    --as cross   six faces in 4:3 or 3:4, as --to cube draws them
    --as strip   +x, -x, +y, -y, +z and -z in 6:1 or 1:6, as textures are loaded

    An NPZ file has `faces`, float32 [6, N, N, 3] in the order +x, -x, +y, -y, +z, -z. For --to parabolic it
    has `discs`, [2, N, N, 3], of z <= 0 and z > 0. A picture shows a cross, or both discs.
    """
    import io
    from pathlib import Path

    import numpy as np

    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.refusal import Refusal, choose, refusals
    from fixedpipe.effects.reports.files import writable_file, write_whole
    from fixedpipe.effects.user_pictures import probes
    from fixedpipe.pipeline.framebuffers.pictures import png

    choose("kind of map", kind, dict.fromkeys(probes.KINDS))
    context = click.get_current_context()
    if kind != "prefilter":
        refuse_ignored(context, ("exponent", "threads"), f"{kind} does not filter; leave it out")
    ending = Path(out).suffix.lower()
    if ending not in (".png", ".npz"):
        raise Refusal(f"The maps are written as PNG or NPZ; name them FILE.png or FILE.npz, not {out}.")
    if ending == ".npz":
        refuse_ignored(context, ("exposure",), "an NPZ file has the floats as they are; leave it out")
    with refusals():
        probes.checked_exponent(exponent)
        if exposure is not None and not 0.0 < exposure < float("inf"):
            raise ValueError(f"The exposure is {exposure:g}; give a positive number.")
        found = probes.probe(image, layout)
        path = writable_file(out)
        if kind == "prefilter":
            announce_compiling()
        maps = probes.maps(found, kind, size, exponent, threads)
        brightest = float(maps.max())
        if ending == ".png":
            shown = exposure or probes.exposure_of(maps)
            data, said = png(probes.picture(maps, shown)), f"exposure {shown:.4g}"
        else:
            file = io.BytesIO()
            np.savez(file, **{"discs" if len(maps) == 2 else "faces": maps.astype(np.float32)})
            data, said = file.getvalue(), "floats"
    write_whole(path, data)
    click.echo(f"{image}: {found}")
    lobe = f", exponent {exponent:g}" if kind == "prefilter" else ""
    click.echo(
        f"{path}: {kind}{lobe}, {len(maps)} of {size}x{size} texels, brightest {brightest:.4g}, {said}"
    )
