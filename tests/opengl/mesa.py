"""Mesa in a process of its own, which draws frames of commands on request."""

import pickle

from bench.peers.mesa import MesaProcess, PeerError, environment

# llvmpipe's filters then compute in single precision, not in bytes. Source: Mesa's docs/envvars.
_EXACT = {"GALLIVM_PERF": "no_filter_hacks"}


class Mesa(MesaProcess):
    """One of Mesa's software drivers, ``softpipe`` or ``llvmpipe``; close it when done.

    Raises PeerError when it cannot be had, and when it stops answering.
    """

    module = "tests.opengl.worker"

    def __init__(self, driver):
        self._driver = driver
        super().__init__(environment(1, driver) | _EXACT, text=False)

    def _greet(self, hello):
        self.renderer, self.version = hello
        if self._driver not in self.renderer:
            raise PeerError(
                f"Mesa draws with {self.renderer}; on Debian, libgl1-mesa-dri has {self._driver}."
            )

    def _receive(self):
        answer = pickle.load(self._process.stdout)
        if isinstance(answer, str):
            raise PeerError(f"Mesa's process says: {answer}")
        return answer

    def _send(self, request):
        pickle.dump(request, self._process.stdin)

    def draw(self, commands, width, height):
        """{"color": uint8 [h, w, 4], "depth": uint32 [h, w], "stencil": uint8 [h, w]}, top row first."""
        return self._ask([(width, height, commands)])[0]
