"""The site of these pages, made by scripts/build_docs (Sphinx and MyST)."""

import os
import re

project = "Alidade"
extensions = ["myst_parser"]
myst_heading_anchors = 4
root_doc = "README"
exclude_patterns = []
# What a program prints is no language.
suppress_warnings = ["misc.highlighting_failure"]
html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_title = "Alidade"
html_show_sphinx = False
html_copy_source = False


def contents(index):
    """A table of contents for each heading of the index, of its links."""
    for part in re.split(r"^## ", index, flags=re.MULTILINE)[1:]:
        caption = part.splitlines()[0]
        pages = re.findall(r"\]\(([\w/]+)\.md\)", part)
        yield f"\n```{{toctree}}\n:hidden:\n:caption: {caption}\n\n"
        yield "".join(f"{page}\n" for page in dict.fromkeys(pages)) + "```\n"


def prepare(app, name, source):
    """The index gets its contents; links out of docs/ become words."""
    folder = os.path.dirname(os.path.join(app.srcdir, name))

    def keep(match):
        target = os.path.normpath(os.path.join(folder, match[2].split("#")[0]))
        inside = target.startswith(os.path.normpath(app.srcdir) + os.sep)
        is_web = re.match(r"\w+:", match[2])
        return match[0] if inside or is_web else match[1]

    text = re.sub(r"(?<!!)\[([^\]]*)\]\(([^)#\s]+[^)\s]*)\)", keep, source[0])
    if name == root_doc:
        text = text.replace("`api/index.html`",
                            '<a href="api/index.html">api/index.html</a>')
        text += "".join(contents(source[0]))
    source[0] = text


def setup(app):
    app.connect("source-read", prepare)
