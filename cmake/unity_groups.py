#!/usr/bin/env python3
"""Which sources of a target may be compiled as one file: at most eight, no two of which define a name of the same spelling
at namespace scope, and none that defines macros.

usage: unity_groups.py <LIST >FILE.cmake
A line of the list is `target;source;source…`; the file sets UNITY_GROUP of the sources.
"""
import collections
import pathlib
import re
import sys

MOST = 8
# A definition at the beginning of a line: what is inside namespaces is not indented, what is inside anything else is.
TYPE = re.compile(r"(?:template <.*>\s*)?(?:struct|class|enum class|enum|union|using|namespace) (\w+)")
OTHER = re.compile(r"[\w:<>,&*\[\] ]*?[\s&*](\w+)\s*(?:[(={\[;]|$)")
TEST = re.compile(r"(?:INSTANTIATE_)?(?:TYPED_)?TEST\w*\(")


def names_of(text):
    """The names that a source defines at namespace scope, or None for a source that must stand alone."""
    names = set()
    for line in text.splitlines():
        if re.match(r"#\s*define|using namespace", line):
            return None
        if not line or line[0] in " }#/)" or line.startswith("namespace tet4d") or TEST.match(line):
            continue
        found = TYPE.match(line) or OTHER.match(line)
        if found:
            names.add(found[1])
    return names


def groups_of(sources):
    groups = []
    for source in sources:
        names = names_of(pathlib.Path(source).read_text(encoding="utf-8"))
        if names is None:
            continue
        group = next((g for g in groups if len(g[0]) < MOST and not g[1] & names), None)
        if group is None:
            group = ([], set())
            groups.append(group)
        group[0].append(source)
        group[1].update(names)
    return [sources for sources, _ in groups if len(sources) > 1]


def main():
    targets = [line.split(";") for line in sys.stdin.read().splitlines()]
    # The property is a source's, not a target's: what two targets have in common is left alone.
    uses = collections.Counter(source for _, *sources in targets for source in set(sources))
    for target, *sources in targets:
        for number, group in enumerate(groups_of([source for source in sources if uses[source] == 1])):
            files = " ".join(f'"{source}"' for source in group)
            print(f"set_source_files_properties({files} TARGET_DIRECTORY {target} PROPERTIES UNITY_GROUP {target}_{number})")


if __name__ == "__main__":
    main()
