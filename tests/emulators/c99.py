"""The exported C99, compiled by this machine's cc, and called with arrays of words."""

import ctypes
import shutil
import subprocess

import numpy as np

from fixedpipe.effects.emulators.sources import FOLDER, STAGES

OPTIONS = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O2")


def compiler():
    """The C compiler's path, or None."""
    return shutil.which("cc") or shutil.which("gcc")


def _wrapper(call):
    """C that calls a function for rows of words."""
    begin, at, given = [], 0, []
    for k, value in enumerate(call.inputs.values()):
        many = value.count is not None
        begin.append(f"        {value.c_type} p{k}{f'[{value.count}]' if many else ''};")
        for i in range(value.count or 1):
            target = f"p{k}[{i}]" if many else f"p{k}"
            if value.base == "double":
                begin.append(f"        {target} = (uint64_t)in[{at}] | (uint64_t)in[{at + 1}] << 32;")
            else:
                begin.append(f"        {target} = ({value.c_type})in[{at}];")
            at += 2 if value.base == "double" else 1
        given.append(f"p{k}")
    output = call.output
    if output.count is None:
        run = [f"        {output.c_type} r0 = ({output.c_type}){call.function}({', '.join(given)});"]
    else:
        run = [
            f"        {output.c_type} r[{output.count}];",
            f"        {call.function}({', '.join([*given, 'r'])});",
        ]
    store = []
    for i in range(output.count or 1):
        source = "r0" if output.count is None else f"r[{i}]"
        if output.base == "double":
            store += [
                f"        out[{2 * i}] = (uint32_t){source};",
                f"        out[{2 * i + 1}] = (uint32_t)({source} >> 32);",
            ]
        else:
            store.append(f"        out[{i}] = (uint32_t){source};")
    steps = f"in += {call.words_in}, out += {output.words}"
    return "\n".join(
        [
            f"void run_{call.function}(const uint32_t *in, uint32_t *out, long count) {{",
            f"    for (; count > 0; count--, {steps}) {{",
            *begin,
            *run,
            *store,
            "    }",
            "}",
        ]
    )


def program(calls, before=""):
    """C of all stages, of what stands before, and of a loop for each call."""
    includes = "".join(f'#include "nv2a_{stage}.h"\n' for stage in STAGES) + before
    return includes + "\n\n".join(_wrapper(call) for call in calls) + "\n"


class Library:
    """The functions of ``calls``, compiled in ``folder``; ``before``: C that has some of them."""

    def __init__(self, calls, folder, sources=FOLDER, before=""):
        source, library = folder / "calls.c", folder / "calls.so"
        source.write_text(program(calls, before))
        command = [compiler(), *OPTIONS, "-shared", "-fPIC", f"-I{sources}", "-o", library, source]
        subprocess.run(command, check=True)
        self._library = ctypes.CDLL(str(library))

    def run(self, call, given):
        """Results, uint32 [n, words], of inputs uint32 [n, words]."""
        given = np.ascontiguousarray(given, np.uint32)
        found = np.empty((len(given), call.output.words), np.uint32)
        pointers = [ctypes.c_void_p(a.ctypes.data) for a in (given, found)]
        getattr(self._library, f"run_{call.function}")(*pointers, ctypes.c_long(len(given)))
        return found
