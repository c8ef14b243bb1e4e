#!/usr/bin/env python3
"""Makes what is told of a command from its own --help, which is its option table in a fixed shape.

command_docs.py COMMAND FORM    FORM: man, bash, zsh or fish (completions), or table (of docs/guide/command.md, in Markdown)
"""

import os
import re
import subprocess
import sys
import textwrap
import time
from dataclasses import dataclass, field
from datetime import datetime, timezone
from pathlib import Path


def suffixes_in(text: str) -> list[str]:
    """Of files, as in: a mesh (.obj .ply) or a volume (.vdb)."""
    return list(dict.fromkeys(re.findall(r"(?<=[ (])\.([a-z0-9]+)", text)))


@dataclass
class Argument:
    """As INPUT or OUTPUT."""

    name: str
    text: str

    @property
    def suffixes(self) -> list[str]:
        return suffixes_in(self.text)


@dataclass
class Option:
    names: list[str]
    value: str  # what stands for it, as K; empty: a flag
    text: str
    fallback: str

    @property
    def words(self) -> list[str]:
        """What the value may be, as far as that can be listed: of auto|off|DEG[,FILE], auto and off."""
        if match := re.match(r"format of [A-Z]+: (.*)", self.text):
            return re.split(r", | or ", match[1])
        words = [re.sub(r"\[.*", "", word) for word in self.value.split("|")]
        return [word for word in words if word.islower() and word.isalpha()]

    @property
    def suffixes(self) -> list[str]:
        """Of the files that the value names; none where it is no file."""
        if match := re.match(r"(?:F|FILE)\.(\w+)", self.value):
            return [match[1]]
        return suffixes_in(self.text) if self.value == "INPUT" else []


@dataclass
class Command:
    name: str
    version: str
    synopsis: str
    description: list[str] = field(default_factory=list)  # paragraphs
    arguments: list[Argument] = field(default_factory=list)
    groups: dict[str, list[Option]] = field(default_factory=dict)
    statuses: list[tuple[str, str]] = field(default_factory=list)

    @property
    def options(self) -> list[Option]:
        return [option for group in self.groups.values() for option in group]


def option_of(block: str) -> Option:
    """Names and value stand in the first line, before two spaces or its end."""
    head, *rest = block.splitlines()
    names, text, *_ = re.split(r"  +", head.strip(), maxsplit=1) + [""]
    text = " ".join([text, *map(str.strip, rest)]).strip()
    fallback = ""
    if match := re.search(r" \[([^\]]*)\]$", text):
        fallback, text = match[1], text[: match.start()]
    value = re.sub(r"^(?:-[\w-]+(?:, )?)+ ?", "", names)
    return Option(re.findall(r"(?:^|(?<=, ))-[\w-]+", names), value, text, fallback)


def asked(tool: str, option: str) -> str:
    return subprocess.run([tool, option], check=True, capture_output=True, text=True).stdout


def read_command(tool: str) -> Command:
    synopsis, *paragraphs = asked(tool, "--help").strip("\n").split("\n\n")
    name, version = asked(tool, "--version").split()[:2]
    command = Command(name, version, synopsis)
    for paragraph in paragraphs:
        if match := re.match(r"Exit status: (.*)\.", " ".join(paragraph.split())):
            command.statuses = re.findall(r"(\d+) (.*?)(?=, \d+ |$)", match[1])
        elif match := re.match(r"([A-Z].*):\n(?=  -)", paragraph):
            blocks = re.split(r"\n(?=  -)", paragraph[match.end() :])
            command.groups[match[1]] = [option_of(block) for block in blocks]
        elif re.match(r"[A-Z]+  +", paragraph):
            for block in re.split(r"\n(?=[A-Z])", paragraph):
                argument, text = block.split(maxsplit=1)
                command.arguments.append(Argument(argument, " ".join(text.split())))
        else:
            command.description.append(" ".join(paragraph.split()))
    if not command.options or not command.statuses:
        raise SystemExit(f"command_docs: the help of {tool} is not in the shape that is known: no options or no statuses")
    return command


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

    summary = re.split(r"[:.]", command.description[0])[0]
    day = datetime.fromtimestamp(int(os.environ.get("SOURCE_DATE_EPOCH", time.time())), timezone.utc)
    lines = [f'.TH {command.name.upper()} 1 {day:%Y-%m-%d} "isoshell {command.version}" "User Commands"']
    lines += [".SH NAME", f"{command.name} \\- {summary[0].lower()}{plain(summary[1:])}"]
    lines += [".SH SYNOPSIS", f".B {command.name}", plain(command.synopsis.split(maxsplit=1)[1])]
    lines += [".SH DESCRIPTION", *lines_of(command.description[0])]
    for paragraph in command.description[1:]:
        lines += [".PP", *lines_of(paragraph)]
    for argument in command.arguments:
        lines += entry(f".I {argument.name}", argument.text)
    lines += [".SH OPTIONS"]
    for group, options in command.groups.items():
        lines += [f".SS {group}"]
        for option in options:
            head = ", ".join(f"\\fB{plain(name)}\\fR" for name in option.names)
            head += f" \\fI{plain(option.value)}\\fR" if option.value else ""
            lines += entry(head, option.text + (f" [{option.fallback}]" if option.fallback else ""))
    lines += [".SH EXIT STATUS"]
    for status, text in command.statuses:
        lines += entry(f".B {status}", text)
    return "\n".join(lines) + "\n"


