"""Completions of a command in bash, zsh and fish; command_docs.py prints them."""

from __future__ import annotations

import re

from command_help import Command

NOTE = "of {0}. Made by scripts/command_docs.py from its --help.\n"


def bash(command: Command) -> str:
    name, function = command.name, command.function
    functions = [bash_function(each, function) for each in with_commands(command)]
    return f"""# bash completion {NOTE.format(name)}
{function}_words() {{ COMPREPLY=($(compgen -W "$*" -- "$current")); }}

# Folders, and files of these suffixes.
{function}_files() {{
  local IFS=$'\\n' suffix
  COMPREPLY=($(compgen -d -- "$current"))
  for suffix; do COMPREPLY+=($(compgen -f -X "!*.$suffix" -- "$current")); done
  compopt -o filenames 2>/dev/null || true
}}

{chr(10).join(functions)}complete -F {function} {name}
"""


def with_commands(command: Command) -> list[Command]:
    """It and all below it, the innermost first."""
    return [each for below in command.commands for each in with_commands(below)] + [command]


def bash_function(command: Command, root: str) -> str:
    return bash_choice(command, root) if command.commands else bash_words(command, root)


def bash_choice(command: Command, root: str) -> str:
    """Of a command whose first word names another; `depth` is how many words of a line are names."""
    at, unnamed = command.depth + 1, command.unnamed
    cases = [f"    {each.word}) {each.function} ;;" for each in command.commands]
    files = ""
    if unnamed:
        cases.append(f"    *) depth={at - 1}; {unnamed.function} ;;")
        files = f"    {root}_files {' '.join(unnamed.arguments[0].suffixes)}\n"
    names = " ".join(name for option in command.options for name in option.names)
    return f"""{command.function}() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} depth={at}
  if [ "$COMP_CWORD" -eq {at} ]; then
    COMPREPLY=()
    if [[ $current == -* ]]; then {root}_words {names}; return; fi
{files}    COMPREPLY+=($(compgen -W "{' '.join(each.word for each in command.commands)}" -- "$current"))
    return
  fi
  case "${{COMP_WORDS[{at}]}}" in
{chr(10).join(cases)}
  esac
}}
"""


def bash_words(command: Command, root: str) -> str:
    values = []
    for option in command.options:
        if not option.value:
            continue
        does = "return"
        if option.suffixes:
            does = f"{root}_files {' '.join(option.suffixes)}; return"
        elif option.words:
            does = f"{root}_words {' '.join(option.words)}; return"
        values.append(f"    {'|'.join(option.names)}) {does} ;;")
    places = [f"    {i}) {root}_files {' '.join(a.suffixes)} ;;" for i, a in enumerate(command.arguments)]
    takes = "|".join(name for option in command.options if option.value for name in option.names)
    skip = f"""
      {takes}) if [ "${{COMP_WORDS[i + 1]}}" = = ]; then i=$((i + 2)); else i=$((i + 1)); fi ;;""" if takes else ""
    names = " ".join(name for option in command.options for name in option.names)
    return f"""{command.function}() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}} place={'-$depth' if command.depth else 0} i
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
  if [[ $current == -* ]]; then {root}_words {names}; return; fi
  for ((i = 1; i < COMP_CWORD; i++)); do
    case "${{COMP_WORDS[i]}}" in{skip}
      -?*) ;;
      *) place=$((place + 1)) ;;
    esac
  done
  case "$place" in
{chr(10).join(places)}
  esac
}}
"""


def quoted(text: str) -> str:
    return "'" + text.replace("'", "'\\''") + "'"


def zsh(command: Command) -> str:
    head = f"#compdef {command.name}\n# zsh completion {NOTE.format(command.name)}"
    if not command.commands:
        return f"{head}{zsh_arguments(command)}\n"
    functions = "".join(zsh_function(each) for each in with_commands(command))
    return f'{head}\n{functions}{command.function} "$@"\n'  # the file is what is called first


def zsh_files(suffixes: list[str]) -> str:
    return f'_files -g "*.({"|".join(suffixes)})(-.)"' if suffixes else "_files -/"


