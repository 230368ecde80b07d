"""What is wrong with a site that was built: links that lead nowhere, and what comes from another host."""

import re
from html.parser import HTMLParser
from urllib.parse import unquote, urlsplit


class Addresses(HTMLParser):
    """What a page names: its ``ids``, where it ``leads``, and what a browser ``loads`` for it."""

    LOADS = {"img": "src", "script": "src", "link": "href", "iframe": "src", "source": "src", "video": "src"}

    def __init__(self, text):
        """``text``: of the page."""
        super().__init__()
        self.ids, self.leads, self.loads = set(), [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        """What HTMLParser calls at each tag."""
        found = dict(attrs)
        self.ids.update(filter(None, (found.get("id"), found.get("name"))))
        if tag == "a" and found.get("href"):
            self.leads.append(found["href"])
        of_a_canonical_page = found.get("rel") == "canonical"
        if tag in self.LOADS and found.get(self.LOADS[tag]) and not of_a_canonical_page:
            self.loads.append(found[self.LOADS[tag]])


def faults(site):
    """What is wrong with the HTML files of a folder: links that lead nowhere, other hosts; as lines."""
    read = {path: Addresses(path.read_text()) for path in site.rglob("*.html")}
    wrong = []
    for path, page in read.items():
        for address in [*page.leads, *page.loads]:
            parts = urlsplit(address)
            if parts.scheme or parts.netloc:
                if address in page.loads and parts.scheme != "data":
                    wrong.append(f"{path.name} loads {address}")
                continue
            there = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not there.is_file():
                wrong.append(f"{path.name} leads to {address}, which is not there")
            elif parts.fragment and there in read and unquote(parts.fragment) not in read[there].ids:
                wrong.append(f"{path.name} leads to {address}, whose part is not there")
    for path in site.rglob("*.css"):
        for address in re.findall(r"(?:url\(|@import )['\"]?((?:https?:)?//[^'\")]+)", path.read_text()):
            wrong.append(f"{path.name} loads {address}")
    return wrong
