"""SwiftShader, a Vulkan device in software: Mesa's zink makes Vulkan of the OpenGL that llvmpipe is given."""

import ctypes
import tempfile
from pathlib import Path

from bench.peers import mesa
from bench.peers.mesa import PeerError, environment
from bench.peers.opengl import OpenGLPeer

# Where Debian's chromium has it. Its ANGLE is a part of the program and no library (measured: version 156).
_DRIVER = Path("/usr/lib/chromium/vk_swiftshader_icd.json")


def missing():
    """What SwiftShader needs and this machine lacks, a sentence each; empty when it can be tried."""
    sentences = mesa.missing()
    if not _DRIVER.exists():
        sentences.append(f"{_DRIVER} is missing: on Debian, apt install chromium, which has SwiftShader.")
    try:
        ctypes.CDLL("libvulkan.so.1")
    except OSError:
        sentences.append("libvulkan.so.1 is missing: on Debian, apt install libvulkan1.")
    return sentences


class SwiftShader(OpenGLPeer):
    """SwiftShader on ``threads`` threads, beside those that only hand it work."""

    name, device = "swiftshader", "SwiftShader"
    package = "libgl1-mesa-dri has zink, which draws by SwiftShader"

    def __init__(self, threads):
        if lacking := missing():
            raise PeerError(" ".join(lacking))
        variables = environment(threads, "zink") | {"VK_ICD_FILENAMES": str(_DRIVER)}
        with tempfile.TemporaryDirectory() as folder:
            # Read where the process starts. Source: SwiftShader's docs/RuntimeConfiguration.md.
            Path(folder, "SwiftShader.ini").write_text(f"[Processor]\nThreadCount={threads}\n")
            super().__init__(variables, folder)
