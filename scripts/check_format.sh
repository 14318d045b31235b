#!/usr/bin/env bash
# Checks (or with --fix, mends) the layout of every C++ file against .clang-format.
# usage: scripts/check_format.sh [--fix]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

mapfile -d '' files < <(git ls-files -co --exclude-standard -z -- '*.h' '*.cpp' '*.cc')
existing=()
for file in "${files[@]}"; do [ ! -f "$file" ] || existing+=("$file"); done
if [ "${1-}" = --fix ]; then
  clang-format -i "${existing[@]}"
else
  clang-format --dry-run --Werror "${existing[@]}" || {
    echo "format: run scripts/check_format.sh --fix" >&2
    exit 1
  }
fi
echo "format: ${#existing[@]} files"
