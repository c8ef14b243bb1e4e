#!/usr/bin/env bash
# Man page and completions of one command: the page has no warning, and every shell that is installed completes options,
# choices and files by their suffixes.
#   test_command_docs.sh COMMAND FOLDER      FOLDER holds COMMAND.1, COMMAND.bash, _COMMAND and COMMAND.fish
set -euo pipefail
name=$1
docs=$(cd "$2" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
touch scan.ply scan.vdb scan.txt
mkdir shells
[ "$name" != isoshell ] || touch scan.usda

# Is this program here? What is left out without it is told to scripts/test.sh.
have() {
  command -v "$1" >/dev/null || { echo "${name}_docs in $1 (not installed)" >>"${ISOSHELL_LEFT_OUT:-/dev/null}"; false; }
}

fail() { echo "$name: $*" >&2; exit 1; }

expect() { # what, wanted words, found words
  [ "$(tr -s ' \n' '\n' <<<"$2" | sort)" = "$(tr -s ' \n' '\n' <<<"$3" | sort)" ] || fail "$1 gives '$3', not '$2'"
}

page=$docs/$name.1
if have man; then
  said=$(LC_ALL=C.UTF-8 MANWIDTH=80 man --warnings=w -l "$page" 2>&1 >/dev/null) && [ -z "$said" ] || fail "man: $said"
fi
if have groff; then
  said=$(groff -man -ww -z "$page" 2>&1) && [ -z "$said" ] || fail "groff: $said"
fi
if have mandoc; then
  said=$(mandoc -Tlint -Wwarning "$page") || fail "mandoc: $said"
fi

in_bash() { # words of the line, the last of which is completed
  COMP_WORDS=("$name" "$@") COMP_CWORD=$#
  "_$name"
  echo "${COMPREPLY[*]}"
}

in_fish() { fish --no-config -c "source '$docs/$name.fish'; complete -C '$name $*'" | cut -f 1 | tr '\n' ' '; }

# The line after two presses of the tabulator in a terminal: what it shows so many seconds later, without the line itself.
in_zsh() { # line, seconds
  zsh -f -s "$docs" "$1" "$folder" "$2" <<'END' | tr -d '\r' | tail -n 2
    zmodload zsh/zpty
    zpty shell env TERM=dumb zsh -f -i
    zpty -w shell "PS1='> '; fpath=($1 \$fpath); autoload -Uz compinit; compinit -u -D; cd $3; echo RE''ADY"
    zpty -r -m shell shown "*READY*"
    zpty -w -n shell "$2"$'\t\t'
    sleep $4
    while zpty -r -t shell shown; do print -rn -- "$shown"; done
    zpty -d shell
END
}

# A terminal does not say when it has shown all: what is not there soon is looked for again later.
zsh_shows() { # what, pattern, line
  local found seconds
  for seconds in 1 5 20 60 300; do
    found=$(in_zsh "$3" "$seconds")
    if grep -qE "$2" <<<"$found"; then return; fi
  done
  fail "$1 shows '$found', without '$2'"
}

# shellcheck disable=SC1090
source "$docs/$name.bash"
case "$name" in
  vdb_isomesh)
    expect "bash, a choice" "close keep" "$(in_bash a.ply b.ply --boundary "")"
    expect "bash, a choice begun" "keep" "$(in_bash a.ply b.ply --boundary k)"
    expect "bash, a choice after =" "keep" "$(in_bash a.ply b.ply --boundary = k)"
    expect "bash, a choice after = alone" "close keep" "$(in_bash a.ply b.ply --boundary =)"
    expect "bash, a file of an option" "scan.vdb shells" "$(in_bash --save-shell s)"
    expect "bash, INPUT" "scan.ply scan.vdb shells" "$(in_bash s)"
    expect "bash, OUTPUT" "scan.ply scan.vdb shells" "$(in_bash --vertices 10 a.ply s)"
    expect "bash, a third file" "" "$(in_bash a.ply b.ply s)"
    expect "bash, a number" "" "$(in_bash --vertices "")"
    expect "bash, options" "--save-shell --save-voronoi --save-level-set" "$(in_bash --save)"
    expect "bash, formats" "gltf glb" "$(in_bash --output-format g)"
    expect "bash, OUTPUT as an option" "scan.ply scan.vdb shells" "$(in_bash a.ply -o s)"
    if have fish; then
      expect "fish, a choice" "close keep" "$(in_fish a.ply b.ply --boundary "")"
      expect "fish, a file of an option" "scan.vdb shells/" "$(in_fish --save-shell s)"
      expect "fish, INPUT" "scan.ply scan.vdb shells/" "$(in_fish s)"
      expect "fish, options" "--save-shell --save-voronoi --save-level-set" "$(in_fish --save)"
    fi
    if have zsh; then
      zsh_shows "zsh, a choice" "^close +keep" "$name a.ply b.ply --boundary "
      zsh_shows "zsh, a file of an option" "$name --save-shell scan.vdb" "$name --save-shell sca"
      zsh_shows "zsh, INPUT" "^scan.ply +scan.vdb$" "$name scan"
      zsh_shows "zsh, OUTPUT as an option" "^scan.ply +scan.vdb$" "$name a.ply -o scan"
    fi
    ;;
  isoshell)
    expect "bash, a command" "info" "$(in_bash i)"
    expect "bash, commands and INPUT" "remesh info farm shells scan.ply scan.usda scan.vdb" "$(in_bash "")"
    expect "bash, a command of a command" "run report" "$(in_bash farm r)"
    for named in remesh ""; do  # shellcheck disable=SC2086
      expect "bash, $named INPUT" "scan.ply scan.usda scan.vdb shells" "$(in_bash $named s)"
      expect "bash, $named OUTPUT" "scan.ply scan.usda scan.vdb shells" "$(in_bash $named --vertices 10 a.ply s)"
      expect "bash, $named, a third file" "" "$(in_bash $named a.ply b.ply s)"
      expect "bash, $named, a choice" "keep" "$(in_bash $named a.ply b.ply --boundary k)"
    done
    expect "bash, options of a command" "--ref --ref-format" "$(in_bash info --ref)"
    expect "bash, MESH" "scan.ply scan.usda shells" "$(in_bash info s)"
    expect "bash, options of a command of a command" "--retry-failed" "$(in_bash farm run --ret)"
    expect "bash, a folder" "shells" "$(in_bash farm run shells s)"
    if have fish; then
      expect "fish, a command" "info" "$(in_fish inf)"
      expect "fish, a command of a command" "run" "$(in_fish farm ru)"
      expect "fish, INPUT" "scan.ply scan.usda scan.vdb shells/" "$(in_fish remesh s)"
      expect "fish, INPUT without a command" "scan.ply scan.usda scan.vdb shells/" "$(in_fish a.ply s)"
      expect "fish, MESH" "scan.ply scan.usda shells/" "$(in_fish info s)"
      expect "fish, a choice" "close keep" "$(in_fish remesh a.ply b.ply --boundary "")"
      expect "fish, options of a command of a command" "--retry-failed" "$(in_fish farm run --retr)"
    fi
    if have zsh; then
      zsh_shows "zsh, a command and its INPUT" "rem.*esh .* s" "$name rem"
      zsh_shows "zsh, a command and its commands" "^status +-- say how far a farm is" "$name fa"
      zsh_shows "zsh, INPUT" "^scan.ply +scan.usda +scan.vdb$" "$name remesh scan"
      zsh_shows "zsh, INPUT without a command" "^scan.ply +scan.usda +scan.vdb$" "$name scan"
      zsh_shows "zsh, OUTPUT without a command" "^scan.ply +scan.usda +scan.vdb$" "$name a.ply --vertices 10 scan"
      zsh_shows "zsh, MESH" "^scan.ply +scan.usda$" "$name info sca"
      zsh_shows "zsh, a choice" "^close +keep" "$name remesh a.ply b.ply --boundary "
      zsh_shows "zsh, options of a command of a command" "$name farm run --retry-failed" "$name farm run --ret"
    fi
    ;;
  vdb_meshinfo)
    expect "bash, MESH" "scan.ply shells" "$(in_bash s)"
    expect "bash, a second file" "" "$(in_bash a.ply s)"
    expect "bash, the reference" "scan.ply scan.vdb shells" "$(in_bash a.ply --ref s)"
    expect "bash, options" "--ref --ref-format" "$(in_bash --ref)"
    expect "bash, formats of the reference" "pcd ply" "$(in_bash --ref-format p)"
    if have fish; then
      expect "fish, MESH" "scan.ply shells/" "$(in_fish s)"
      expect "fish, the reference" "scan.ply scan.vdb shells/" "$(in_fish a.ply --ref s)"
    fi
    if have zsh; then
      zsh_shows "zsh, MESH" "$name scan.ply" "$name sca"
      zsh_shows "zsh, the reference" "^scan.ply +scan.vdb$" "$name a.ply --ref scan"
    fi
    ;;
esac
# No other option has these letters in this order, which is enough for fish 4.
expect "bash, a flag" "--version" "$(in_bash --versi)"
if have fish; then expect "fish, a flag" "--version" "$(in_fish --versi)"; fi
