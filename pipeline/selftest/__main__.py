"""``python -m fixedpipe.pipeline.selftest WHERE THREADS ...``: Checks of this process, a line of JSON."""

import sys

from fixedpipe.pipeline.selftest.checks import check_frames, ways
from fixedpipe.pipeline.selftest.processes import to_json

if __name__ == "__main__":
    where, *threads = sys.argv[1:]
    print(to_json(check_frames(where, ways([int(count) for count in threads]))))
