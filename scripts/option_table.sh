#!/usr/bin/env bash
# Prints README's option table, made from the command's --help. With --update, puts it into README.md.
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
  { sed '/<!-- options: begin -->/q' README.md; table; sed -n '/<!-- options: end -->/,$p' README.md; } > "$made"
  cat "$made" > README.md
  rm -f "$made"
fi
