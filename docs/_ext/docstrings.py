"""The package's docstrings as reStructuredText: what goes on over a line's end belongs to its entry, and | is a bar."""

import re

SECTIONS = re.compile(r"^(Args|Attributes|Raises|Returns|Yields):$")
ENTRY = re.compile(r"^\s+\*{0,2}[A-Za-z_][\w.]*(, \*{0,2}[A-Za-z_][\w.]*)*( \(.*?\))?:(\s|$)")
LITERAL = re.compile(r"(``.*?``|`.*?`)")


def setup(app):
    app.connect("autodoc-process-docstring", lambda *given: tidy(given[-1]), priority=100)  # before napoleon's 500
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def tidy(lines: list[str]) -> None:
    """Mend the lines of a docstring, in place."""
    section, literal = "", False
    for number, line in enumerate(lines):
        if found := SECTIONS.match(line):
            section = found[1]
        elif line and not line.startswith(" "):
            section = ""
        elif section in ("Args", "Attributes") and line.startswith("    ") and not ENTRY.match(line):
            lines[number] = line = f"    {line}"
        if line and not line.startswith(" "):
            literal = False
        if not literal:
            lines[number] = "".join(part if LITERAL.fullmatch(part) else part.replace("|", r"\|") for part in LITERAL.split(line))
        literal = literal or line.endswith("::")
