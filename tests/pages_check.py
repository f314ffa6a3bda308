#!/usr/bin/env python3
"""tests/pages_check.py [--program PROGRAM] [--update | --links] [PAGE...]: whether pages show what the program prints now.

A page (Markdown) shows commands in blocks that begin with ```console: a line `$ COMMAND`, then what it prints. COMMAND goes on in
the next line after a backslash. All commands of a page run in one new folder, in which ./cowgpu is PROGRAM
(build/release/host/cowgpu), so that they can use each other's files, and standard output and standard error come as one text. A
line `...` stands for lines that are left out. A command that does not end with 0 is an error, unless `$ echo $?` follows.

What a sample and the output may differ in:
  - what differs from run to run and between machines: the lists below and those of scripts/record_compare.py;
  - numbers with a point or an exponent, by one in the last digit that is printed, or from the 14th digit on;
  - numbers below 1e-15 of the largest of their table, matrix or vector (neighbouring lines with two such numbers or more), which
    are nothing but rounding: any other number of that kind will do.

A block that names a mesh of the catalogue (benchmark, cgal:...) which is not on this machine is left out, and said so.

--update   writes what is printed now into the pages; the places of `...` stay
--links    runs no command of the pages: every link leads to a file or a heading, and every option that a page names exists
Without PAGE all pages of the project are meant.

Exit codes: 0 all is as shown, 1 something differs, 2 usage, 3 a page or the program is not there, 77 a block was left out.
"""

import argparse
import difflib
import itertools
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts"))
sys.dont_write_bytecode = True
import record_compare  # noqa: E402

LONGEST = 120  # seconds that a command may take
ROUNDING = 1e-15  # of the largest number of a table
DIGITS = 14  # that different machines agree in

# Parts of lines that differ between machines. What the groups hold stays, and the rest of the match is left out.
OF_THE_MACHINE = [
    (r"^((?: *\w+ )?device: ).*", "the device and its driver"),
    (r"^(  device  +).*", "the device and its driver"),
    (r"^(\d+: |cpu: |   double precision yes, |   \d+ threads?, ).*", "what `devices` lists"),
    (r"^((?:accuracy|estimate): .* known to )\S+( .*\(worst: )\d+", "rounding errors"),
    (r"^((?:accuracy|estimate): .* zero within )\S+", "rounding errors"),
    (r"^(accuracy: .*: )\S+ of degree \d+, \S+( of its estimated error)", "rounding errors"),
    (r"^(  (?:max_error|rms_error) +)\S+", "rounding errors"),
    (r"^(worst degree over the norms beside it: )\S+?(?=,|$)", "rounding errors"),
    (r"^(  \S.*?\S)  +(?:[\d.]+e-\d+)? +[\d.]+ +\d+( +\d+  (?:passed|FAILED))$", "rounding errors that `validate` finds"),
]
PATTERNS = record_compare.PATTERNS + record_compare.TEXT_PATTERNS + [re.compile(p, re.M) for p, _ in OF_THE_MACHINE]
NUMBER = record_compare.NUMBER
OPTION = re.compile(r"(?<![\w-])--[a-z][a-z0-9-]*")
REAL = r"\d[\d.]*(?:e[+-]\d+)?"
COMPLEX = re.compile(rf"([+-]?{REAL}) ?([+-]) ?({REAL}) ?i\b")  # whose parts are numbers with signs


class Step:
    """A command of a page, and the lines shown below it, from line `first` of the page on (counted from 0)."""

    def __init__(self, line, command, block):
        self.line, self.command, self.block = line, command, block
        self.first, self.shown = line + 1, []


