"""What mkdocs asks while it builds the documentation site."""
import ast
import posixpath
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
OPTION = re.compile(r"(?<![\w-])--?[a-z][a-z-]*")
LINK = re.compile(r"\[([^\]]*)\]\(((?!https?:|#|mailto:)[^)#\s]+)(#[^)\s]*)?\)")


def on_config(config):
    """Decisions are many: they are listed by their titles, in their order."""
    decisions = []
    for path in sorted(Path(config.docs_dir, "decisions").glob("*.md")):
        title = path.read_text().split("\n", 1)[0].lstrip("# ")
        decisions.append({f"{path.name[:4]} {title}": f"decisions/{path.name}"})
    config.nav[-1]["For developers"].append({"Decisions": decisions})
    return config


def with_plain_pipes(markdown):
    """In the code of a table a pipe is itself here, where others need a backslash."""
    return re.sub(r"`[^`\n]*`", lambda code: code[0].replace(r"\|", "|"), markdown)


def keyword_lists():
    """The keywords as their docstring describes them: groups, and below each name: what it says."""
    tree = ast.parse((ROOT / "python/isoshell/_options.py").read_text())
    options = next(node for node in tree.body if isinstance(node, ast.ClassDef) and node.name == "Options")
    lines = []
    for line in ast.get_docstring(options).split("\n")[1:]:
        if re.fullmatch(r"[A-Z][a-z ]+:", line):
            lines += ["", f"### {line[:-1]}", ""]
        elif entry := re.fullmatch(r"    (\w+): (.*)", line):
            lines.append(f"- `{entry[1]}`: {entry[2]}")
        elif line.startswith("        "):
            lines[-1] += " " + line.strip()
    return "\n".join(lines)


def on_page_markdown(markdown, page, config, files):
    """Puts in what is made of other files. Links to files of the project that are no pages stay as text."""
    keywords = "{{ keywords of Python }}"
    if keywords in markdown:
        markdown = markdown.replace(keywords, keyword_lists())
    markdown = with_plain_pipes(markdown)
    folder = posixpath.dirname(page.file.src_uri)

    def plain_outside(link):
        target = posixpath.normpath(posixpath.join(folder, link[2]))
        is_folder = Path(config.docs_dir, target).is_dir()
        return link[1] if target.startswith("..") or is_folder else link[0]

    return LINK.sub(plain_outside, markdown)


def on_page_content(html, page, config, files):
    """Marks names of options, which site.css keeps whole: a line may break behind their hyphens otherwise."""
    return re.sub(r">[^<]+<", lambda text: OPTION.sub(r'<span class="option">\g<0></span>', text[0]), html)
