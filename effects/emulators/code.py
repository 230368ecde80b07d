"""The code as files: C99 or GLSL, with an index that says which function computes which rule."""

from fixedpipe.effects.arithmetic.rules import RULES
from fixedpipe.effects.emulators.names import function_of
from fixedpipe.effects.emulators.sources import FOLDER, STAGES

LANGUAGES = ("c99", "glsl")
_FORM = {"c99": "h", "glsl": "glsl"}
_COMMENT = {"c99": "/* {} */\n", "glsl": "// {}\n"}
_NOTICE = "Of fixedpipe {}, under the MIT licence (LICENSE): docs/code-for-emulators.md says how to use it."


def code_files(language: str, version: str) -> dict[str, bytes]:
    """The files' contents by their names: a file for each stage, one of all, and the licence.

    ``language`` is one of ``LANGUAGES``; ``version`` is the package's, which every file names.
    """
    notice = _COMMENT[language].format(_NOTICE.format(version))
    names = STAGES if language == "c99" else ("uint64", *STAGES)
    texts = {f"nv2a_{name}": (FOLDER / f"nv2a_{name}.{_FORM[language]}").read_text() for name in names}
    if language == "c99":
        texts["nv2a"] = "".join(f'#include "nv2a_{name}.h"\n' for name in names)
    else:
        texts["nv2a"] = "\n".join(texts.values())
    files = {f"{name}.{_FORM[language]}": f"{notice}\n{text}".encode() for name, text in texts.items()}
    return files | {"LICENSE": (FOLDER / "LICENSE").read_bytes()}


def functions(language: str) -> dict[str, dict[str, str]]:
    """By rule: its function, the file that has it, its number in docs/numbers.md, and its evidence."""
    names = [(name, (FOLDER / f"nv2a_{name}.{_FORM[language]}").read_text()) for name in STAGES]
    found = {}
    for id_, rule in RULES.items():
        function = function_of(id_)
        file = next(f"nv2a_{name}.{_FORM[language]}" for name, text in names if f" {function}(" in text)
        found[id_] = {"function": function, "file": file, "numbers": rule.numbers, "evidence": rule.evidence}
    return found
