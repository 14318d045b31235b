#!/usr/bin/env python3
"""The runner must fail when a program does not do what a case says."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

RUNNER = pathlib.Path(__file__).with_name("run_cases.py")

# A program with the manners of ours: `tool exit CODE`, `tool json`, `tool leave NAME`, `tool loop`.
TOOL = f"#!{sys.executable}" + """
import signal, sys, time
def stop(number, frame):
    print("tool: interrupted", file=sys.stderr)
    sys.exit(1)
signal.signal(signal.SIGINT, stop)
what, argument = sys.argv[1], (sys.argv + [""])[2]
if what == "exit":
    print("tool: said so", file=sys.stderr)
    sys.exit(int(argument))
if what == "quiet":
    sys.exit(1)
if what == "json":
    print('{"a": {"b": [1, 2.5]}, "yes": true}')
if what == "leave":
    open(argument, "w").write("content")
if what == "loop":
    sys.stderr.write("running\\n")
    time.sleep(30)
"""


class RunnerTest(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.place.name)
        self.tool = self.root / "tool"
        self.tool.write_text(TOOL)
        self.tool.chmod(0o755)

    def tearDown(self):
        self.place.cleanup()

    def holds(self, **case):
        cases = self.root / "tool.json"
        cases.write_text(json.dumps({"cases": [{"name": "case", **case}]}))
        done = subprocess.run([sys.executable, str(RUNNER), "--program", f"tool={self.tool}", "--work",
                               str(self.root / "work"), str(cases)], capture_output=True, text=True, check=False)
        return done.returncode == 0

    def test_exit_code(self):
        self.assertTrue(self.holds(run=["tool", "exit", "3"], exit=3))
        self.assertFalse(self.holds(run=["tool", "exit", "3"], exit=2))
        self.assertFalse(self.holds(run=["tool", "exit", "3"]))

    def test_failures_must_speak(self):
        self.assertFalse(self.holds(run=["tool", "quiet"], exit=1))

    def test_fragments_in_order(self):
        self.assertTrue(self.holds(run=["tool", "exit", "1"], exit=1, stderr=["tool", "said"]))
        self.assertFalse(self.holds(run=["tool", "exit", "1"], exit=1, stderr=["said", "tool"]))
        self.assertFalse(self.holds(run=["tool", "exit", "1"], exit=1, not_stderr=["said"]))

    def test_json(self):
        self.assertTrue(self.holds(run=["tool", "json"], json={"a.b.0": 1, "yes": True, "a": "*"}))
        self.assertTrue(self.holds(run=["tool", "json"], json={"a.b.1": {"about": 2.4, "within": 0.2}}))
        self.assertFalse(self.holds(run=["tool", "json"], json={"a.b.1": {"about": 2.4, "within": 0.01}}))
        self.assertFalse(self.holds(run=["tool", "json"], json={"a.b.1": {"at_least": 3}}))
        self.assertFalse(self.holds(run=["tool", "json"], json={"a.c": "*"}))
        self.assertFalse(self.holds(run=["tool", "json"], json={"yes": 1}))
        self.assertFalse(self.holds(run=["tool", "exit", "0"], json={"a": "*"}))

    def test_files(self):
        self.assertTrue(self.holds(run=["tool", "leave", "f"], file={"f": "content"}))
        self.assertTrue(self.holds(run=["tool", "leave", "f"], file={"f": ["con", "tent"]}, absent=["g"]))
        self.assertFalse(self.holds(run=["tool", "leave", "f"], file={"f": "conten"}))
        self.assertFalse(self.holds(run=["tool", "leave", "f"], absent=["f"]))
        for temporary in ("f.part", "f.partial-123-0", "f.tmp1"):
            self.assertFalse(self.holds(run=["tool", "leave", temporary]), "temporary files are noticed")

    def test_interrupt(self):
        self.assertTrue(self.holds(run=["tool", "loop"], exit=1, interrupt={"when": "running"}))
        self.assertFalse(self.holds(run=["tool", "loop"], exit=0, interrupt={"when": "running"}))
        self.assertFalse(self.holds(run=["tool", "exit", "0"], exit=0, interrupt={"when": "never"}))

    def test_shell(self):
        self.assertTrue(self.holds(shell="tool json | grep -q yes"))
        self.assertFalse(self.holds(shell="tool exit 1 | cat"), "pipes fail with their first command")

    def test_a_file_of_skipped_cases_fails(self):
        self.assertFalse(self.holds(run=["tool", "json"], needs=["another-tool"]))

    def test_shares_run_every_case_once(self):
        cases = self.root / "tool.json"
        cases.write_text(json.dumps({"cases": [
            {"name": str(n), "shell": f"test ! -e {self.root}/{n}; touch {self.root}/{n}"} for n in range(7)]}))
        words = [sys.executable, str(RUNNER), "--program", f"tool={self.tool}", "--work", str(self.root / "work"), str(cases)]
        for k in range(1, 4):
            self.assertEqual(subprocess.run([*words, "--share", f"{k}/3"], capture_output=True, check=False).returncode, 0)
        self.assertTrue(all((self.root / str(n)).exists() for n in range(7)))
        for wrong in ("0/3", "4/3", "1"):
            self.assertEqual(subprocess.run([*words, "--share", wrong], capture_output=True, check=False).returncode, 2)

    def test_unknown_fields_are_refused(self):
        self.assertFalse(self.holds(run=["tool", "json"], stdouts=["x"]))


if __name__ == "__main__":
    unittest.main()
