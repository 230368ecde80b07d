"""``fixedpipe conformance``: redraw captures of a real chip and count the pixels that agree."""

import os
from pathlib import Path

import click

from effects.cli.options import threads_option

_HOW = (
    "Give the folder of captures: clone https://github.com/abaire/nxdk_pgraph_tests_golden_results and give "
    "its folder `results`, or set FIXEDPIPE_CAPTURES to it."
)


@click.command(short_help="Redraw captures of a real NV2A and count equal pixels.")
@click.argument("folder", required=False)
@click.option("--suite", multiple=True, metavar="NAME", help="Only this suite; several may be given.")
@click.option("--case", "pattern", metavar="TEXT", help="Only cases whose name contains TEXT.")
@click.option("--inputs", metavar="DIR", help="Textures and meshes that some cases read.")
@threads_option
def conformance(folder, suite, pattern, inputs, threads):
    """Redraw every capture in FOLDER that a suite covers and print pixels equal / compared."""
    import numpy as np
    from PIL import Image

    from effects.cli.refusal import Refusal
    from effects.conformance.case import Inputs
    from effects.conformance.redraw import compare, known_suites

    folder = folder or os.environ.get("FIXEDPIPE_CAPTURES")
    if not folder or not Path(folder).is_dir():
        raise Refusal(f"There is no folder {folder!r}. {_HOW}" if folder else _HOW)
    folder = Path(folder)
    beside = Path(inputs) if inputs else folder.parents[1] / "inputs"
    modules = known_suites()
    exact = covered = total = equal = compared = 0
    for path in sorted(folder.glob("*/*.png")):
        if (suite and path.parent.name not in suite) or (pattern and pattern not in path.stem):
            continue
        theirs = np.array(Image.open(path).convert("RGBA"))
        found = compare(
            path.parent.name, modules.get(path.parent.name), path.stem, theirs,
            Inputs(beside if beside.is_dir() else None), threads,
        )  # fmt: skip
        total, covered, exact = total + 1, covered + found.covered, exact + found.exact
        equal, compared = equal + found.pixels_equal, compared + found.pixels_compared
        state = f"{found.pixels_equal} / {found.pixels_compared}" if found.covered else "not covered"
        click.echo(f"{found.suite}/{found.name}: {state}{'  ' + found.note if found.note else ''}")
    click.echo(
        f"exact: {exact} of {covered} cases; pixels: {equal} of {compared}; not covered: {total - covered}"
    )
