"""``fixedpipe selftest``: check that this computer, with its installed packages, draws the accepted bits."""

import json
from dataclasses import asdict

import click

from fixedpipe.effects.cli.compiling import announce_compiling


@click.command(short_help="Check that this computer draws the accepted bits.")
@click.option(
    "--cpus",
    is_flag=True,
    help="Also compile the kernels for up to five other processors, and draw on 1 to 8 threads: minutes.",
)
@click.option("--json", "json_file", metavar="FILE", help="Also write all results as one JSON object.")
def selftest(cpus, json_file):
    """Draw a fixed set of small frames with all engines, and compare their bits with the accepted ones.

    The frames are drawn on one thread and on several, and with NumPy's extensions for newer processors
    switched off. The command prints a line for each check, and a sentence for each frame that differs. Exit
    status: 0 if no frame differs, 1 if one does.
    """
    from fixedpipe.effects.reports.files import writable_file, write_whole
    from fixedpipe.pipeline.golden.provenance import provenance
    from fixedpipe.pipeline.selftest.run import run_selftest

    json_path = writable_file(json_file) if json_file else None
    announce_compiling(None)
    checks = []
    for check in run_selftest(cpus=cpus):
        checks.append(check)
        click.echo(str(check))
        for sentence in check.failures:
            click.echo(f"    {sentence}", err=True)
    failed = sum(len(check.failures) for check in checks)
    versions = provenance(None)
    if json_path:
        written = {"passed": not failed, "versions": versions, "checks": [asdict(check) for check in checks]}
        write_whole(json_path, (json.dumps(written, indent=2) + "\n").encode())
    made = f"Python {versions['python']}, NumPy {versions['numpy']}, Numba {versions['numba']}"
    drawn = sum(check.frames for check in checks)
    if failed:
        click.echo(f"{failed} of {drawn} drawings differ from the accepted bits ({made}).")
        raise click.exceptions.Exit(1)
    click.echo(f"All {drawn} drawings have the accepted bits ({made}).")
