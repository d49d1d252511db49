"""The package's docstrings as reStructuredText: what goes on over a line's end belongs to its
entry, | is a bar, and what is indented for no other reason is shown as it is.
"""

import re

SECTIONS = re.compile(r"^(Args|Attributes|Raises|Returns|Yields):")
ENTRY = re.compile(r"^\s+\*{0,2}[A-Za-z_][\w.]*(, \*{0,2}[A-Za-z_][\w.]*)*( \(.*?\))?:(\s|$)")
LITERAL = re.compile(r"(``.*?``|`.*?`)")
LIST = re.compile(r"^\s*([-*]|\d+\.) ")


def setup(app):
    app.connect(
        "autodoc-process-docstring", lambda *given: tidy(given[-1]), priority=100
    )  # before napoleon's 500
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def tidy(lines: list[str]) -> None:
    """Mend the lines of a docstring, in place."""
    made, section, literal, said = [], "", False, ""
    for line in lines:
        indented = line.startswith("    ")
        if line and not line.startswith(" "):
            found = SECTIONS.match(line)
            section, literal = found[1] if found else "", False
        elif indented and section in ("Args", "Attributes") and not ENTRY.match(line):
            line = f"    {line}"
        elif (
            indented
            and not section
            and not literal
            and made
            and not made[-1]
            and not LIST.match(said)
        ):
            literal = True
            if not said.endswith("::"):
                made += ["::", ""]
        if not literal:
            line = "".join(
                part if LITERAL.fullmatch(part) else part.replace("|", r"\|")
                for part in LITERAL.split(line)
            )
        made.append(line)
        said = line or said
    lines[:] = made