def steps_of(lines):
    steps, block, inside, continued = [], 0, False, False
    for i, line in enumerate(lines):
        if not inside:
            if line.strip() == "```console":
                inside, block = True, block + 1
        elif line.strip() == "```":
            inside = continued = False
        elif continued or line.startswith("$ "):
            if continued:
                steps[-1].command += "\n" + line
                steps[-1].first = i + 1
            else:
                steps.append(Step(i, line[2:], block))
            continued = line.endswith("\\")
        elif not steps or steps[-1].block != block:
            raise ValueError(f"line {i + 1}: a block ```console begins with a command, `$ ...`")
        else:
            steps[-1].shown.append(line)
    return steps


# --- Comparing ----------------------------------------------------------------------------------------------------------


def comparable(line):
    return COMPLEX.sub(r"\1 \2\3 i", record_compare.without(line, PATTERNS)).rstrip()


def unit(word):
    """One in the last digit of a number as it is printed."""
    mantissa, _, exponent = word.lower().partition("e")
    return 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


def same_number(a, b, scale):
    if a == b:
        return True
    if not (record_compare.is_real(a) or record_compare.is_real(b)):
        return False
    x, y = float(a), float(b)
    if max(abs(x), abs(y)) < ROUNDING * scale:
        return True
    return abs(x - y) <= max(1.01 * max(unit(a), unit(b)), 10.0**-DIGITS * abs(x))


def same_line(shown, printed, scale):
    a, b = comparable(shown), comparable(printed)
    if a == b:
        return True
    first, second = NUMBER.findall(a), NUMBER.findall(b)
    if len(first) != len(second) or not all(same_number(x, y, scale) for x, y in zip(first, second)):
        return False
    if first == second:
        return False
    # Where numbers differ, so may the blanks that align them.
    return " ".join(NUMBER.sub(" # ", a).split()) == " ".join(NUMBER.sub(" # ", b).split())


def scales_of(lines):
    """For each line the largest number, of those that are not counts, of its table; 0 where it stands in none."""
    rows = [[abs(float(w)) for w in NUMBER.findall(comparable(line)) if record_compare.is_real(w)] for line in lines]
    scales = [0.0] * len(lines)
    for in_table, group in itertools.groupby(range(len(lines)), key=lambda i: len(rows[i]) >= 2):
        places = list(group)
        if in_table:
            for i in places:
                scales[i] = max(max(rows[j]) for j in places)
    return scales


def segments_of(shown):
    """Runs of lines between lines `...`, each with its place in `shown`."""
    segments = [[]]
    for i, line in enumerate(shown):
        if line.strip() == "...":
            segments.append([])
        else:
            segments[-1].append(i)
    return segments


def first_difference(shown, printed):
    """None where `printed` is as shown, else (index into shown, index into printed) of the first line that is not."""
    scales = scales_of(printed)
    segments = segments_of(shown)
    at = 0
    for number, segment in enumerate(segments):
        is_first, is_last = number == 0, number == len(segments) - 1

        def agreeing(start):
            for offset, i in enumerate(segment):
                j = start + offset
                if j >= len(printed) or not same_line(shown[i], printed[j], scales[j]):
                    return offset
            return len(segment)

        if is_first:
            starts = [0]
        elif is_last:
            starts = [len(printed) - len(segment)] if len(printed) - len(segment) >= at else []
        else:
            starts = range(at, len(printed) - len(segment) + 1)
        best = (-1, at)
        for start in starts:
            agree = agreeing(start)
            if agree > best[0]:
                best = (agree, start)
            if agree == len(segment):
                break
        agree, start = best
        if agree < len(segment):
            agree = max(agree, 0)
            return (segment[agree], min(start + agree, len(printed)))
        at = start + len(segment)
    if at < len(printed) and len(segments) == 1:
        return (len(shown), at)
    return None


