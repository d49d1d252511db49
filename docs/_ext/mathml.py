"""Equations as MathML, which browsers draw by themselves: no script and no font from elsewhere."""

from docutils.utils.math.latex2mathml import tex2mathml


def setup(app):
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    app.config.html_math_renderer = "mathml"
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _inline(translator, node):
    translator.body.append(tex2mathml(node.astext()))
    _skip()


def _block(translator, node):
    translator.body.append(
        f'<div class="equation">{tex2mathml(node.astext(), as_block=True)}</div>'
    )
    _skip()


def _skip():
    from docutils.nodes import SkipNode

    raise SkipNode
