"""Published pictures and tables -> a page each, for the report: what it is, what the thesis says of
it, how to cite it.
"""

import re
from pathlib import Path

from cysyk1999.publishing.html import of_markdown, page, picture
from fingerpad.files import write_text

CITE = "fingerpad (see CITATION.cff), after J. P. Cysyk, Skin Dynamics in the Tactile Sensing of Shape, S.M. thesis, MIT, 1999."


def run(job):
    """`shown` and `published` (pictures, CSV files of tables), their `titles`; `judged` (chapters'
    pages, or none) -> `pages`.
    """
    judged = "".join(Path(path).read_text(encoding="utf-8") for path in getattr(job, "judged", ()))
    sources = [Path(path) for path in (*getattr(job, "shown", ()), *getattr(job, "published", ()))]
    for source, title, target in zip(sources, job.titles, job.pages, strict=True):
        write_text(Path(target), page(title, *_parts(source, title, judged)))


def _parts(source, title, judged):
    data = source.with_suffix(".csv")
    footer = f"<footer>{source}; data: {data if data.exists() else 'none'}<br>{CITE}</footer>"
    if source.suffix == ".csv":
        chapters = sorted(source.parent.glob(f"{source.stem}_chapter?.md"))
        texts = [
            path.read_text(encoding="utf-8") for path in (source.with_suffix(".md"), *chapters)
        ]
        return *(
            of_markdown(re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", text)) for text in texts
        ), footer
    rows = [
        line
        for line in judged.splitlines()
        if line.startswith(f"| {source.stem.removeprefix('fig_')}: ")
    ]
    head = "## The thesis beside this\n\n| quantity | thesis | here | verdict | why |\n|---|---|---|---|---|\n"
    return picture(source, title), of_markdown(head + "\n".join(rows)) if rows else "", footer
