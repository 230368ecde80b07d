"""``fixedpipe golden import``: the pictures of another plug-in become a test module's golden ones."""

import json
import os
import tempfile
from pathlib import Path

import click

_SHOWN = 20  # names that a refusal lists


def import_baselines(folder, module, run_pytest):
    """Make PNG files of a folder golden, and print the result for each. Returns whether all that belong to
    the module's tests are golden. ``run_pytest(*arguments, silent)`` runs pytest. Raises Refusal.
    """
    from fixedpipe.effects.refusal import Refusal, refusals
    from fixedpipe.pipeline.golden.baselines import find_baselines, take_baselines

    folder, module = Path(folder), Path(module)
    if not folder.is_dir():
        raise Refusal(
            f"{folder} is no folder. Name the one that holds the PNG files; digests of such files, as "
            "pytest-mpl's hash library has them, say nothing of pixels and cannot be taken."
        )
    if not module.is_file():
        raise Refusal(f"{module} is no file; name the test module whose tests draw the pictures.")
    store, keep, tests = _tests_of(module, run_pytest)
    with refusals():
        found = find_baselines(folder, module.stem, tests)
        if not (found.of_tests or found.shared):
            if not found.of_nobody:
                raise Refusal(
                    f"{folder} has no PNG file. Name the folder that holds the files themselves; folders in "
                    "it are not searched."
                )
            raise Refusal(
                f"No PNG file in {folder} has the name of a test in {module}, as pytest-mpl, "
                f"pytest-regressions or syrupy would name it. Its files are {_some(found.of_nobody)}."
            )
        taken = take_baselines(store, found.of_tests, keep)
    told = f"{module.as_posix()}::"
    for name in taken.new:
        click.echo(f"{told}{name}: golden, {found.of_tests[name]}")
    for name in taken.equal:
        click.echo(f"{told}{name}: was golden, with the same pixels")
    for name, why in taken.left.items():
        click.echo(f"{told}{name}: not taken: {why}")
    for path, names in found.shared.items():
        click.echo(f"{path}: not taken: {_whose(names, found.of_tests)}")
    for path in found.of_nobody:
        click.echo(f"{path}: of no test in {module}")
    click.echo(f"{len(taken.new)} taken; {os.path.relpath(store)} keeps them.")
    return not (taken.left or found.shared)


def _some(paths):
    names = [path.name for path in paths[:_SHOWN]]
    return ", ".join([*names, *([f"and {len(paths) - _SHOWN} more"] if len(paths) > _SHOWN else ())])


def _whose(names, of_tests):
    if len(names) > 1:
        return f"it may be of {' or '.join(names)}"
    return f"{of_tests[names[0]]} is of {names[0]} already"


def _tests_of(module, run_pytest):
    """(file of the store, whether PNG files are stored, tests) of a test module. The settings of the module's
    project decide the first two.
    """
    from fixedpipe.effects.refusal import Refusal

    with tempfile.TemporaryDirectory() as folder:
        listed = Path(folder, "tests.json")
        run_pytest("--collect-only", "-qqq", f"--golden-tests={listed}", str(module), silent=True)
        found = json.loads(listed.read_text(encoding="utf-8")) if listed.exists() else []
    if not found:
        raise Refusal(f"pytest finds no test in {module}; `pytest --collect-only {module}` says why.")
    return Path(found[0]["store"]), found[0]["keep"], [test["test"] for test in found]
