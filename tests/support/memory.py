"""How much memory a process has had."""

import re
import resource
import sys
from pathlib import Path


def largest_memory():
    """The most bytes that this process has had in memory since its program began.

    Linux also counts in ``ru_maxrss`` what the process that began this one had; VmHWM leaves that out.
    """
    try:
        told = Path("/proc/self/status").read_text()
    except OSError:
        scale = 1 if sys.platform == "darwin" else 1024
        return scale * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return 1024 * int(re.search(r"VmHWM:\s*(\d+) kB", told)[1])
