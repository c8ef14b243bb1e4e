#!/usr/bin/env python3
"""Makes what is told of a command from its own --help (command_help.py).

command_docs.py COMMAND... FORM    COMMAND: one that can be run, as vdb_isomesh, or python -m isoshell
                                   FORM: man, bash, zsh or fish (completions), or table (of docs/guide/command.md, in
                                   Markdown)
"""

from __future__ import annotations

import os
import re
import sys
import textwrap
import time
from datetime import datetime, timezone
from shutil import which

from command_completions import bash, fish, zsh
from command_help import Command, command_of


def table(command: Command) -> str:
    def cell(text: str) -> str:
        return text.replace("|", "\\|")

    rows = ["| option | meaning | default |", "| --- | --- | --- |"]
    for option in command.options:
        names = ", ".join(option.names) + (f" {option.value}" if option.value else "")
        rows.append(f"| `{cell(names)}` | {cell(option.text)} | {option.fallback} |")
    return "\n".join(rows) + "\n"


def man(command: Command) -> str:
    def plain(text: str) -> str:
        text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
        return re.sub(r"^\.", r"\\&.", text)

    def lines_of(text: str) -> list[str]:
        return [plain(line) for line in textwrap.wrap(text, 70, break_on_hyphens=False)]

    def entry(head: str, text: str) -> list[str]:
        return [".TP", head, *lines_of(text)]

    def paragraphs(command: Command) -> list[str]:
        lines = []
        for number, paragraph in enumerate(command.description):
            lines += [".PP"] * (number > 0) + lines_of(paragraph)
        for argument in command.arguments:
            lines += entry(f".I {argument.name}", argument.text)
        return lines

    def options(command: Command) -> list[str]:
        lines = []
        for group, rows in command.groups.items():
            lines += [f".SS {group}"] if group != "Options" else []
            for option in rows:
                head = ", ".join(f"\\fB{plain(name)}\\fR" for name in option.names)
                head += f" \\fI{plain(option.value)}\\fR" if option.value else ""
                lines += entry(head, option.text + (f" [{option.fallback}]" if option.fallback else ""))
        return lines

    def statuses(command: Command, head: str) -> list[str]:
        lines = [head] if command.statuses else []
        for status, text in command.statuses:
            lines += entry(f".B {status}", text)
        return lines

    summary = re.split(r"[:.]", command.description[0])[0]
    day = datetime.fromtimestamp(int(os.environ.get("SOURCE_DATE_EPOCH", time.time())), timezone.utc)
    lines = [f'.TH {command.name.upper()} 1 {day:%Y-%m-%d} "isoshell {command.version}" "User Commands"']
    lines += [".SH NAME", f"{command.name} \\- {summary[0].lower()}{plain(summary[1:])}", ".SH SYNOPSIS"]
    for number, leaf in enumerate(command.leaves):
        lines += [".br"] * (number > 0) + [f".B {leaf.name}", plain(leaf.synopsis.removeprefix(leaf.name).strip())]
    lines += [".SH DESCRIPTION", *paragraphs(command), ".SH OPTIONS", *options(command)]
    for leaf in command.leaves if command.commands else []:
        lines += [f'.SH "{leaf.name.upper()}"', *(paragraphs(leaf) if leaf.description else lines_of(leaf.text + "."))]
        lines += [*options(leaf), *statuses(leaf, ".SS Exit status")]
    return "\n".join(lines + statuses(command, ".SH EXIT STATUS")) + "\n"


FORMS = {form.__name__: form for form in (man, bash, zsh, fish, table)}

if __name__ == "__main__":
    _, *words, form = sys.argv
    if not words or form not in FORMS:
        raise SystemExit(__doc__)
    sys.stdout.write(FORMS[form](command_of([which(words[0]) or words[0], *words[1:]])))
