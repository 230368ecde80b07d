"""Files that a window offers for a View: the frame as Python, its picture, and a test with the picture."""

import io
import re
import tempfile
import zipfile
from dataclasses import dataclass
from pathlib import Path

from fixedpipe.effects.refusal import refusals
from fixedpipe.effects.viewer.studio import Studio
from fixedpipe.effects.viewer.views import View
from fixedpipe.pipeline.enums import Clamp
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.framebuffers.pictures import png, whole_png
from fixedpipe.pipeline.framebuffers.result import Result
from fixedpipe.pipeline.golden.pixels import pixels_of
from fixedpipe.pipeline.golden.store import change_store, golden_of, picture_path
from fixedpipe.pipeline.inspection.what_if import PARTS


@dataclass(frozen=True)
class Kept:
    """A file that a window offers to its user: its name, and its bytes."""

    name: str
    data: bytes


def file_stem(view: View) -> str:
    """The beginning of a file's name for a View. It has only letters, digits, - and _; it names no folder."""
    plain = re.sub(r"[^A-Za-z0-9_-]+", "-", f"{Path(view.id.partition('#')[0]).stem}-{view.machine}").strip(
        "-"
    )
    part = "" if view.upto is None else f"-command-{view.upto}"
    return f"{plain[:60] or 'frame'}{part}"


def script(studio: Studio, view: View) -> str:
    """A Python script that draws the View again. The commands inspect, compare and passes accept it."""
    subject = studio.subject(view)
    studio.commands(view)  # raises Refusal if the view cannot be drawn
    with refusals():
        imports, lines = subject.script(view)
    machine = f'PROFILES["{view.machine}"]'
    if view.bits:
        widths = ", ".join(f"{PARTS[part]}={bits}" for part, bits in view.bits)
        machine += f".with_precision({widths})"
    if view.without:
        clamps = ", ".join(f"Clamp.{Clamp[name.upper()].name}" for name in view.without)
        machine += f".without_clamps({clamps})"
        imports = [*imports, "from fixedpipe.pipeline.enums import Clamp"]
    imports = [
        *imports,
        "from fixedpipe.pipeline.execution.machine import execute",
        "from fixedpipe.pipeline.profiles import PROFILES",
    ]
    part = "" if view.upto is None else f"[: {view.upto + 1}]  # up to command {view.upto}"
    said = subject.title.replace("\\", "/").replace('"""', "'''")
    text = [
        f'"""{said}.',
        "",
        "Written by fixedpipe view. `fixedpipe inspect` and `fixedpipe compare` take it.",
        '"""',
        "",
        *sorted(set(imports)),
        "",
        f"profile = {machine}",
        *lines,
        "",
        "",
        f"commands = commands_of(profile){part}",
        "",
        'if __name__ == "__main__":',
        f'    execute(commands, profile, width, height).save("{file_stem(view)}.png")',
    ]
    return "\n".join(text) + "\n"


def script_kept(studio: Studio, view: View) -> Kept:
    """The script as a file."""
    return Kept(f"{file_stem(view)}.py", script(studio, view).encode())


def _result(studio: Studio, view: View) -> Result:
    with refusals():
        return execute(
            studio.commands(view), view.profile(), *studio.dimensions(view), threads=studio.threads
        )


def picture_kept(studio: Studio, view: View) -> Kept:
    """The machine's picture as a PNG file with all its bits, the same as ``Result.save`` writes."""
    return Kept(f"{file_stem(view)}.png", png(_result(studio, view).deep_image()))


def golden_kept(studio: Studio, view: View) -> Kept:
    """A ZIP file with a test and its golden picture. Unpack it into a project with pytest.

    The test draws the View again and compares it with the picture (docs/golden-images.md).
    """
    name = re.sub(r"[^a-z0-9]+", "_", file_stem(view).lower()).strip("_")
    frame, test = f"{name}_frame", f"test_{name}"
    pixels = pixels_of(_result(studio, view))
    text = (
        f'"""The frame of {frame}.py keeps its golden picture."""\n\n'
        "import runpy\nfrom pathlib import Path\n\n"
        "from fixedpipe.pipeline.execution.machine import execute\n\n\n"
        f"def {test}(golden):\n"
        f'    made = runpy.run_path(str(Path(__file__).with_name("{frame}.py")))\n'
        '    golden(execute(made["commands"], made["profile"], made["width"], made["height"]))\n'
    )
    buffer = io.BytesIO()
    with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as file:
        store = Path(folder) / "golden" / f"{test}.json"
        change_store(store, {test: golden_of(pixels)})
        picture = picture_path(store, test)
        file.writestr(f"tests/{test}.py", text)
        file.writestr(f"tests/{frame}.py", script(studio, view))
        file.writestr(f"tests/golden/{test}.json", store.read_bytes())
        file.writestr(f"tests/golden/{picture.relative_to(store.parent).as_posix()}", whole_png(pixels))
    return Kept(f"{test}.zip", buffer.getvalue())
