"""A renderer behind Mesa's OpenGL, in a process of its own that draws when it is its turn."""

import json
import os
import tempfile

import numpy as np

from bench.peers.mesa import MesaProcess, PeerError


class OpenGLPeer(MesaProcess):
    """A peer as a party to a measurement; close it, or use it in a ``with`` statement.

    A subclass has its ``name``, how OpenGL names its ``device``, and what Debian's ``package`` has.
    ``description``: begins with the name.

    Raises PeerError when it cannot be had, and when it stops answering.
    """

    module = "bench.peers.opengl_worker"
    name = device = package = None

    def __init__(self, variables, folder=None):
        super().__init__(variables, text=True, folder=folder)

    def __enter__(self):
        """Return the peer itself."""
        return self

    def __exit__(self, *_):
        """End the process."""
        self.close()

    def _greet(self, hello):
        renderer = hello["renderer"]
        if self.device not in renderer:
            raise PeerError(f"Mesa drew with {renderer}; on Debian, {self.package}.")
        by = renderer if renderer.startswith(self.name) else f"{self.name} by {renderer}"
        self.description = f"{by}, {hello['version']}"

    def _receive(self):
        line = self._process.stdout.readline()
        if not line:
            raise EOFError
        answer = json.loads(line)
        if "error" in answer:
            raise PeerError(f"Mesa's process says: {answer['error']}")
        return answer

    def _send(self, request):
        print(json.dumps(request), file=self._process.stdin)

    def prepare(self, scene, size):
        """Make ``scene`` at ``size`` x ``size`` pixels the one that is drawn, with its textures in place."""
        self._ask({"do": "prepare", "scene": scene.name, "size": size})

    def turn(self, frames):
        """Seconds that ``frames`` measured frames took."""
        return self._ask({"do": "turn", "frames": frames})["seconds"]

    def picture(self):
        """{"color": uint8 [h, w, 4], "depth": uint32 [h, w], "stencil": uint8 [h, w]}, top row first."""
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "picture.npz")
            self._ask({"do": "picture", "file": file})
            with np.load(file) as arrays:
                return dict(arrays)
