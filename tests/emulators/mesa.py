"""The exported GLSL, run by Mesa's llvmpipe in a process of its own."""

import pickle
import re

from bench.peers.mesa import MesaProcess, PeerError, environment
from fixedpipe.effects.emulators.sources import FOLDER, STAGES

# llvmpipe then compiles without optimizing, in a tenth of the time. Source: Mesa's docs/envvars.
_QUICK = {"GALLIVM_PERF": "nopt"}
VERSIONS = ("330 core", "310 es")
_FILES = ("uint64", *STAGES)


def library(folder=FOLDER):
    """All functions as GLSL, in their order."""
    return "\n".join((folder / f"nv2a_{name}.glsl").read_text() for name in _FILES)


def needed(names, text):
    """The part of a library that functions of these names call, and they; without its comments."""
    text = re.sub(r"^//.*\n", "", text, flags=re.M)
    parts = [part for part in re.split(r"\n(?=\w)", text) if part.strip()]
    words = [set(re.findall(r"\b(?:nv2a|NV2A)_\w+", part)) for part in parts]
    owners = {}
    for k, part in enumerate(parts):
        owners.setdefault(re.search(r"\b(?:nv2a|NV2A)_\w+", part)[0], k)
    chosen, left = set(), [owners[name] for name in names]
    while left:
        k = left.pop()
        if k not in chosen:
            chosen.add(k)
            left += [owners[word] for word in words[k]]
    return "\n".join(parts[k] for k in sorted(chosen))


def _loaded(value, name, at):
    """GLSL that makes a parameter of words from ``at`` on."""
    vector = value.base in ("int", "name", "single") and value.count is not None and 2 <= value.count <= 4
    base = {"int": "int", "name": "int", "single": "uint", "double": "uvec2"}[value.base]
    if value.count is None:
        lines = [f"    {base} {name};"]
    elif vector:
        lines = [f"    {'uvec' if base == 'uint' else 'ivec'}{value.count} {name};"]
    else:
        lines = [f"    {base} {name}[{value.count}];"]
    for i in range(value.count or 1):
        target = name if value.count is None else f"{name}[{i}]"
        if value.base == "double":
            lines.append(f"    {target} = uvec2(words[{at}], words[{at + 1}]);")
            at += 2
        else:
            lines.append(f"    {target} = {base}(words[{at}]);")
            at += 1
    return lines, at


def caller(call, unsigned=False):
    """GLSL of ``void run()``, which calls a function; ``unsigned``: an int result is a uint."""
    lines, at, given = [], 0, []
    for k, value in enumerate(call.inputs.values()):
        loaded, at = _loaded(value, f"p{k}", at)
        lines += loaded
        given.append(f"p{k}")
    output = call.output
    if output.count is None:
        base = {"int": "uint" if unsigned else "int", "single": "uint", "double": "uvec2"}[output.base]
        lines.append(f"    {base} r = {call.function}({', '.join(given)});")
    else:
        declared, _ = _loaded(output, "r", 0)
        lines += [declared[0], f"    {call.function}({', '.join([*given, 'r'])});"]
    for i in range(output.count or 1):
        source = "r" if output.count is None else f"r[{i}]"
        if output.base == "double":
            lines += [f"    result[{2 * i}] = {source}.x;", f"    result[{2 * i + 1}] = {source}.y;"]
        else:
            lines.append(f"    result[{i}] = uint({source});")
    return "\n".join(["void run() {", *lines, "}"])


class Shaders(MesaProcess):
    """llvmpipe, which runs functions on rows of words; close it when done.

    Raises PeerError when it cannot be had, and for what it refuses.
    """

    module = "tests.emulators.worker"

    def __init__(self, threads=1):
        super().__init__(environment(threads) | _QUICK, text=False)

    def _greet(self, hello):
        self.renderer, self.version = hello
        if "llvmpipe" not in self.renderer:
            raise PeerError(f"Mesa draws with {self.renderer}; on Debian, libgl1-mesa-dri has llvmpipe.")

    def _receive(self):
        answer = pickle.load(self._process.stdout)
        if isinstance(answer, str):
            raise PeerError(f"Mesa's process says: {answer}")
        return answer

    def _send(self, request):
        pickle.dump(request, self._process.stdin)

    def run(self, call, given, version, source=None, unsigned=False):
        """Results, uint32 [n, words], of inputs uint32 [n, words]; ``source``: GLSL that has the function,
        if it is none of the library's.
        """
        functions = source or needed([call.function], library())
        return self._ask(
            {
                "version": version,
                "source": f"{functions}\n{caller(call, unsigned)}",
                "words_out": call.output.words,
                "given": given,
            }
        )
