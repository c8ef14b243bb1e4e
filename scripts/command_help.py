"""A command as its own --help tells of it: in the fixed shape of our commands, or that of argparse. Where a help lists
commands, as that of isoshell, each is asked for its own."""

from __future__ import annotations

import os
import re
import subprocess
from dataclasses import dataclass, field


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
    of_argument: list[str] = field(default_factory=list)  # suffixes, where the value is an argument by its name

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
        return self.of_argument or (suffixes_in(self.text) if self.value == "INPUT" else [])


@dataclass
class Command:
    """Beside what it takes itself, the commands that its first word may name, and that which a call without one is."""

    name: str
    version: str
    synopsis: str
    description: list[str] = field(default_factory=list)  # paragraphs
    arguments: list[Argument] = field(default_factory=list)
    groups: dict[str, list[Option]] = field(default_factory=dict)
    statuses: list[tuple[str, str]] = field(default_factory=list)
    commands: list[Command] = field(default_factory=list)
    unnamed: Command | None = None
    text: str = ""  # of the command that names this one

    @property
    def word(self) -> str:
        return self.name.split()[-1]

    @property
    def function(self) -> str:
        return "_" + self.name.replace(" ", "_")

    @property
    def depth(self) -> int:
        """Words of the name behind the first."""
        return self.name.count(" ")

    @property
    def leaves(self) -> list[Command]:
        return [leaf for command in self.commands for leaf in command.leaves] or [self]

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


def asked(words: list[str], option: str) -> str:
    settings = {**os.environ, "COLUMNS": "100000"}  # argparse breaks no line then
    return subprocess.run([*words, option], check=True, capture_output=True, text=True, env=settings).stdout


def rows_of(paragraph: str, indent: str) -> list[tuple[str, str]]:
    """Of a list: what stands before two spaces or the end of the line, and the text that goes on below."""
    rows = []
    for block in re.split(rf"\n(?={indent}\S)", "\n" + paragraph)[1:]:
        head, text, *_ = re.split(r"  +|\n", block.strip(), maxsplit=1) + [""]
        rows.append((head, " ".join(text.split())))
    return rows


def command_of(words: list[str]) -> Command:
    *name, version = asked(words, "--version").split()
    return read_command(words, " ".join(name), version)


def read_command(words: list[str], name: str, version: str, told: str = "") -> Command:
    synopsis, *paragraphs = asked(words, "--help").strip("\n").split("\n\n")
    command = Command(name, version, synopsis.removeprefix("usage: "), text=told)
    for paragraph in paragraphs:
        if match := re.match(r"Exit status: (.*)\.", " ".join(paragraph.split())):
            command.statuses = re.findall(r"(\d+) (.*?)(?=, \d+ |$)", match[1])
        elif match := re.match(r"(Commands|positional arguments):\n", paragraph):
            read_list(command, words, paragraph[match.end() :])
        elif match := re.match(r"([A-Za-z].*):\n(?=  -)", paragraph):
            blocks = re.split(r"\n(?=  -)", paragraph[match.end() :])
            command.groups[match[1][0].upper() + match[1][1:]] = [option_of(block) for block in blocks]
        elif re.match(r"[A-Z]+  +", paragraph):
            command.arguments += [Argument(*row) for row in rows_of(paragraph, "")]
        else:
            command.description.append(" ".join(paragraph.split()))
    for option in command.options:
        option.of_argument = [end for argument in command.arguments if argument.name == option.value for end in argument.suffixes]
    if not command.options:
        raise SystemExit(f"command_docs: the help of {name} is not in a shape that is known: it has no options")
    return command


def read_list(command: Command, words: list[str], rows: str) -> None:
    """The commands, or arguments, that a help lists. argparse has commands below a row that names them all."""
    for head, text in rows_of(rows, "    ") or rows_of(rows, "  "):
        name, *takes = head.split()
        if name.isupper():
            command.arguments.append(Argument(name, text))
            continue
        named = read_command([*words, name], f"{command.name} {name}", command.version, text)
        command.commands.append(named)
        if takes and " ".join([command.name, *takes]) in text:
            command.unnamed = named
