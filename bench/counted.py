"""Draw some frames of a scene and end, for a program that counts this process's instructions.

Run as ``python -m bench.counted ours|llvmpipe SCENE SIZE FRAMES [MEMORY]``; llvmpipe with Mesa's environment.
With MEMORY the process's executable memory that is of no file is written there before it ends.
"""

import sys

import numpy as np

from bench.scenes import SCENES

# Larger regions are what Valgrind itself makes of the code.
_LARGEST = 64 << 20


def draw(party, scene, size, frames):
    """Draw ``frames`` frames on one thread, and one before them."""
    if party == "ours":
        from bench.measure import Ours

        ours = Ours(1)
        ours.prepare(scene, size)
        ours.turn(frames + 1)
        return
    from bench.peers.context import make_context
    from bench.peers.opengl_worker import Stage

    make_context()
    Stage(scene, size).turn(frames + 1)


def dump(file, maps="/proc/self/maps", memory="/proc/self/mem"):
    """Write this process's executable memory that is of no file, for ``read_dump``."""
    found = {}
    with open(maps) as lines, open(memory, "rb", buffering=0) as content:
        for line in lines.readlines():
            # Source: proc(5): address perms offset dev inode, and a pathname where there is one.
            place, rights, *rest = line.split()
            start, end = (int(address, 16) for address in place.split("-"))
            if "x" in rights and len(rest) == 3 and end - start <= _LARGEST:
                content.seek(start)
                found[str(start)] = np.frombuffer(content.read(end - start), np.uint8)
    np.savez(file, **found)


def read_dump(file):
    """[(address, bytes)] of what ``dump`` wrote, sorted."""
    with np.load(file) as found:
        return sorted((int(start), found[start].tobytes()) for start in found.files)


if __name__ == "__main__":
    party, name, size, frames, *memory = sys.argv[1:]
    draw(party, SCENES[name], int(size), int(frames))
    for file in memory:
        dump(file)
