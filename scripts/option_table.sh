#!/usr/bin/env bash
# Prints README's option table, made from the command's --help. With --update, puts it into README.md.
#   scripts/option_table.sh [--update] [path of vdb_isomesh]
set -euo pipefail
cd "$(dirname "$0")/.."
update=0
if [ "${1:-}" = --update ]; then update=1; shift; fi
tool=${1:-build/cpu/vdb_isomesh}

table() {
  "$tool" --help | awk '
    function flush() {
      if (names == "") return
      fallback = ""
      if (match(text, / \[[^\]]*\]$/)) {
        fallback = substr(text, RSTART + 2, RLENGTH - 3)
        text = substr(text, 1, RSTART - 1)
      }
      gsub(/\|/, "\\|", names); gsub(/\|/, "\\|", text)
      printf "| `%s` | %s | %s |\n", names, text, fallback
      names = ""
    }
    BEGIN { print "| option | meaning | default |"; print "| --- | --- | --- |" }
    /^  -/ {
      flush()
      line = substr($0, 3)
      if (match(line, /  +/)) { names = substr(line, 1, RSTART - 1); text = substr(line, RSTART + RLENGTH) }
      else { names = line; text = "" }
      next
    }
    /^        / && names != "" { sub(/^ +/, ""); text = text (text == "" ? "" : " ") $0; next }
    { flush() }
    END { flush() }'
}

if [ "$update" -eq 0 ]; then
  table
else
  made=$(mktemp)
  { sed '/<!-- options: begin -->/q' README.md; table; sed -n '/<!-- options: end -->/,$p' README.md; } > "$made"
  cat "$made" > README.md
  rm -f "$made"
fi