def updated(shown, printed):
    """What is printed now, with `...` where the sample has it."""
    segments = segments_of(shown)
    if len(segments) == 1:
        return printed
    alike = difflib.SequenceMatcher(None)
    lines, at = [], 0
    for number, segment in enumerate(segments):
        if number:
            lines.append("...")
        size = len(segment)
        if number == 0:
            start = 0
        elif number == len(segments) - 1:
            start = max(at, len(printed) - size)
        else:

            def likeness(start):
                total = 0.0
                for offset, i in enumerate(segment):
                    alike.set_seqs(shown[i], printed[start + offset])
                    total += alike.ratio()
                return total

            start = max(range(at, len(printed) - size + 1), key=likeness, default=at)
        lines += printed[start : start + size]
        at = start + size
    return lines


# --- Running ------------------------------------------------------------------------------------------------------------


def meshes_missing(program):
    """Names of the catalogue whose files are not on this machine."""
    listed = subprocess.run([program, "meshes", "--json"], capture_output=True, text=True, check=True)
    return [mesh["name"] for mesh in json.loads(listed.stdout)["named"] if not mesh["path"]]


def named(meshes, text):
    return next((m for m in meshes if re.search(rf"(?<![\w:./-]){re.escape(m)}(?![\w:./-])", text)), None)


def check_page(page, program, update):
    """Problems found, and blocks left out."""
    lines = page.read_text(encoding="utf-8").split("\n")
    steps = steps_of(lines)
    if not steps:
        return [], []
    missing = meshes_missing(program)
    problems, left_out, absent = [], [], {}
    for step in steps:
        mesh = named(missing, step.command)
        if mesh and step.block not in absent:
            absent[step.block] = mesh
            left_out.append(f"{shown_path(page)}, line {step.line + 1}: the mesh {mesh} is not here; see data/meshes/README.md")
    changes = []
    with tempfile.TemporaryDirectory(prefix="cowgpu-page-") as folder:
        os.symlink(program, Path(folder) / "cowgpu")
        code = 0
        steps = [s for s in steps if s.block not in absent]
        for number, step in enumerate(steps):
            environment = dict(os.environ, LC_ALL="C.UTF-8", TZ="UTC", PATH=folder + os.pathsep + os.environ["PATH"])
            environment.pop("COLUMNS", None)
            before = code
            try:
                run = subprocess.run(["bash", "-c", f"(exit {before})\n{step.command}"], cwd=folder, env=environment, text=True,
                                     stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                     errors="replace", timeout=LONGEST, check=False)
                code, text = run.returncode, run.stdout
            except subprocess.TimeoutExpired:
                code, text = 124, ""
                problems.append(f"{shown_path(page)}, line {step.line + 1}: `{step.command}` runs for more than {LONGEST} s")
                continue
            printed = [line.rstrip() for line in text.split("\n")]
            while printed and not printed[-1]:
                printed.pop()
            shown = list(step.shown)
            while shown and not shown[-1].strip():
                shown.pop()
            following = steps[number + 1].command if number + 1 < len(steps) and steps[number + 1].block == step.block else ""
            if code and not following.startswith("echo $?"):
                problems.append(f"{shown_path(page)}, line {step.line + 1}: `{step.command}` ends with exit code {code}, and "
                                "no `$ echo $?` follows; it prints:\n  " + "\n  ".join(printed[-5:]))
                continue
            difference = first_difference(shown, printed)
            if difference and update:
                changes.append((step, len(shown), updated(shown, printed)))
            elif difference:
                i, j = difference
                problems.append(f"{shown_path(page)}, line {step.first + i + 1}, `{step.command}`\n"
                                f"  expected: {shown[i] if i < len(shown) else '(no more lines)'}\n"
                                f"  got:      {printed[j] if j < len(printed) else '(no more lines)'}")
    for step, count, now in reversed(changes):
        lines[step.first : step.first + count] = now
    if changes:
        page.write_text("\n".join(lines), encoding="utf-8")
        print(f"{shown_path(page)}: {len(changes)} samples written anew")
    return problems, left_out


# --- Links and options --------------------------------------------------------------------------------------------------


