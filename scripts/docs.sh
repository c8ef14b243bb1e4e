#!/usr/bin/env bash
# Builds the documentation site into build/site, and fails on warnings and on pages that name another server. What it
# is made with comes from PyPI into build/docs once; then no network is needed. Open build/site/index.html;
# its search needs a server: python3 -m http.server -d build/site.
#   scripts/docs.sh
set -euo pipefail
cd "$(dirname "$0")/.."
packages=("mkdocs>=1.6,<2" "mkdocs-material>=9.6,<10" "mkdocstrings-python>=1.16,<3" black)
python=build/docs/bin/python

if ! "$python" -c "import material, mkdocstrings_handlers.python, black" 2>/dev/null; then
  echo "docs: installing ${packages[*]} from PyPI into build/docs" >&2
  rm -rf build/docs
  python3 -m venv build/docs
  if ! "$python" -m pip install --quiet --disable-pip-version-check "${packages[@]}"; then
    rm -rf build/docs
    echo "docs: PyPI cannot be reached, so the site is not built" >&2
    exit 1
  fi
fi

NO_MKDOCS_2_WARNING=1 DISABLE_MKDOCS_2_WARNING=true "$python" -m mkdocs build --strict --quiet --clean
"$python" scripts/check_site.py build/site