def zsh_arguments(command: Command) -> str:
    specs = zsh_options(command)
    specs += [quoted(f"{i}:{a.name}:{zsh_files(a.suffixes)}") for i, a in enumerate(command.arguments, 1)]
    return "_arguments -s \\\n  " + " \\\n  ".join(specs)


def zsh_options(command: Command) -> list[str]:
    specs = []
    for option in command.options:
        text = re.sub(r"([\[\]:\\])", r"\\\1", option.text)
        action = ""
        if option.value:
            does = zsh_files(option.suffixes) if option.suffixes else f"({' '.join(option.words)})" if option.words else " "
            label = re.sub(r"([:\\])", r"\\\1", option.value)
            action = f":{label}:{does}"
        for name in option.names:
            others = f"({' '.join(option.names)})" if len(option.names) > 1 else ""
            assign = ("=" if name.startswith("--") else "+") if option.value else ""
            specs.append(quoted(f"{others}{name}{assign}[{text}]{action}"))
    return specs


def zsh_function(command: Command) -> str:
    if not command.commands:
        return f"{command.function}() {{\n{zsh_arguments(command)}\n}}\n\n"
    names = " ".join(quoted(f"{each.word}:{each.text}") for each in command.commands)
    cases = [f'    ({each.word}) words=({each.word} "${{words[@]}}"); ((CURRENT += 1)); {each.function} ;;'
             for each in command.commands]
    files = ""
    if command.unnamed:
        files = f"; {zsh_files(command.unnamed.arguments[0].suffixes)}"
        cases.append(f'    (*) words=({command.word} "$line[1]" "${{words[@]}}"); ((CURRENT += 2)); {command.unnamed.function} ;;')
    specs = " \\\n  ".join([*zsh_options(command), "'1: :->command'", "'*::: :->words'"])
    return f"""{command.function}() {{
local -a line state commands=({names})
_arguments -s -C \\
  {specs}
case "$state" in
(command) _describe -t commands command commands{files} ;;
(words)
    case "$line[1]" in
{chr(10).join(cases)}
    esac ;;
esac
}}

"""


def fish(command: Command) -> str:
    name = command.name
    lines = [
        f"# fish completion {NOTE.format(name)}",
        "# Folders, and files of these suffixes.",
        f"function __{name}_files",
        "    __fish_complete_path (commandline -ct) | string match -er '(/|[.]('$argv[1]'))(\\s|$)'",
        "end",
    ]
    return "\n".join(lines + fish_lines(command, name, [], "")) + "\n"


def fish_lines(command: Command, root: str, seen: list[str], when: str) -> list[str]:
    """`seen`: the conditions that the line names this command; `when`: the same and that it names none below it."""
    if not command.commands:
        return fish_words(command, root, when)
    words = " ".join(each.word for each in command.commands)
    none = "; and ".join([*seen, f"not __fish_seen_subcommand_from {words}"])
    lines = [f"complete -c {root} -f -n {quoted(none)} -a {each.word} -d {quoted(each.text)}" for each in command.commands]
    for each in command.commands:
        here = [*seen, f"__fish_seen_subcommand_from {each.word}"]
        if each is command.unnamed:
            here = [*seen, f"not __fish_seen_subcommand_from {words.replace(each.word, '').strip()}"]
        lines += fish_lines(each, root, here, "; and ".join(here))
    return lines


def fish_words(command: Command, root: str, when: str) -> list[str]:
    def files(endings: list[str]) -> str:
        return quoted(f"(__{root}_files {quoted('|'.join(endings))})".replace("'", '"'))

    start = f"complete -c {root}" + (f" -n {quoted(when)}" if when else "")
    suffixes = dict.fromkeys(suffix for argument in command.arguments for suffix in argument.suffixes)
    lines = [f"{start} -f -a {files(list(suffixes))}"]
    for option in command.options:
        line = start
        for spelled in option.names:
            line += f" -l {spelled[2:]}" if spelled.startswith("--") else f" -s {spelled[1:]}"
        if option.value:
            does = files(option.suffixes) if option.suffixes else quoted(" ".join(option.words)) if option.words else ""
            line += f" -x -a {does}" if does else " -x"
        lines.append(f"{line} -d {quoted(option.text)}")
    return lines
