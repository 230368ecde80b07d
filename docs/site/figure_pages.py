"""A page for each figure, its picture beside its passes; and passes below the pictures of a paper's page.

Pictures are those of docs/images. A gallery, where ``fixedpipe figures`` made one, adds small pictures of
the figures that docs/images lacks, and what each pass left.
"""

import hashlib
import html
import json
import re
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
CACHE = ROOT / ".cache" / "site"
# Lines of passes that a page shows: the longest figures have thousands.
LINES = 120
_PICTURE = re.compile(r'src="\.\./images/(?P<id>[A-Z]\w+(?:-\d+)?)-(?P<machine>[A-Z]\w+)\.png"')
_IMAGES = re.compile(r"(?:^<img .*>\n)+", re.MULTILINE)


@cache
def _sources():
    """A digest of the code that passes are made of."""
    found = hashlib.sha256()
    for folder in ("effects", "pipeline"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            found.update(path.read_bytes())
    return found.hexdigest()[:16]


def described(figure_id, machine):
    """The passes of a figure on a machine, in words, as ``fixedpipe passes`` prints them."""
    kept = CACHE / "passes" / f"{figure_id}-{machine}-{_sources()}.txt"
    if not kept.exists():
        from fixedpipe.effects.figures import FIGURES
        from fixedpipe.pipeline import PROFILES, describe

        kept.parent.mkdir(parents=True, exist_ok=True)
        for old in kept.parent.glob(f"{figure_id}-{machine}-*.txt"):
            old.unlink()
        figure = FIGURES[figure_id]
        kept.write_text(describe(figure.commands(PROFILES[machine], figure.size), folded=True))
    return kept.read_text()


def pictured():
    """The machines whose picture of a figure is in docs/images: {figure's id: [machine, ...]}."""
    from fixedpipe.effects.figures import FIGURES

    found = {}
    for path in sorted((ROOT / "docs" / "images").glob("*-*.png")):
        figure_id, _, machine = path.stem.rpartition("-")
        if figure_id in FIGURES and machine in FIGURES[figure_id].machines:
            found.setdefault(figure_id, []).append(machine)
    return found


def _cut(passes, figure_id, machine):
    """Passes of ``LINES`` lines at most, and how to print the others."""
    lines = passes.rstrip().splitlines()
    if len(lines) <= LINES:
        return "\n".join(lines)
    left = f"… {len(lines) - LINES} more lines: fixedpipe passes {figure_id} --profile {machine}"
    return "\n".join([*lines[:LINES], "", left])


def _folded(figure_id, machine, passes):
    """The passes of a figure, under a line that opens them."""
    from fixedpipe.pipeline import PROFILES

    said = f"{figure_id} on {PROFILES[machine].name}: its passes"
    words = html.escape(_cut(passes, figure_id, machine))
    return (
        f'````````{{raw}} html\n<details class="passes"><summary>{html.escape(said)}</summary>'
        f"<pre>{words}</pre></details>\n````````\n"
    )


def beside(name, text, describe=described):
    """A paper's page with the passes of each picture below it; any other page as it is."""
    if not re.fullmatch(r"docs/papers/\d+\.md", name):
        return text

    def joined(match):
        found = dict.fromkeys((m["id"], m["machine"]) for m in _PICTURE.finditer(match[0]))
        links = ", ".join(dict.fromkeys(f"[{each}](../../figures/{each}.md)" for each, _ in found))
        blocks = [_folded(each, machine, describe(each, machine)) for each, machine in found]
        return f"{match[0]}\n{links}\n\n" + "\n".join(blocks) + "\n"

    return _IMAGES.sub(joined, text)


def _record(gallery, figure_id):
    """A figure's record in a gallery's folder; None where there is none."""
    path = gallery / f"{figure_id}.json"
    return json.loads(path.read_text()) if path.exists() else None


def _small(gallery, digest):
    """A picture's small file in a gallery's folder; None where there is none."""
    kept = (gallery / "pictures" / f"{digest}{width}.webp" for width in ("-480", ""))
    return next((path for path in kept if path.exists()), None)


class Pages:
    """The figures' pages. ``files`` are the pictures that they need, by their path in the site."""

    def __init__(self, describe, gallery=None, link=None):
        """``gallery``: the folder of a gallery, or None; ``link``: its page's address from a figure's."""
        self.describe, self.gallery, self.link = describe, gallery, link
        self.files = {}

    def _shown(self, figure):
        """The pictures of a figure: [(address from its page, machine), ...]."""
        shown = [(f"../docs/images/{figure.id}-{m}.png", m) for m in pictured().get(figure.id, ())]
        record = self.gallery and _record(self.gallery, figure.id)
        if shown or not record:
            return shown
        for drawn in record["machines"]:
            digest = drawn["pictures"].get("machine", {}).get("digest")
            path = None if drawn["same_bits_as"] or not digest else _small(self.gallery, digest)
            if path:
                shown.append((self._taken(path), drawn["profile"]))
        return shown

    def _taken(self, path):
        """A gallery's picture as a file of the site."""
        self.files[f"figures/pictures/{path.name}"] = path
        return f"pictures/{path.name}"

    def _steps(self, figure):
        """What the passes left, of a gallery: pictures with the commands that lead to each."""
        record = self.gallery and _record(self.gallery, figure.id)
        if not record or not record["machines"]:
            return ""
        rows = []
        for each in record["machines"][0]["passes"]:
            path = _small(self.gallery, each["preview"])
            if path:
                lines = "\n".join(each["commands"])
                rows.append(
                    f":::{{container}} step\n![{each['label']}]({self._taken(path)})\n\n"
                    f"```text\n{lines}\n```\n:::\n"
                )
        name = record["machines"][0]["name"]
        return f"\n## What each pass left, on {name}\n\n" + "\n".join(rows) if rows else ""

    def page(self, figure):
        """A figure's page."""
        from fixedpipe.effects.technique import PAPERS
        from fixedpipe.pipeline import PROFILES

        shown = self._shown(figure)
        machines = [machine for _, machine in shown] or [figure.machines[0]]
        paper = next((number for number, key in PAPERS.values() if key == figure.source), None)
        lines = [f"# {figure.id}: {figure.title}", "", " ".join(figure.caption.split()), ""]
        lines += [f"**What must be seen.** {' '.join(figure.must_see.split())}", ""]
        blocks = []
        for machine in machines:
            picture = next((f"![{figure.title}]({address})\n" for address, m in shown if m == machine), "")
            passes = _cut(self.describe(figure.id, machine), figure.id, machine)
            blocks.append(
                f"## On {PROFILES[machine].name}\n\n:::::{{container}} beside\n{picture}\n"
                f"````````text\n{passes}\n````````\n:::::\n"
            )
        facts = [f"- Techniques: {', '.join(figure.techniques) or 'none with an id'}"]
        if paper:
            facts.append(f"- Paper: [document {paper}](../docs/papers/{paper}.md)")
        facts.append("- Machines: " + ", ".join(PROFILES[each].name for each in figure.machines))
        facts.append(f"- Draw and check it: `fixedpipe figures {figure.id} --check`")
        if self.link:
            facts.append(
                f'- <a href="{self.link}#{figure.id}">In the gallery</a>: every machine, pixel by pixel'
            )
        return "\n".join([*lines, *facts, "", *blocks, self._steps(figure)])

    def written(self):
        """Every figure's page and their index, by its path in the site."""
        from fixedpipe.effects.figures import FIGURES

        made = {f"figures/{each}.md": self.page(FIGURES[each]) for each in FIGURES}
        tiles = []
        for each in FIGURES:
            shown = self._shown(FIGURES[each])
            picture = f"![{each}]({shown[0][0]})\n\n" if shown else ""
            tiles.append(
                f"::::{{container}} tile\n{picture}[{each}]({each}.md): {FIGURES[each].title}\n::::\n"
            )
        gallery = ""
        if self.link:
            gallery = f'<a href="{self.link}">The gallery</a> compares their pictures pixel by pixel.\n\n'
        head = (
            "# Figures\n\nAfter this page you can find a figure, and see by which passes it is drawn.\n\n"
            f"{gallery}:::::{{container}} tiles\n"
        )
        made["figures/index.md"] = head + "\n".join(tiles) + ":::::\n"
        return made
