#!/usr/bin/env python3
"""scripts/record_compare.py FOLDER_A FOLDER_B: whether two records of scripts/record.sh are the same.

Files whose bytes are equal are equal. Others are read as JSON, as text (CSV too) or as bytes, by what they hold (the data in
a page and the head of a GLB file as JSON), and compared once what differs from run to run (the lists below) is left out. A
file or a key that only one side has is a difference.

Prints a line for each difference (command, file, place, both values), and for each file with different numbers the largest
difference in units in the last place. These are units of the largest number around it, because small numbers beside large
ones carry the rounding of the large ones:
  - of rows l, m, numbers... (JSON or CSV): the largest of the same degree l in that file;
  - of a list of numbers in JSON: the largest of the list; of other rows of text: the largest of the line;
  - of a single number: the number itself.
Numbers written without point and exponent are counts: they are compared, and no unit is taken from them.

Exit codes: 0 all is equal, 1 there are differences, 2 usage, 3 a folder is not a record.
"""

import difflib
import json
import math
import re
import sys
from pathlib import Path

# --- What is left out ---------------------------------------------------------------------------------------------------

# JSON members, wherever they stand, with all that is below them.
LEFT_OUT_KEYS = {
    "created": "the date",
    "timings": "times measured",
    "seconds": "times measured",
    "version": "of the program",
    "threads": "of the machine",
    "flops_per_second": "measured",
    "of_peak": "measured",
    "peak": "measured: multiply-adds of the machine",
    "peak_resident_bytes": "measured: memory of the process",
}
LEFT_OUT_KEY_ENDS = ("_seconds",)

