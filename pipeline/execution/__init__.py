"""A machine runs frames."""

from fixedpipe.pipeline.execution.machine import Machine, execute
from fixedpipe.pipeline.framebuffers.result import Result

__all__ = ["Machine", "Result", "execute"]