NOTE = "of {0}. Made by scripts/command_docs.py from its --help.\n"


def bash(command: Command) -> str:
    function = f"_{command.name}"
    values = []
    for option in command.options:
        if not option.value:
            continue
        does = "return"
        if option.suffixes:
            does = f"{function}_files {' '.join(option.suffixes)}; return"
        elif option.words:
            does = f"{function}_words {' '.join(option.words)}; return"
        values.append(f"    {'|'.join(option.names)}) {does} ;;")
    places = [f"    {i}) {function}_files {' '.join(a.suffixes)} ;;" for i, a in enumerate(command.arguments)]
    takes = "|".join(name for option in command.options if option.value for name in option.names)
    names = " ".join(name for option in command.options for name in option.names)
    return f"""# bash completion {NOTE.format(command.name)}
{function}_words() {{ COMPREPLY=($(compgen -W "$*" -- "$current")); }}

# Folders, and files of these suffixes.
{function}_files() {{
  local IFS=$'\\n' suffix
  COMPREPLY=($(compgen -d -- "$current"))
  for suffix; do COMPREPLY+=($(compgen -f -X "!*.$suffix" -- "$current")); done
  compopt -o filenames 2>/dev/null || true
}}

{function}() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}} place=0 i
  COMPREPLY=()
  # --option=value is three words to bash.
  if [ "$current" = = ]; then
    current=
  elif [ "$previous" = = ]; then
    previous=${{COMP_WORDS[COMP_CWORD - 2]}}
  fi
  case "$previous" in
{chr(10).join(values)}
  esac
  if [[ $current == -* ]]; then {function}_words {names}; return; fi
  for ((i = 1; i < COMP_CWORD; i++)); do
    case "${{COMP_WORDS[i]}}" in
      {takes}) if [ "${{COMP_WORDS[i + 1]}}" = = ]; then i=$((i + 2)); else i=$((i + 1)); fi ;;
      -?*) ;;
      *) place=$((place + 1)) ;;
    esac
  done
  case "$place" in
{chr(10).join(places)}
  esac
}}
complete -F {function} {command.name}
"""


def quoted(text: str) -> str:
    return "'" + text.replace("'", "'\\''") + "'"


def zsh(command: Command) -> str:
    def files(suffixes: list[str]) -> str:
        return f'_files -g "*.({"|".join(suffixes)})(-.)"'

    specs = []
    for option in command.options:
        text = re.sub(r"([\[\]:\\])", r"\\\1", option.text)
        action = ""
        if option.value:
            does = files(option.suffixes) if option.suffixes else f"({' '.join(option.words)})" if option.words else " "
            label = re.sub(r"([:\\])", r"\\\1", option.value)
            action = f":{label}:{does}"
        for name in option.names:
            others = f"({' '.join(option.names)})" if len(option.names) > 1 else ""
            assign = "=" if option.value else ""
            specs.append(quoted(f"{others}{name}{assign}[{text}]{action}"))
    specs += [quoted(f"{i}:{a.name}:{files(a.suffixes)}") for i, a in enumerate(command.arguments, 1)]
    body = " \\\n  ".join(specs)
    return f"#compdef {command.name}\n# zsh completion {NOTE.format(command.name)}\n_arguments -s \\\n  {body}\n"


def fish(command: Command) -> str:
    name = command.name
    suffixes = dict.fromkeys(suffix for argument in command.arguments for suffix in argument.suffixes)

    def files(endings: list[str]) -> str:
        return quoted(f"(__{name}_files {quoted('|'.join(endings))})".replace("'", '"'))

    lines = [
        f"# fish completion {NOTE.format(name)}",
        "# Folders, and files of these suffixes.",
        f"function __{name}_files",
        "    __fish_complete_path (commandline -ct) | string match -er '(/|[.]('$argv[1]'))(\\s|$)'",
        "end",
        f"complete -c {name} -f -a {files(list(suffixes))}",
    ]
    for option in command.options:
        line = f"complete -c {name}"
        for spelled in option.names:
            line += f" -l {spelled[2:]}" if spelled.startswith("--") else f" -s {spelled[1:]}"
        if option.value:
            does = files(option.suffixes) if option.suffixes else quoted(" ".join(option.words)) if option.words else ""
            line += f" -x -a {does}" if does else " -x"
        lines.append(f"{line} -d {quoted(option.text)}")
    return "\n".join(lines) + "\n"


FORMS = {form.__name__: form for form in (man, bash, zsh, fish, table)}

if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[2] not in FORMS:
        raise SystemExit(__doc__)
    sys.stdout.write(FORMS[sys.argv[2]](read_command(str(Path(sys.argv[1]).resolve()))))
