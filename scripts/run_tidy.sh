#!/usr/bin/env bash
# clang-tidy over the sources that changed since the branch left origin/main (or, without that branch, since the commit
# before this one), or over all of them. A changed header brings the source of the same name. --most N: of changed sources
# only the N with the most changed lines, so that a large merge does not take an hour; it says how many are left.
# usage: scripts/run_tidy.sh BUILD_DIR [--all | --most N]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

usage="usage: scripts/run_tidy.sh BUILD_DIR [--all | --most N]"
build_dir=${1:?$usage}
most=
case "${2-}" in
  "" | --all) [ $# -le 2 ] || { echo "$usage" >&2; exit 2; } ;;
  --most) [[ ${3-} =~ ^[1-9][0-9]*$ && $# = 3 ]] || { echo "$usage" >&2; exit 2; }; most=$3 ;;
  *) echo "$usage" >&2; exit 2 ;;
esac
patterns=('formats/*.cpp' 'libpreprocess/*.cpp' 'player/*.cpp' 'tools/*.cpp' 'tests/*.cpp')

changedSources() {
  local base
  base=$(git merge-base HEAD origin/main 2>/dev/null || true)
  # On main itself the merge base is the commit under test, which says nothing: compare with its parent.
  [ -n "$base" ] && [ "$base" != "$(git rev-parse HEAD)" ] || base=$(git rev-parse --verify -q HEAD~1 || true)
  if [ -z "$base" ]; then
    echo "tidy: no earlier commit to compare with" >&2
    return
  fi
  # Those with the most changed lines first: they take the longest, and are the last to be left out.
  git diff --numstat --no-renames --diff-filter=d "$base" -- "${patterns[@]}" "${patterns[@]/%.cpp/.h}" |
    awk -F '\t' '{ sub(/\.h$/, ".cpp", $3); lines[$3] += $1 + $2 } END { for (file in lines) print lines[file] "\t" file }' |
    sort -k1,1nr -k2 | cut -f 2 | tr '\n' '\0'
}

if [ "${2-}" = --all ]; then
  mapfile -d '' sources < <(git ls-files -z -- "${patterns[@]}")
else
  mapfile -d '' sources < <(changedSources)
fi

# Only what this build compiles has flags: a part that is switched off is left to the build that has it.
compiled=()
for source in "${sources[@]}"; do
  if grep -qF "\"file\": \"$PWD/$source\"" "$build_dir/compile_commands.json"; then
    compiled+=("$source")
  fi
done
if [ ${#compiled[@]} -eq 0 ]; then
  echo "tidy: no changed sources, nothing to check"
  exit 0
fi
left=0
if [ -n "$most" ] && [ ${#compiled[@]} -gt "$most" ]; then
  left=$((${#compiled[@]} - most))
  compiled=("${compiled[@]:0:most}")
fi
echo "tidy: ${#compiled[@]} sources"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
status=0
printf '%s\0' "${compiled[@]}" |
  xargs -0 -n 1 -P "$(nproc)" clang-tidy --quiet -p "$build_dir" >"$log" 2>/dev/null || status=$?
grep -v '^$' "$log" | head -n 300 || true
if [ $status -ne 0 ]; then
  echo "tidy: faults above" >&2
  exit 1
fi
echo "tidy: no faults"
[ $left = 0 ] || echo "tidy: $left changed sources more were not looked at; --all does"
