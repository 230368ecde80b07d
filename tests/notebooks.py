"""The notebooks of docs/examples: ``python -m tests.notebooks`` runs them and saves what they show.

Each runs in an empty folder and a process of its own. What it shows has to be the same on every computer, so
nothing of it may be a time or a path; ``said`` is what is compared.
"""

import base64
import hashlib
import io
import os
import re
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import nbformat
import numpy as np
from nbclient import NotebookClient
from PIL import Image

ROOT = Path(__file__).parents[1]
NOTEBOOKS = tuple(sorted((ROOT / "docs" / "examples").glob("*.ipynb")))
HANGS = 900  # seconds of a cell, after which it is given up: on a new computer the first waits for kernels
# What a reader's shell lacks, and pytest, a notebook's too, would see.
_NOT_A_READER_S = ("PYTEST", "COV_", "CI", "BUILD_NUMBER")
# What is said once, on a new computer, while kernels are compiled (fixedpipe.pipeline.native.waiting).
_COMPILING = re.compile(r"^(?:fixedpipe compiles its kernels|compiling kernel ).*\n?", re.MULTILINE)
# Fonts and lines of another matplotlib have other pixels.
_A_PLOT = "<Figure size"


def executed(path):
    """A notebook as it is with all cells run anew: a NotebookNode.

    Raises nbclient's CellExecutionError, which has the cell and its traceback, where a cell fails.
    """
    notebook = nbformat.read(path, as_version=4)
    kept = {k: v for k, v in os.environ.items() if not k.startswith(_NOT_A_READER_S)}
    kept |= {"PATH": os.pathsep.join([str(Path(sys.executable).parent), kept["PATH"]]), "COLUMNS": "80"}
    with TemporaryDirectory() as folder:
        NotebookClient(
            notebook,
            timeout=HANGS,
            kernel_name="python3",
            resources={"metadata": {"path": folder}},
            coalesce_streams=True,  # or how a stream is cut depends on time
            extra_arguments=["--log-level=ERROR"],
        ).execute(env=kept)
    notebook.metadata = {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    for cell in notebook.cells:
        cell.metadata = {}
        if cell.cell_type == "code":
            cell.outputs = [output for output in cell.outputs if is_said(output)]
    return notebook


def is_said(output):
    """Whether anything is left of an output without lines on compiling, which are taken away."""
    if output.output_type == "stream":
        output.text = _COMPILING.sub("", output.text)
        return bool(output.text)
    return True


def said(notebook):
    """What each code cell shows, in a list of its own: (kind, what is compared), of a picture its pixels."""
    return [
        [pair for output in cell.outputs for pair in _said(output)]
        for cell in notebook.cells
        if cell.cell_type == "code"
    ]


def _said(output):
    if output.output_type == "stream":
        return [(output.name, output.text)]
    plot = output.data.get("text/plain", "").startswith(_A_PLOT)
    return [
        (kind, "a plot" if plot and kind == "image/png" else _pixels(data) if kind == "image/png" else data)
        for kind, data in sorted(output.data.items())
    ]


def _pixels(text):
    """A PNG file's mode and size, and a digest of its pixels."""
    with Image.open(io.BytesIO(base64.b64decode(text))) as image:
        return image.mode, image.size, hashlib.sha256(np.asarray(image).tobytes()).hexdigest()


def main():
    for path in NOTEBOOKS:
        print(path.relative_to(ROOT), file=sys.stderr, flush=True)
        nbformat.write(executed(path), path)


if __name__ == "__main__":
    main()
