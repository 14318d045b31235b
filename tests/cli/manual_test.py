#!/usr/bin/env python3
"""Man pages and completions of bash are those of --help, and work: every option stands in both, what the build wrote is what
the program prints, the page passes a linter where there is one, and the shell completes.

usage: manual_test.py --program NAME=PATH... --share DIR
"""
import argparse
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile


def output(*words, **more):
    return subprocess.run(words, check=True, capture_output=True, text=True, timeout=120, **more).stdout


def options_of(text):
    """The long options at the beginning of lines of a help."""
    return {match[1] for match in re.finditer(r"^ +(?:-\w, )?(--[a-z][a-z0-9-]*)", text, re.MULTILINE)}


def complete(script, *words):
    """What the shell offers behind these words, the last of them unfinished."""
    listed = " ".join(f"'{word}'" for word in words)
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "some file.nrrd").touch()
        (pathlib.Path(folder) / "some-folder").mkdir()
        line = (f"source '{script}'; COMP_WORDS=({listed}); COMP_CWORD={len(words) - 1}; "
                "$(complete -p \"${COMP_WORDS[0]}\" | sed 's/.*-F \\([^ ]*\\) .*/\\1/'); printf '%s\\n' \"${COMPREPLY[@]}\"")
        return output("bash", "-c", line, cwd=folder).splitlines()


def lint(page):
    """Warnings of a linter, if one is installed."""
    if shutil.which("mandoc"):
        done = subprocess.run(["mandoc", "-T", "lint", "-W", "warning", page], capture_output=True, text=True, timeout=60)
        # A page without a date is the same whenever it is made.
        return [line for line in done.stdout.splitlines() if "missing date" not in line]
    if shutil.which("groff"):
        done = subprocess.run(["groff", "-man", "-ww", "-z", page], capture_output=True, text=True, timeout=60)
        return done.stderr.splitlines()
    return []


def check(name, path, share):
    man, script = share / "man/man1" / f"{name}.1", share / "bash-completion/completions" / name
    page = output(path, "--print-man")
    if name != "cli-probe":
        assert man.read_text() == page, f"{man} is not what {name} prints"
        assert script.read_text() == output(path, "--print-completion"), f"{script} is not what {name} prints"
    else:
        folder = pathlib.Path(tempfile.mkdtemp())
        man, script = folder / f"{name}.1", folder / name
        man.write_text(page)
        script.write_text(output(path, "--print-completion"))
    subprocess.run(["bash", "-n", str(script)], check=True)
    plain = page.replace("\\-", "-")
    text = output(path, "--help")
    commands = re.findall(r"^  ([a-z]+) {2,}\S", text.split("\nCommands:\n")[1], re.MULTILINE) if "\nCommands:\n" in text else []
    for command in commands or [""]:
        words = [command] if command else []
        wanted = options_of(output(path, *words, "--help"))
        assert len(wanted) >= 5, f"{name} {command}: only {wanted}"
        offered = set(complete(script, name, *words, "--"))
        assert wanted == {o for o in offered if o.startswith("--")}, f"{name} {command}: {wanted ^ offered}"
        missing = {o for o in wanted if f"\\fB{o}\\fR" not in plain}
        assert not missing, f"{name}.1 lacks {missing}"
        assert complete(script, name, *words, "--progress", "pl") == ["plain"]
        assert complete(script, name, *words, "--progress", "=", "ba") == ["bar"]
        assert complete(script, name, *words, "--config", "some f") == ["some file.nrrd"]
        if "--threads" in wanted:
            assert complete(script, name, *words, "-j", "") in ([], [""]), "nothing to guess for a number"
    if commands:
        assert set(commands) <= set(complete(script, name, "")), commands
    warnings = lint(str(man))
    assert not warnings, "\n".join(warnings)
    assert "print-man" not in text and "print-man" not in page


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", action="append", required=True)
    parser.add_argument("--share", type=pathlib.Path, required=True)
    options = parser.parse_args()
    for one in options.program:
        name, path = one.split("=", 1)
        check(name, str(pathlib.Path(path).resolve()), options.share.resolve())
        print(f"{name}: holds")
    return 0


if __name__ == "__main__":
    sys.exit(main())