def anchor(heading):
    """The fragment that leads to a heading on a page, as GitHub makes it."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def without_blocks(text):
    return re.sub(r"^```.*?^```", lambda m: "\n" * m.group().count("\n"), text, flags=re.M | re.S)


def headings_of(page):
    return {anchor(h) for h in re.findall(r"^#+ (.*)$", without_blocks(page.read_text(encoding="utf-8")), re.M)}


class Options:
    """What options the program has."""

    def __init__(self, program):
        self.program, self.found = program, {}

    def of(self, *command):
        if command not in self.found:
            words = [*command, "--help"] if command else ["man"]
            text = subprocess.run([self.program, *words], capture_output=True, text=True, check=False).stdout
            self.found[command] = set(OPTION.findall(text.replace("\\-", "-")))
        return self.found[command]

    def missing(self, code):
        """The options in a piece of code that its command, or without a command the program, does not have."""
        command = re.match(r"(?:\$ +)?(?:\./)?cowgpu +([a-z]+)(?: +(analyse|synthesise|roundtrip)\b)?", code)
        known = self.of(*(w for w in command.groups() if w)) if command else self.of()
        return [option for option in OPTION.findall(code) if option not in known]


def check_links(page, options):
    problems = []
    text = page.read_text(encoding="utf-8")
    for number, line in enumerate(without_blocks(text).split("\n"), 1):
        for link in re.findall(r"\]\(([^)\s]+)\)", line):
            if re.match(r"[a-z]+:", link):
                continue
            path, _, fragment = link.partition("#")
            target = (page.parent / path) if path else page
            if not target.exists():
                problems.append(f"{shown_path(page)}, line {number}: the link {link} leads to nothing")
            elif fragment and fragment not in headings_of(target):
                problems.append(f"{shown_path(page)}, line {number}: {target.name} has no heading #{fragment}")
    about_benchmarks = page.parent.name == "bench" and page.name != "README.md"
    for number, line in enumerate(text.split("\n"), 1):
        code = re.findall(r"`([^`]+)`", line) if not line.startswith(("$ ", "    ")) else [line.strip()]
        for span in code:
            if re.match(r"(\$ +)?(\./)?cowgpu ", span) or (span.startswith("--") and not about_benchmarks):
                for option in options.missing(span):
                    problems.append(f"{shown_path(page)}, line {number}: `{span}`: the program has no option {option} there")
    return problems


# --- Command line -------------------------------------------------------------------------------------------------------


def shown_path(page):
    return page.relative_to(ROOT) if page.is_relative_to(ROOT) else page


def pages_of_project():
    listed = subprocess.run(["git", "-C", str(ROOT), "ls-files", "*.md"], capture_output=True, text=True, check=True)
    return [ROOT / name for name in listed.stdout.split()]


def main(words):
    parser = argparse.ArgumentParser(usage=__doc__.split("\n", 1)[0].partition(": ")[0])
    parser.add_argument("--program", type=Path, default=ROOT / "build/release/host/cowgpu")
    parser.add_argument("--update", action="store_true")
    parser.add_argument("--links", action="store_true")
    parser.add_argument("pages", metavar="PAGE", type=Path, nargs="*")
    arguments = parser.parse_args(words)
    program = arguments.program.resolve()
    pages = [p.resolve() for p in arguments.pages] or pages_of_project()
    for path in [program, *pages]:
        if not path.is_file():
            print(f"pages_check.py: {path} is not there", file=sys.stderr)
            return 3
    problems, left_out = [], []
    options = Options(program)
    for page in pages:
        try:
            if arguments.links:
                problems += check_links(page, options)
            else:
                found = check_page(page, program, arguments.update)
                problems += found[0]
                left_out += found[1]
        except ValueError as error:
            problems.append(f"{shown_path(page)}, {error}")
    for text in problems:
        print(text)
    for text in left_out:
        print(f"SKIPPED: {text}")
    if problems and not arguments.update:
        print("tests/pages_check.py --update writes what is printed now; read the difference before you commit it")
    return 1 if problems else 77 if left_out else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
