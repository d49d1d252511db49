"""Tables that people bring: text files as instruments, spreadsheets and numpy write them.

A table is a header and rows of cells, parted by commas, semicolons, tabs or spaces. Every reader of
a user's table (profiles, forces, recordings, motions, samples of a sweep) starts here, so all of
them take the same files and refuse the same ones.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from fingerpad.files import WrongInput, read_input

MOST_LINES = 500_000
"""Of a table."""
MOST_LETTERS = 200
"""Of a column's name."""
SAVE_AS = "a CSV file in UTF-8"
_PARTED = {"\t": "tabs", ";": "semicolons", ",": "commas", " ": "spaces"}
"""Delimiters and their names; the first that a header holds parts its columns."""
_COMMENT = ("#", "%")
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_WITH_COMMA = re.compile(r"[+-]?(?:\d+,\d*|,\d+)(?:[eE][+-]?\d+)?")
_WRONG_CELL = re.compile(r'\s*"?#(?:REF!|N/A|DIV/0!|VALUE!|NAME\?|NULL!|NUM!)(?=[",;\s]|$)')
_POINTED = re.compile(r"[+-]?[1-9]\d{0,2}(?:\.\d{3})+")
_HUNDREDS = re.compile(r"[+-]?[1-9]\d\d")
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(?:[,.' \u00a0\u202f]\d{3})+(?:[.,]\d*)?")
_MAYBE_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")
_WRITE_POINTS = "numbers such as 1234.5, with a decimal point and no other sign"


class TableError(WrongInput):
    """A table cannot be read; ``problem`` follows the name of its file."""

    def __init__(self, problem: str, allowed: str = SAVE_AS) -> None:
        super().__init__(problem, allowed)


@dataclass(frozen=True)
class Table:
    """A table as text.

    Attributes
    ----------
    header : names of the columns.
    rows : cells of each row, as many as the header has.
    lines : number of each row's line in the file, as an editor counts.
    notes : how the file was read where that had to be guessed, in words.
    decimal_comma : whether numbers are written as ``3,6``.
    """

    header: tuple[str, ...]
    rows: list[list[str]]
    lines: list[int]
    notes: tuple[str, ...] = ()
    decimal_comma: bool = False

    def numbers(self, column: int) -> list[float]:
        """Numbers of a column.

        Raises
        ------
        TableError : a cell holds no finite number; the message names row, column and cell.
        """
        return [
            self.number(row[column], line, column)
            for row, line in zip(self.rows, self.lines, strict=True)
        ]

    def number(self, cell: str, line: int, column: int) -> float:
        """The number in a cell; errors as in :meth:`numbers`."""
        text = cell.replace("\u2212", "-")
        if self.decimal_comma and _WITH_COMMA.fullmatch(text):
            text = text.replace(",", ".", 1)
        if _NUMBER.fullmatch(text) and abs(value := float(text)) < float("inf"):
            return value
        place = f"row {line}, column '{self.header[column]}'"
        raise TableError(f"has '{cell[:40]}' in {place}, which is no finite number", _WRITE_POINTS)


def read_table(path: str | Path) -> Table:
    """Read a table from a text file.

    The encoding may be UTF-8, UTF-16 or Windows-1252. Lines that start with ``#`` or ``%`` are
    comments; where the first other line is numbers, the last comment before it is the header.
    Columns are parted by tabs, semicolons, commas or spaces, as in the header. Decimal commas are
    read where they cannot be anything else.

    Raises
    ------
    OSError : the file cannot be read.
    TableError : it is no such table; the message says what was found.
    """
    content = read_input(path, "table")
    if max(map(content.count, (b"\n", b"\r"))) > MOST_LINES:
        raise TableError(f"has more than {MOST_LINES} lines", f"up to {MOST_LINES}")
    text, notes = _decoded(content)
    header, delimiter, lines = _header(text)
    rows, numbers = [], []
    for line, cells in _split(lines, delimiter):
        while len(cells) > len(header) and not cells[-1]:
            cells.pop()
        if len(cells) != len(header):
            raise _wrong_count(line, cells, header, delimiter)
        rows.append(cells)
        numbers.append(line)
    comma = _decimal_comma(rows, numbers, delimiter)
    if comma:
        notes.append("read with decimal commas")
    return Table(tuple(header), rows, numbers, tuple(notes), comma)


def _decoded(content: bytes) -> tuple[str, list[str]]:
    """Text of a file, and what is unusual about its encoding."""
    if content.startswith((b"PK\x03\x04", b"\xd0\xcf\x11\xe0")):
        raise TableError("is a spreadsheet, not text")
    encoding = "utf-8-sig"
    for name, high_bytes in (("utf-16-le", content[1:400:2]), ("utf-16-be", content[:400:2])):
        if len(content) > 3 and high_bytes.count(0) > len(high_bytes) / 2:
            encoding = name
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):  # it says so itself
        encoding = "utf-16"
    try:
        text, notes = content.decode(encoding), []
    except UnicodeDecodeError as error:
        if encoding != "utf-8-sig":
            raise TableError("is no whole UTF-16 text") from None
        try:
            text, notes = content.decode("cp1252"), ["is not UTF-8, read as Windows-1252"]
        except UnicodeDecodeError:
            byte, line = content[error.start], content.count(b"\n", 0, error.start) + 1
            raise TableError(f"is not UTF-8 (byte 0x{byte:02x} in row {line})") from None
    if "\0" in text:
        raise TableError("is binary, not text")
    return text, notes


def _header(text: str) -> tuple[list[str], str, list[tuple[int, str]]]:
    """Names of the columns, what parts them, and the (number, text) of each line of cells below."""
    lines = [
        (number, line)
        for number, line in enumerate(io.StringIO(text, newline=""), start=1)
        if line.strip()
    ]
    stated = None
    if lines and (match := re.fullmatch(r'"?sep=(.)"?', lines[0][1].strip())):
        stated = match[1]
        lines = lines[1:]
        if stated not in _PARTED:
            raise TableError(f"parts its columns by '{stated}'", "tabs, semicolons or commas")
    first = next((k for k, (_, line) in enumerate(lines) if not _is_comment(line)), None)
    if first is None:
        raise TableError("holds no rows")
    line = lines[first][1]
    header = _cells(line, stated or _delimiter(line))
    if all(map(_like_a_number, header)):  # the names are in the last comment before
        comments = [line for _, line in lines[:first]]
        line = comments[-1].lstrip().lstrip("".join(_COMMENT)) if comments else ""
        header = _cells(line, stated or _delimiter(line))
        if len(header) < 2:
            raise TableError(
                "has no header: its first row is numbers",
                "names and units of the columns above the numbers",
            )
        first -= 1
    while header and not header[-1]:
        header.pop()
    for name in header:
        if header.count(name) > 1:
            raise TableError(f"has the column '{name[:40]}' twice", "each column once")
        if len(name) > MOST_LETTERS:
            raise TableError(f"has a column's name of {len(name)} letters", f"up to {MOST_LETTERS}")
    rows = [(number, row) for number, row in lines[first + 1 :] if not _is_comment(row)]
    return header, stated or _delimiter(line), rows


def _is_comment(line: str) -> bool:
    return line.lstrip().startswith(_COMMENT) and not _WRONG_CELL.match(line)


def _delimiter(line: str) -> str:
    """What parts the columns of a header."""
    bare = re.sub(r'"[^"]*"', "", line.strip("\r\n"))
    return next((sign for sign in "\t;," if sign in bare), " ")


def _cells(line: str, delimiter: str) -> list[str]:
    """Cells of one line. A space before a unit in brackets parts nothing."""
    if delimiter == " ":
        return re.split(r"\s+(?![(\[])", line.strip())
    row = csv.reader([line.strip("\r\n")], delimiter=delimiter, skipinitialspace=True)
    return [cell.strip() for cell in next(row, [])]


def _split(lines: list[tuple[int, str]], delimiter: str) -> Iterator[tuple[int, list[str]]]:
    """Cells of each row, with the number of the line that the row ends in."""
    if delimiter == " ":
        for number, line in lines:
            yield number, line.split()
        return
    texts = (line for _, line in lines)
    rows = csv.reader(texts, delimiter=delimiter, skipinitialspace=True)
    try:
        for row in rows:  # line_num counts the lines read so far: cells may hold ends of lines
            yield lines[rows.line_num - 1][0], [cell.strip() for cell in row]
    except csv.Error as error:
        at = lines[rows.line_num - 1][0]
        raise TableError(f"cannot be split into cells in row {at} ({error})") from None


def _like_a_number(cell: str) -> bool:
    text = cell.replace("\u2212", "-")
    return bool(_NUMBER.fullmatch(text) or _WITH_COMMA.fullmatch(text))


def _wrong_count(line: int, cells: list[str], header: list[str], delimiter: str) -> TableError:
    names = ", ".join(header)[:60]
    what = f"has {len(cells)} cells in row {line}, {len(header)} in its header ({names})"
    whole = all(re.fullmatch(r"[+-]?\d*", cell) for cell in cells)
    if delimiter == "," and len(cells) > len(header) and whole:
        allowed = "decimal points, or semicolons between columns"
        return TableError(f"{what}: commas part columns here", allowed)
    parted = f"parted by {_PARTED[delimiter]} as the header is"
    return TableError(what, f"{len(header)} cells in each row, {parted}")


def _decimal_comma(rows: list[list[str]], lines: list[int], delimiter: str) -> bool:
    """Whether numbers have decimal commas.

    Raises `TableError` where commas may part thousands, or where there are decimal points too.
    """
    for cells in zip(*rows, strict=True) if delimiter == ";" else ():
        pointed = [(line, cell) for line, cell in zip(lines, cells, strict=True) if "." in cell]
        thousands = all(_POINTED.fullmatch(cell) for _, cell in pointed)
        if pointed and thousands and any(map(_HUNDREDS.fullmatch, cells)):
            line, cell = pointed[0]
            what = f"has '{cell}' in row {line} beside whole numbers, which may be thousands"
            raise TableError(what, _WRITE_POINTS)
    found, certain, points = "", delimiter == ";", False
    for line, cells in zip(lines, rows, strict=True):
        for cell in cells:
            if "," in cell and _WITH_COMMA.fullmatch(cell):
                found = found or f"'{cell}' in row {line}"
                certain = certain or not _MAYBE_THOUSANDS.fullmatch(cell)
            elif "." in cell and _NUMBER.fullmatch(cell):
                points = True
            elif _THOUSANDS.fullmatch(cell):
                raise TableError(
                    f"has '{cell}' in row {line}, with a sign between thousands", _WRITE_POINTS
                )
    if not found:
        return False
    if points:
        raise TableError(f"has decimal points, and {found}", _WRITE_POINTS)
    if not certain:
        raise TableError(f"has {found}, which may be thousands or a decimal comma", _WRITE_POINTS)
    return True
