#!/usr/bin/env python3
"""Runs a file of command-line cases: command -> exit code, stdout, stderr, files. The cases' fields: README.md."""

import argparse
import importlib.util
import json
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time

FIELDS = {
    "name", "run", "shell", "exit", "stdout", "stderr", "not_stdout", "not_stderr", "json", "json_file", "file",
    "absent", "prepare", "stdin", "limits", "interrupt", "needs", "check", "timeout", "measures_memory", "long_sweep",
}

SLOW = 5  # seconds from which a case is named


class Result:
    """What a case's command did."""

    def __init__(self, code, stdout, stderr, directory):
        self.code, self.stdout, self.stderr, self.directory = code, stdout, stderr, directory


class Skip(Exception):
    """The case cannot be run here."""


def load_cases(path):
    """The list of cases of a .json or .py file."""
    if path.suffix == ".json":
        cases = json.loads(path.read_text())["cases"]
    else:
        sys.dont_write_bytecode = True
        spec = importlib.util.spec_from_file_location("cases", path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        cases = module.CASES
    names = [case["name"] for case in cases]
    for case in cases:
        unknown = set(case) - FIELDS
        assert not unknown, f"case '{case['name']}': unknown fields {sorted(unknown)}"
        assert ("run" in case) != ("shell" in case), f"case '{case['name']}': exactly one of run and shell"
        assert names.count(case["name"]) == 1, f"case '{case['name']}' is there twice"
    assert cases, f"{path}: no cases"
    return cases


def at_path(value, dotted):
    """The value at "a.b.0.c"; raises AssertionError where there is none."""
    for part in dotted.split("."):
        try:
            value = value[int(part)] if isinstance(value, list) else value[part]
        except (KeyError, IndexError, ValueError, TypeError):
            raise AssertionError(f"JSON has no '{dotted}' (at '{part}')") from None
    return value


def check_json(text, expected, where):
    try:
        value = json.loads(text)
    except ValueError as error:
        raise AssertionError(f"{where} is not JSON: {error}") from None
    for dotted, wanted in expected.items():
        found = at_path(value, dotted)
        if wanted == "*":
            continue
        if isinstance(wanted, dict) and "about" in wanted:
            fits = isinstance(found, (int, float)) and abs(found - wanted["about"]) <= wanted["within"]
        elif isinstance(wanted, dict) and "at_least" in wanted:
            fits = isinstance(found, (int, float)) and found >= wanted["at_least"]
        else:
            fits = found == wanted and isinstance(found, bool) == isinstance(wanted, bool)
        assert fits, f"{where}: '{dotted}' is {found!r}, expected {wanted!r}"


def check_fragments(text, fragments, where):
    """Every fragment appears, each after the one before."""
    assert isinstance(fragments, list), f"{where}: fragments must be a list"
    position = 0
    for fragment in fragments:
        found = text.find(fragment, position)
        assert found >= 0, f"{where} lacks {fragment!r}" + (" there" if fragment in text else "")
        position = found + len(fragment)


def check_manners(program, result):
    """What every program keeps: failures explained, no traces, nothing temporary left."""
    if result.code != 0 and program:
        lines = result.stderr.strip().splitlines()
        assert lines, f"exit {result.code} without a word on stderr"
        # A failure's last lines are its own message: `program: …`.
        assert lines[-1].split(": ")[0] == program, f"the last line on stderr does not begin with '{program}: '"
    for trace in ("terminate called", "Sanitizer", "runtime error:", "core dumped", "Traceback"):
        assert trace not in result.stderr, f"stderr has {trace!r}"
    left = [str(p.relative_to(result.directory)) for p in result.directory.rglob("*")
            if p.name.endswith(".part") or ".partial-" in p.name or ".tmp" in p.name]
    assert not left, f"temporary files were left: {left}"


class Runner:
    def __init__(self, programs, files, data, work, sanitized):
        self.programs, self.files, self.data, self.work, self.sanitized = programs, files, data, work, sanitized

    def fill(self, text):
        return text.replace("{files}", str(self.files)).replace("{data}", str(self.data))

    def words(self, case):
        if "shell" in case:
            # Programs by name: functions, so that the line reads as a user would type it.
            functions = "".join(f"{name}() {{ '{path}' \"$@\"; }}\n" for name, path in self.programs.items())
            return None, ["bash", "-e", "-o", "pipefail", "-c", functions + self.fill(case["shell"])]
        program, *rest = case["run"]
        if program not in self.programs:
            raise Skip(f"{program} is not built")
        return program, [self.programs[program]] + [self.fill(word) for word in rest]

    def require(self, case):
        for need in case.get("needs", []):
            if not (need in self.programs or (need.startswith("/") and os.path.exists(need))):
                raise Skip(f"{need} is not there")
        if self.sanitized and ("data" in case.get("limits", {}) or "ulimit -d" in case.get("shell", "")):
            raise Skip("sanitizers need more address space")
        if self.sanitized and case.get("measures_memory"):
            raise Skip("sanitizers take memory of their own")
        if self.sanitized and case.get("long_sweep"):
            raise Skip("the programs it runs have suites of their own")

    def set_limits(self, limits):
        """For the child: its limits, and signals as a shell would leave them."""
        names = {"data": resource.RLIMIT_DATA, "fsize": resource.RLIMIT_FSIZE}

        def apply():
            for name, most in limits.items():
                resource.setrlimit(names[name], (most, most))
            signal.signal(signal.SIGPIPE, signal.SIG_DFL)

        return apply

    def execute(self, case, directory):
        program, words = self.words(case)
        process = subprocess.Popen(words, cwd=directory, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, preexec_fn=self.set_limits(case.get("limits", {})))
        timeout = case.get("timeout", 60)
        if "interrupt" not in case:
            try:
                stdout, stderr = process.communicate(case.get("stdin", "").encode(), timeout=timeout)
            except subprocess.TimeoutExpired:
                process.kill()
                raise AssertionError(f"still running after {timeout} s") from None
            return program, Result(process.returncode, stdout.decode(errors="replace"),
                                   stderr.decode(errors="replace"), directory)
        watchdog = threading.Timer(timeout, process.kill)
        watchdog.start()
        stderr, sent = b"", False
        when = case["interrupt"]["when"].encode()
        while chunk := process.stderr.read1(4096):
            stderr += chunk
            if not sent and when in stderr:
                process.send_signal(getattr(signal, "SIG" + case["interrupt"].get("signal", "INT")))
                sent = True
        stdout, _ = process.communicate()
        watchdog.cancel()
        assert sent, f"{when!r} never appeared on stderr, so nothing was interrupted: {stderr.decode()}"
        return program, Result(process.returncode, stdout.decode(errors="replace"), stderr.decode(errors="replace"),
                               directory)

    def check(self, case, program, result):
        wanted = case.get("exit", 0)
        assert result.code == wanted, f"exit code {result.code}, expected {wanted}"
        check_fragments(result.stdout, [self.fill(f) for f in case.get("stdout", [])], "stdout")
        check_fragments(result.stderr, [self.fill(f) for f in case.get("stderr", [])], "stderr")
        for stream in ("stdout", "stderr"):
            for fragment in case.get("not_" + stream, []):
                assert fragment not in getattr(result, stream), f"{stream} has {fragment!r}"
        if "json" in case:
            check_json(result.stdout, case["json"], "stdout")
        for name, expected in case.get("json_file", {}).items():
            path = result.directory / name
            assert path.is_file(), f"{name} was not written"
            check_json(path.read_text(), expected, name)
        for name, expected in case.get("file", {}).items():
            path = result.directory / name
            assert path.is_file(), f"{name} was not written"
            text = path.read_text(errors="replace")
            if isinstance(expected, list):
                check_fragments(text, expected, name)
            else:
                assert text == expected, f"{name} is {text[:200]!r}, expected {expected[:200]!r}"
        for name in case.get("absent", []):
            assert not (result.directory / name).exists(), f"{name} is there"
        check_manners(program, result)
        if "check" in case:
            case["check"](result)

    def run(self, case, number):
        """None if the case holds, otherwise what is wrong. Raises Skip."""
        self.require(case)
        directory = self.work / f"{number:03}"
        shutil.rmtree(directory, ignore_errors=True)
        directory.mkdir(parents=True)
        for name, content in case.get("prepare", {}).items():
            path = directory / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(content)
        result = None
        try:
            program, result = self.execute(case, directory)
            self.check(case, program, result)
        except AssertionError as error:
            told = ""
            if result is not None:
                told = f"\n    stdout: {result.stdout[:1000]}\n    stderr: {result.stderr[:1000]}"
            return f"{error}{told}"
        shutil.rmtree(directory)
        return None


def share_of(text):
    """(K, N) of "K/N"."""
    k, n = (int(part) for part in text.split("/"))
    if not 1 <= k <= n:
        raise ValueError(text)
    return k, n


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", action="append", default=[], metavar="NAME=PATH")
    parser.add_argument("--files", type=pathlib.Path, default=pathlib.Path("files"))
    parser.add_argument("--data", type=pathlib.Path, default=pathlib.Path("data"))
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--sanitized", action="store_true")
    parser.add_argument("--only", default="", help="cases whose name contains this")
    parser.add_argument("--share", type=share_of, default=(1, 1), metavar="K/N", help="every Nth case, from the Kth on")
    parser.add_argument("cases", type=pathlib.Path)
    options = parser.parse_args()

    programs = dict(one.split("=", 1) for one in options.program)
    runner = Runner(programs, options.files, options.data, options.work.resolve(), options.sanitized)
    first, step = options.share
    cases = [(number, case) for number, case in enumerate(load_cases(options.cases)) if options.only in case["name"]]
    held = failed = skipped = 0
    for number, case in cases[first - 1::step]:
        start = time.monotonic()
        try:
            fault = runner.run(case, number)
        except Skip as reason:
            skipped += 1
            print(f"skipped  {case['name']}: {reason}")
            continue
        if (spent := time.monotonic() - start) >= SLOW:
            print(f"slow     {case['name']}: {spent:.1f} s")
        if fault is None:
            held += 1
        else:
            failed += 1
            print(f"FAILED   {case['name']}: {fault}")
    print(f"{options.cases.name}: {held} held, {failed} failed, {skipped} skipped")
    return 1 if failed or held == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
