"""``fixedpipe roughness``: make mip-maps of the bumps and of the roughness of a user's heights."""

import click

from fixedpipe.effects.cli.options import fill_option, limit_option


@click.command(short_help="Filter a bump map, and keep the roughness that filtering removes.")
@click.argument("heights")
@click.option("--out", metavar="FILE.npz", required=True, help="Write the levels as arrays.")
@click.option("--picture", "shown", metavar="FILE.png", help="Also write the levels as a picture.")
@click.option(
    "--size",
    type=int,
    metavar="N",
    help="Width and height in texels, a power of two. Default: the heights' own.",
)
@click.option(
    "--height-scale",
    type=float,
    metavar="H",
    default=0.05,
    show_default=True,
    help="Height from the lowest to the highest point, in edges of the field.",
)
@limit_option
@fill_option
@click.option("--once", is_flag=True, help="The map does not repeat, so its edges are not wrapped.")
def roughness(heights, out, shown, size, height_scale, once):
    """Filter the bumps of HEIGHTS, a PNG, TIFF, JPEG or NPY file or a sample, and keep what filtering loses.

    The heights become a square map of offset vectors (the slopes with opposite signs) and its mip-map. Each
    level also has the covariance of the offsets that filtering removed: K = [a b; b c], D with D D^T = K, and
    I_1, the largest deviation (Schilling 1997).

    For each level L the NPZ file has offsets_L, covariance_L (a, b, c), deviations_L (d_1, d_2, d_3),
    isotropic_L and bytes_L. The last is D in bytes over `scale`: d_1 and d_3 from 0 to 255, d_2 from 1 to 255
    with zero at 128. Arrays have their bottom row first. The picture shows the levels side by side, with the
    bumps' normals above and D below.

    The samples are those of fixedpipe bump; sample:jacksboro is an elevation model.
    """
    import io
    from pathlib import Path

    import numpy as np

    from fixedpipe.effects.refusal import Refusal, refusals
    from fixedpipe.effects.reports.files import writable_file, writable_picture, write_whole
    from fixedpipe.effects.user_pictures import maps
    from fixedpipe.effects.user_pictures import roughness as found
    from fixedpipe.pipeline.framebuffers.pictures import png

    if Path(out).suffix.lower() != ".npz":
        raise Refusal(f"The levels are written as NPZ; name them FILE.npz, not {out}.")
    path = writable_file(out)
    picture = None if shown is None else writable_picture(shown, (heights,))
    with refusals():
        field = maps.height_field(heights)
        levels = found.pyramids(field, size, height_scale, repeated=not once)
        file = io.BytesIO()
        np.savez(file, **found.arrays(levels))
    write_whole(path, file.getvalue())
    if picture is not None:
        write_whole(picture, png(found.picture(levels)))
    click.echo(found.levels_in_words(levels))
    click.echo(f"{path}: {len(levels)} levels; one in bytes is {found.largest(levels):.4g}")
    if picture is not None:
        click.echo(f"{picture}: bumps above, D below")
