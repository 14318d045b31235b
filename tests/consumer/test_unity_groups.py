#!/usr/bin/env python3
"""Sources that cannot be compiled as one are kept apart.

usage: test_unity_groups.py CMAKE_DIR
"""
import pathlib
import sys
import tempfile

sys.path.insert(0, sys.argv[1])
sys.dont_write_bytecode = True
import unity_groups  # noqa: E402

TEXTS = {
    "a": "namespace tet4d {\nnamespace {\nconstexpr int kSame = 1;\nint helper(int x) {\n  return x;\n}\n}  // namespace\n}\n",
    "b": "namespace {\nstd::vector<double> helper() { return {}; }\n}\n",  # another helper
    "c": "namespace {\nstruct Local {\n  int helper = 0;\n};\n}\nvoid Reader::helper() {}\n",  # a member, not a name of the file
    "d": "namespace {\ntemplate <class T>\nclass Local {};\n}\n",
    "e": "#define ODD 1\nnamespace {\nint odd;\n}\n",
    "f": "TEST(Suite, One) {}\nINSTANTIATE_TEST_SUITE_P(A, B, C);\n",
    "g": "namespace {\nconst std::array<int, 2> kSame{1, 2};\n}\n",
    "h": "int kSame;\n",
}

with tempfile.TemporaryDirectory() as folder:
    paths = {name: pathlib.Path(folder) / f"{name}.cpp" for name in TEXTS}
    for name, text in TEXTS.items():
        paths[name].write_text(text)
    groups = unity_groups.groups_of([str(path) for path in paths.values()])
    found = [[pathlib.Path(path).stem for path in group] for group in groups]
    assert found == [["a", "c", "f"], ["b", "d", "g"]], found
    many = []
    for k in range(20):
        many.append(pathlib.Path(folder) / f"many{k}.cpp")
        many[-1].write_text(f"int name{k};\n")
    sizes = [len(group) for group in unity_groups.groups_of(map(str, many))]
    assert sizes == [8, 8, 4], sizes
