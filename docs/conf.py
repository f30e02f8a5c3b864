"""Sphinx's configuration of the handbook (make handbook). Its pages are the Markdown files of the tree, at their places, so that every link works here as there."""

from pathlib import Path

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml

ROOT = Path(__file__).resolve().parent.parent
# Written by make verify; the chapter is left out where that has not been run.
REPORT = "results/verification"

needs_sphinx = "5.1"  # include_patterns
project = "Openclose"
author = "Openclose developers"
copyright = author
extensions = ["myst_parser"]
root_doc = "docs/index"
include_patterns = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "docs/*.md", "examples/**.md", REPORT + ".md"]
exclude_patterns = ["build", ".git"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
smartquotes = False  # words of scenes are copied from here with their quotes
pygments_style = "friendly"
html_theme = "sphinx_rtd_theme"
# The font is fonts-stix's (SIL Open Font License): with it the folder is whole, and can be sent to a colleague.
html_static_path = ["handbook.css", "/usr/share/fonts/opentype/stix-word/STIXMath-Regular.otf"]
html_css_files = ["handbook.css"]
html_title = "Openclose handbook"
html_show_sourcelink = False
html_copy_source = False


def formula(self, node) -> None:
    """MathML, which browsers show by themselves: no script, no network."""
    is_block = isinstance(node, nodes.math_block)
    text = tex2mathml(node.astext(), inline=not is_block)
    self.body.append(f'<div class="math">{text}</div>' if is_block else text)
    raise nodes.SkipNode


def leave_out_missing_report(_, docname: str, source: list[str]) -> None:
    if docname == root_doc and not (ROOT / f"{REPORT}.md").exists():
        source[0] = source[0].replace(f"Report of all cases <../{REPORT}>\n", "")


def setup(app) -> None:
    app.add_html_math_renderer("mathml", inline_renderers=(formula, None), block_renderers=(formula, None))
    app.connect("source-read", leave_out_missing_report)


html_math_renderer = "mathml"