# Parts of lines of text, of texts in JSON and of binary files. The group of each stays, and the rest of the match is left out.
LEFT_OUT_PATTERNS = [
    (r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", "the date"),
    (r"(\bcowgpu )\d+\.\d+\.\d+\b", "the program's version"),
    (r"\b\d+( threads?\b)", "of the machine"),
]

# Of text alone, and of texts in JSON.
LEFT_OUT_OF_TEXT = [
    (r"^( *time: ).*", "times measured"),
    (r"( in )[\d.]+ s\b", "times measured"),
    (r"^(  seconds of the sum +).*", "times measured"),
    (r"( closest points, )[\d.]+ s\b", "the time of a search"),
    (r"(, )[\d.e+]+ a second", "a rate measured"),
    (r"^(\[\d+/\d+\] .*: )[\d.]+ s$", "the time of a stage of reproduce"),
    (r"^(\d+ figures, )[\d.]+ s$", "the time of reproduce"),
    (r"(; )[\d.]+ s of stages", "the time of reproduce"),
    (r"^(\| [^|]+ \| )[\d.]+( \| \d+ \| `cowgpu )", "the time of a stage in reproduce.md"),
    (r"^(  (?:set-up|synthesis|analysis) +)[\d.]+ s", "times of a round trip"),
    (r"(peak of the process )\d+ MiB", "measured: memory of the process"),
    (r"( multiply-add peak )[\d.]+", "measured: the machine's speed"),
    (r"^( +\d+  (?:CPU, one thread|CPU, all threads|Vulkan) ).*", "times of bench"),
    (r"^( +\S+ +\S+ \+- .*) [\d.]+$", "the last column of inflate, seconds"),
    (r"(?<![\w.])/(?:[\w.+-]+/)+", "folders of the machine: where the program and its meshes lie"),
]

# Files of a command, by the end of their path.
LEFT_OUT_FILES = {
    "data/stages.json": "hashes of the program, and of files that hold times",
    "data/.lock": "empty",
}

# --- Comparing ----------------------------------------------------------------------------------------------------------

MOST_LINES = 12  # shown of one file
NUMBER = re.compile(r"(?<![\w.])[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?(?![\w.])")
ABSENT = object()


def pattern(expression, flags=0):
    return re.compile(expression, flags)


PATTERNS = [pattern(p) for p, _ in LEFT_OUT_PATTERNS]
TEXT_PATTERNS = [pattern(p, re.M) for p, _ in LEFT_OUT_OF_TEXT]


def without(text, patterns):
    for p in patterns:
        text = p.sub(lambda m: (m.group(1) if m.re.groups else "") + "~" + (m.group(2) if m.re.groups > 1 else ""), text)
    return text


def is_real(word):
    return any(c in word for c in ".eE")


def shown(value):
    if value is ABSENT:
        return "(nothing)"
    text = value if isinstance(value, str) else json.dumps(value)
    return text if len(text) <= 100 else text[:97] + "..."


class Differences:
    """The differences of one file."""

    def __init__(self):
        self.lines = []
        self.worst = None  # (units, place, a, b)

    def add(self, place, a, b):
        self.lines.append(f"{place}: {shown(a)} | {shown(b)}")

    def number(self, place, a, b, scale):
        """Two numbers that differ; scale is the largest around them, 0 for their own size."""
        self.add(place, a, b)
        x, y = float(a), float(b)
        scale = max(scale, abs(x), abs(y)) if scale == 0 else scale
        if not (math.isfinite(x) and math.isfinite(y) and math.isfinite(scale)):
            return
        units = abs(x - y) / math.ulp(scale)
        if self.worst is None or units > self.worst[0]:
            self.worst = (units, place, a, b)


def degree_scales(rows):
    """Of rows [l, m, numbers...] the largest number of each degree; None for other rows."""
    scales = {}
    for row in rows:
        if len(row) < 3 or not all(isinstance(x, (int, float)) and not isinstance(x, bool) for x in row):
            return None
        l, m = row[0], row[1]
        if not (isinstance(l, int) and isinstance(m, int) and abs(m) <= l):
            return None
        scales[l] = max([scales.get(l, 0.0)] + [abs(x) for x in row[2:] if math.isfinite(x)])
    return scales


def largest(values):
    return max([abs(v) for v in values if isinstance(v, float) and math.isfinite(v)], default=0.0)


def compare_json(a, b, place, out, scale=0.0):
    if isinstance(a, dict) and isinstance(b, dict):
        for key in list(a) + [k for k in b if k not in a]:
            if key in LEFT_OUT_KEYS or key.endswith(LEFT_OUT_KEY_ENDS):
                if (key in a) != (key in b):
                    out.add(f"{place}/{key}", a.get(key, ABSENT), b.get(key, ABSENT))
                continue
            if key in a and key in b:
                compare_json(a[key], b[key], f"{place}/{key}", out)
            else:
                out.add(f"{place}/{key}", a.get(key, ABSENT), b.get(key, ABSENT))
        if [k for k in a if k in b] != [k for k in b if k in a]:
            out.add(place, "order of members " + ", ".join(a), "order of members " + ", ".join(b))
    elif isinstance(a, list) and isinstance(b, list):
        if len(a) != len(b):
            out.add(place, f"{len(a)} elements", f"{len(b)} elements")
        scales = degree_scales(a) if a and all(isinstance(x, list) for x in a) else None
        own = largest(a + b)
        for i, (x, y) in enumerate(zip(a, b)):
            where = f"{place}/{i}"
            if scales is not None and isinstance(y, list) and x[:2] == y[:2] and len(x) == len(y):
                for j, (p, q) in enumerate(zip(x, y)):
                    compare_json(p, q, f"{where}/{j}", out, scales[x[0]])
            else:
                compare_json(x, y, where, out, own)
    elif isinstance(a, str) and isinstance(b, str):
        all_patterns = PATTERNS + TEXT_PATTERNS
        if without(a, all_patterns) != without(b, all_patterns):
            out.add(place, a, b)
    elif type(a) is type(b) and isinstance(a, float):
        if a != b and not (math.isnan(a) and math.isnan(b)) or math.copysign(1, a) != math.copysign(1, b):
            out.number(place, a, b, scale)
    elif type(a) is not type(b) or a != b:
        numbers = all(isinstance(x, (int, float)) and not isinstance(x, bool) for x in (a, b))
        if numbers and (isinstance(a, float) or isinstance(b, float)):
            out.number(place, a, b, scale)
        else:
            out.add(place, a, b)


def csv_degree_scales(lines):
    """Of a table whose columns begin with l,m the largest number of each degree."""
    scales, inside = {}, False
    for line in lines:
        words = line.split(",")
        if words[:2] == ["l", "m"]:
            inside = True
        elif inside and len(words) > 2:
            numbers = [abs(float(w)) for w in words[2:] if NUMBER.fullmatch(w)]
            scales[words[0]] = max([scales.get(words[0], 0.0)] + numbers)
    return scales


def compare_line(number, a, b, scales, out):
    place = f"line {number}"
    if NUMBER.sub("#", a) != NUMBER.sub("#", b):
        at = next((i for i, (x, y) in enumerate(zip(a, b)) if x != y), min(len(a), len(b)))
        start = max(0, at - 40) if max(len(a), len(b)) > 100 else 0
        out.add(place, a[start : start + 97], b[start : start + 97])
        return
    first, second = NUMBER.findall(a), NUMBER.findall(b)
    scale = scales.get(a.split(",")[0], 0.0) if scales else 0.0
    if not scale:
        scale = max([abs(float(w)) for w in first + second if is_real(w)], default=0.0)
    for i, (x, y) in enumerate(zip(first, second)):
        if x != y and (is_real(x) or is_real(y)):
            out.number(f"{place}, number {i + 1}", x, y, scale)
        elif x != y:
            out.add(f"{place}, count {i + 1}", x, y)
    if first == second:
        out.add(place, a, b)


def compare_text(a, b, out):
    patterns = PATTERNS + TEXT_PATTERNS
    first, second = without(a, patterns).split("\n"), without(b, patterns).split("\n")
    scales = csv_degree_scales(first)
    if len(first) == len(second):
        blocks = [("replace", 0, len(first), 0, len(second))]
    else:
        out.add("lines", str(len(first)), str(len(second)))
        blocks = difflib.SequenceMatcher(None, first, second, autojunk=False).get_opcodes()
    for kind, i, i_end, j, j_end in blocks:
        if kind == "equal":
            continue
        while i < i_end or j < j_end:
            if i < i_end and j < j_end:
                if first[i] != second[j]:
                    compare_line(i + 1, first[i], second[j], scales, out)
            elif i < i_end:
                out.add(f"line {i + 1}", first[i], ABSENT)
            else:
                out.add(f"line {j + 1}", ABSENT, second[j])
            i, j = i + 1, j + 1


def compare_bytes(a, b, out):
    a, b = (without(x.decode("latin-1"), PATTERNS) for x in (a, b))
    if len(a) != len(b):
        out.add("size", f"{len(a)} bytes", f"{len(b)} bytes")
    differing = [i for i, (x, y) in enumerate(zip(a, b)) if x != y]
    if differing:
        at = differing[0]
        out.add(f"{len(differing)} bytes, first at {at}", a[at : at + 8].encode("latin-1").hex(),
                b[at : at + 8].encode("latin-1").hex())


def as_json(data):
    try:
        document = json.loads(data)
        return document if isinstance(document, (dict, list)) else None
    except (ValueError, RecursionError):
        return None


def split_glb(data):
    """The JSON chunk of a GLB file as text, and all after it."""
    length = int.from_bytes(data[12:16], "little")
    return data[20 : 20 + length].decode("utf-8", "replace"), data[20 + length :]


def split_page(text):
    """The JSON between script tags of a page, each part by itself, and the page without them."""
    tag = re.compile(r'(<script[^>]*type="application/json"[^>]*>)(.*?)(</script>)', re.S)
    return [as_json(part) for _, part, _ in tag.findall(text)], tag.sub(r"\1\3", text)


def compare_files(a, b):
    out = Differences()
    if a == b:
        return out
    first, second = as_json(a), as_json(b)
    if first is not None and second is not None:
        compare_json(first, second, "", out)
        return out
    if a[:4] == b[:4] == b"glTF":
        (json_a, rest_a), (json_b, rest_b) = split_glb(a), split_glb(b)
        first, second = as_json(json_a), as_json(json_b)
        if first is not None and second is not None:
            compare_json(first, second, "", out)
            compare_bytes(rest_a, rest_b, out)
            return out
    try:
        text_a, text_b = a.decode(), b.decode()
        if "\0" in text_a or "\0" in text_b:
            raise ValueError
    except ValueError:
        compare_bytes(a, b, out)
        return out
    if "<script" in text_a and "<script" in text_b:
        (data_a, rest_a), (data_b, rest_b) = split_page(text_a), split_page(text_b)
        if len(data_a) == len(data_b) and None not in data_a + data_b:
            text_a, text_b = rest_a, rest_b
            for i, (x, y) in enumerate(zip(data_a, data_b)):
                compare_json(x, y, f"data {i + 1} ", out)
    compare_text(text_a, text_b, out)
    return out


def files_of(folder):
    if not (folder / "inputs").is_dir():
        print(f"record_compare.py: {folder} is not a record: it has no folder `inputs`; make one with scripts/record.sh",
              file=sys.stderr)
        sys.exit(3)
    return {str(f.relative_to(folder)) for f in folder.rglob("*") if f.is_file()}


def main():
    if len(sys.argv) != 3:
        print("usage: scripts/record_compare.py FOLDER_A FOLDER_B", file=sys.stderr)
        return 2
    folders = [Path(word) for word in sys.argv[1:]]
    names = [files_of(folder) for folder in folders]
    every = sorted(n for n in names[0] | names[1] if not n.endswith(tuple(LEFT_OUT_FILES)))
    differing, commands = 0, set()
    for name in every:
        command, _, file = name.partition("/")
        commands.add(command)
        if name not in names[0] or name not in names[1]:
            print(f"{command}, {file}: only in {folders[0] if name in names[0] else folders[1]}")
            differing += 1
            continue
        found = compare_files(*((folder / name).read_bytes() for folder in folders))
        if not found.lines:
            continue
        differing += 1
        for line in found.lines[:MOST_LINES]:
            print(f"{command}, {file}, {line}")
        if len(found.lines) > MOST_LINES:
            print(f"{command}, {file}: {len(found.lines) - MOST_LINES} more differences")
        if found.worst:
            units, place, a, b = found.worst
            print(f"{command}, {file}: largest difference of numbers {units:.3g} units in the last place, at {place}: {a} | {b}")
    commands.discard("inputs")
    if differing:
        print(f"{differing} of {len(every)} files of {len(commands)} commands differ")
        return 1
    print(f"all equal: {len(every)} files of {len(commands)} commands")
    return 0


if __name__ == "__main__":
    sys.exit(main())
