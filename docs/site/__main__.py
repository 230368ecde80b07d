"""``python -m docs.site [OUT]``: stages the pages and lets Sphinx build them into OUT, by default out/site.

Exit status: 0; 1 where Sphinx warns, as of a link that leads nowhere; 2 where a package is missing.
"""

import argparse
import os
import sys
from pathlib import Path

from docs.site import code_pages
from docs.site.check import faults
from docs.site.figure_pages import described
from docs.site.stage import ROOT, stage


def build(source, out, *more):
    """Build a staged folder into ``out``; warnings are errors. Returns Sphinx's exit status."""
    try:
        from sphinx.cmd.build import build_main
    except ModuleNotFoundError:
        print("There is no Sphinx. Install the extra: pip install -e '.[site]'.", file=sys.stderr)
        return 2
    # Read when furo's and Sphinx's pages are written: a build of the same pages gives the same files.
    os.environ.setdefault("SOURCE_DATE_EPOCH", "0")
    settings = ["-c", str(Path(__file__).parent), "-d", str(source.parent / "doctrees")]
    return build_main(
        ["-W", "--keep-going", "-n", "-q", "-b", "html", *settings, *more, str(source), str(out)]
    )


def main():
    """Build the site; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m docs.site", description=__doc__)
    parser.add_argument(
        "out", nargs="?", type=Path, default=ROOT / "out" / "site", help="where the site goes"
    )
    given = parser.parse_args()
    source = ROOT / ".cache" / "site" / "source"
    gallery = given.out.resolve().parent / "index.html"
    code = stage(source, described, gallery if gallery.exists() else None, given.out.resolve())
    status = build(source, given.out)
    if not status:
        code_pages.write(code, given.out)
        wrong = faults(given.out)
        print("\n".join(wrong), file=sys.stderr, end="\n" if wrong else "")
        status = int(bool(wrong))
    if not status:
        print(f"open {given.out / 'index.html'}")
    return status


if __name__ == "__main__":
    sys.exit(main())
