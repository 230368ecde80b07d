"""Mesa's llvmpipe, which compiles for the vectors that the processor has."""

from bench.limits import peer_variables
from bench.peers.mesa import environment
from bench.peers.opengl import OpenGLPeer


class Llvmpipe(OpenGLPeer):
    """llvmpipe on ``threads`` threads."""

    name = device = "llvmpipe"
    package = "libgl1-mesa-dri has llvmpipe"

    def __init__(self, threads):
        super().__init__(environment(threads) | peer_variables())
