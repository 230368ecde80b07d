"""Captures as tasks of any executor: a worker redraws one, and the client compares the totals."""

import warnings
from functools import cache
from pathlib import Path

from fixedpipe.effects.conformance.captures import read
from fixedpipe.effects.conformance.case import Inputs
from fixedpipe.effects.conformance.redraw import Comparison, known_suites
from fixedpipe.effects.conformance.run import compared
from fixedpipe.effects.tasks.arrays import packed, unpacked
from fixedpipe.effects.tasks.environment import file_digest, whole_inputs
from fixedpipe.effects.tasks.ordered import in_order
from fixedpipe.effects.tasks.task import Task
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.validation.walk import DisabledTexture

_PICTURES = ("ours", "compared", "equal")  # of a Comparison that covers its case


def compare_by(workers, manifest, captures, inputs):
    """Yield the Comparison of every Capture of a list with the NV2A, in their order, as ``run.compare_all``.

    workers   Workers; None: computed here, one after the other
    manifest  a Manifest with files, or None
    inputs    an Inputs

    Raises Refusal as ``tasks.ordered.in_order``.
    """
    folder = None if inputs.folder is None else str(inputs.folder)
    there = sorted(inputs.folder.rglob("*")) if folder else ()
    shared = whole_inputs(*([str(path), file_digest(path)] for path in there if path.is_file()))
    for capture, done in zip(
        captures, in_order(_tasks(captures, folder, shared), workers, manifest), strict=True
    ):
        pictures = {name: unpacked(data) for name, data in done.files.items()}
        yield Comparison(
            suite=capture.suite, name=capture.name, theirs=capture.read(), **pictures, **done.value
        )


def _tasks(captures, inputs, shared):
    for capture in captures:
        parameters = {
            "suite": capture.suite,
            "name": capture.name,
            "path": str(capture.path),
            "file": file_digest(capture.path),
            "inputs": inputs,
        }
        yield Task(compared_there, parameters, f"{capture.suite}/{capture.name}", shared)


@cache
def _suites():
    """Of a process that compares cases."""
    warnings.simplefilter("ignore", DisabledTexture)  # captures are what a chip drew of it
    return known_suites()


def compared_there(suite, name, path, file, inputs):
    """A capture, redrawn by a worker: what is said of it, and as files its pictures if it is covered.

    path    of the capture; ``file``: its digest, as the client has it
    inputs  the folder of an Inputs, or None
    """
    if file_digest(path) != file:
        raise RuntimeError(f"{path} is another file here than where the command was begun; share one folder.")
    folder = Inputs(None if inputs is None else Path(inputs))
    found = compared(suite, name, read(path), _suites().get(suite), folder, NV2A)
    pictures = {name: packed(getattr(found, name)) for name in _PICTURES} if found.covered else {}
    return {"note": found.note, "failed": found.failed}, pictures
