"""Publishing for a browser: pages that hold their pictures and tables in themselves."""

from __future__ import annotations

import base64
import html
import mimetypes
import re
from pathlib import Path
from types import SimpleNamespace

from markdown_it import MarkdownIt

from fingerpad.files import write_text

STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; color: #1a1a1a; background: #fff;
  margin: 1.2rem 1.6rem; }
h1, p, footer, li { overflow-wrap: anywhere; }
h1 { font-size: 1.25rem; } h2 { font-size: 1.05rem; }
img { display: block; max-width: 100%; max-height: 82vh; margin: 0.6rem 0; }
table { border-collapse: collapse; font-size: 0.85rem; }
th, td { text-align: left; vertical-align: top; padding: 0.15rem 0.7rem 0.15rem 0;
  border-bottom: 1px solid #ddd; }
div.table { overflow-x: auto; }
footer { margin-top: 1rem; color: #555; font-size: 0.85rem; }
"""


def page(title: str, *parts: str) -> str:
    """A page of some parts, HTML each, under a title."""
    head = '<meta charset="utf-8"><meta name="viewport" content="width=device-width">'
    head += f"<title>{html.escape(title)}</title><style>{STYLE}</style>"
    body = "\n".join([f"<h1>{html.escape(title)}</h1>", *filter(None, parts)])
    return f'<!doctype html>\n<html lang="en"><head>{head}</head><body>\n{body}\n</body></html>\n'


def picture(path: Path, alt: str) -> str:
    """A picture, still or moving, as part of the page itself."""
    kind = mimetypes.guess_type(path.name)[0] or "image/png"
    data = base64.b64encode(path.read_bytes()).decode("ascii")
    return f'<img alt="{html.escape(alt)}" src="data:{kind};base64,{data}">'


def of_markdown(text: str) -> str:
    """Markdown with its tables as HTML; tables wider than the page scroll by themselves."""
    text = MarkdownIt("commonmark").enable("table").render(text)
    return text.replace("<table>", '<div class="table"><table>').replace(
        "</table>", "</table></div>"
    )


CITE = (
    "fingerpad (see CITATION.cff), after J. P. Cysyk, Skin Dynamics in the Tactile Sensing of "
    "Shape, S.M. thesis, MIT, 1999."
)


def report_pages(job: SimpleNamespace) -> None:
    """`shown` and `published` (pictures, CSV files of tables), their `titles`; `judged` (chapters'
    pages, or none) -> `pages`.
    """
    of = {"shown": (), "published": (), "judged": ()} | vars(job)
    judged = "".join(Path(path).read_text(encoding="utf-8") for path in of["judged"])
    sources = map(Path, (*of["shown"], *of["published"]))
    for source, title, target in zip(sources, job.titles, job.pages, strict=True):
        whole = source.suffix == ".html"  # is a page already
        text = source.read_text(encoding="utf-8") if whole else None
        write_text(Path(target), text or page(title, *_parts(source, title, judged)))


def _parts(source, title, judged):
    data = source.with_suffix(".csv")
    footer = f"<footer>{source}; data: {data if data.exists() else 'none'}<br>{CITE}</footer>"
    if source.suffix == ".csv":
        chapters = sorted(source.parent.glob(f"{source.stem}_chapter?.md"))
        pages = [
            path.read_text(encoding="utf-8") for path in (source.with_suffix(".md"), *chapters)
        ]
        without_links = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", "\n\n".join(pages))
        return of_markdown(without_links), footer
    number = source.stem.removeprefix("fig_")
    rows = re.findall(rf"^\| {re.escape(number)}: .*$", judged, re.MULTILINE)
    head = (
        "## The thesis beside this\n\n| quantity | thesis | here | verdict | why "
        "|\n|---|---|---|---|---|\n"
    )
    return picture(source, title), of_markdown(head + "\n".join(rows)) if rows else "", footer
