#!/usr/bin/env bash
# Prints the table of options of docs/guide/command.md, made from the command's --help. With --update, puts it there.
#   scripts/option_table.sh [--update] [path of vdb_isomesh]
set -euo pipefail
cd "$(dirname "$0")/.."
update=0
if [ "${1:-}" = --update ]; then update=1; shift; fi
tool=${1:-build/cpu/vdb_isomesh}

table() { python3 scripts/command_docs.py "$tool" table; }

if [ "$update" -eq 0 ]; then
  table
else
  made=$(mktemp)
  page=docs/guide/command.md
  { sed '/<!-- options: begin -->/q' "$page"; table; sed -n '/<!-- options: end -->/,$p' "$page"; } > "$made"
  cat "$made" > "$page"
  rm -f "$made"
fi
