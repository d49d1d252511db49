"""Fonts of PDFs: the characters that pictures are written in are taken out of a font once, for all
pictures of a process.

Matplotlib does so for every picture and font anew, with just the characters used, which takes
longer than to draw it. These are 40 KB more a picture. Where others are asked for, it is done as
ever: what a file holds does not depend on those before it.
"""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from functools import cache
from types import SimpleNamespace
from typing import Any

CHARACTERS = frozenset(map(chr, range(0x20, 0x7F))) | set("°²³µ·×±–—…−≈≤≥→αβγδεθκλμνπρστφωΔΣﬀﬁﬂ")
"""Those taken out, as far as a font has them."""


@contextmanager
def shared_fonts() -> Iterator[None]:
    """Within, fonts that Matplotlib embeds as TrueType are shared."""
    from fontTools.subset import Options
    from matplotlib.backends import _backend_pdf_ps as embedding

    # to place glyphs is over by then: these tables are half of what embedding takes, and no reader
    # of a PDF looks at them
    unread = [
        table for table in ("GDEF", "GPOS", "GSUB") if table not in Options._drop_tables_default
    ]
    Options._drop_tables_default.extend(unread)
    own = subset, as_file = embedding.get_glyphs_subset, embedding.font_as_file

    def shared(file: Any, glyphs: Iterable[int]) -> AbstractContextManager:
        common = _common(file, subset, as_file)
        return (
            nullcontext(common)
            if common.glyph_index_map.keys() >= set(glyphs)
            else subset(file, glyphs)
        )

    embedding.get_glyphs_subset = shared
    embedding.font_as_file = lambda font: (
        io.BytesIO(font) if isinstance(font, bytes) else as_file(font)
    )
    try:
        yield
    finally:
        embedding.get_glyphs_subset, embedding.font_as_file = own


@cache
def _common(file: Any, subset: Any, as_file: Any) -> SimpleNamespace:
    """`CHARACTERS` of a font: its file's content, and its glyphs' numbers there by those of the
    whole.
    """
    from matplotlib.ft2font import FT2Font

    numbers = FT2Font(file).get_charmap()
    with subset(file, {numbers[ord(each)] for each in CHARACTERS if ord(each) in numbers}) as found:
        return SimpleNamespace(
            font=as_file(found.font).getvalue(), glyph_index_map=dict(found.glyph_index_map)
        )
