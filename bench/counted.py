"""Draw some frames of a scene and end, for a program that counts this process's instructions.

Run as ``python -m bench.counted ours|llvmpipe SCENE SIZE FRAMES``; llvmpipe with Mesa's environment.
"""

import sys

from bench.scenes import SCENES


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


if __name__ == "__main__":
    draw(sys.argv[1], SCENES[sys.argv[2]], int(sys.argv[3]), int(sys.argv[4]))
