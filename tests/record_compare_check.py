#!/usr/bin/env python3
"""record_compare_check.py SCRIPT: what scripts/record_compare.py finds between two small records, and what it leaves out."""

import json
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

SCRIPT = sys.argv[1]

RESULT = {
    "schema": "cowgpu.result.v1",
    "created": "2026-01-02T03:04:05Z",
    "program": {"name": "cowgpu", "version": "0.1.0"},
    "timings": {"total": 1.5},
    "mass": 0.0680396978239181,
    "coefficients": [[0, 0, 1.0, 0.0], [1, 0, 1e-17, 0.0], [2, 0, 0.5, 0.0], [2, 1, 1e-9, 0.25]],
    "counts": [3, 4],
}


def glb(head, rest):
    text = json.dumps(head).encode()
    return b"glTF" + bytes(8) + len(text).to_bytes(4, "little") + b"JSON" + text + rest


FILES = {
    "inputs/body.off": b"OFF\n",
    "001-one/exit_code": b"0\n",
    "001-one/stdout": b"mesh /home/a/cow.off, 12 triangles\n  time: map 0.063 s\n  volume   1.25\n",
    "001-one/stderr": b"",
    "001-one/result.json": json.dumps(RESULT).encode(),
    "001-one/table.csv": b"# created 2026-01-02T03:04:05Z\nl,m,C,S\n2,0,0.5,0\n2,1,1e-9,0.25\n",
    "001-one/body.glb": glb({"created": "now", "x": 1.5}, zlib.compress(b"vertices")),
    "001-one/page.html": b'<script type="application/json">{"seconds":1.5,"order":4,"x":2.5}</script>\n<p>page</p>\n',
    "002-two/exit_code": b"3\n",
    "002-two/data/stages.json": b'{"key":"a hash of the program"}',
}


def write(folder, files):
    for name, data in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)


def compared(changes=None, missing=()):
    """Exit code and lines of a comparison with a record in which parts of files are others."""
    with tempfile.TemporaryDirectory() as place:
        a, b = Path(place) / "a", Path(place) / "b"
        write(a, FILES)
        other = dict(FILES)
        for name, (old, new) in (changes or {}).items():
            assert old in other[name], (name, old)
            other[name] = other[name].replace(old, new, 1)
        for name in missing:
            del other[name]
        write(b, other)
        run = subprocess.run([sys.executable, SCRIPT, a, b], capture_output=True, text=True, check=False)
        return run.returncode, run.stdout


def same(**arguments):
    code, out = compared(**arguments)
    assert code == 0 and out.startswith("all equal: "), (code, out, arguments)


def differs(*words, **arguments):
    code, out = compared(**arguments)
    assert code == 1 and all(word in out for word in words), (code, out, words)


same()

# What is left out.
same(changes={"001-one/result.json": (b"2026-01-02T03:04:05Z", b"2027-01-02T03:04:05Z")})
same(changes={"001-one/result.json": (b'"total": 1.5', b'"total": 2.5')})
same(changes={"001-one/result.json": (b'"version": "0.1.0"', b'"version": "0.2.0"')})
same(changes={"001-one/stdout": (b"0.063 s", b"1.063 s")})
same(changes={"001-one/stdout": (b"/home/a/", b"/srv/")})
same(changes={"001-one/table.csv": (b"2026-01-02T", b"2027-11-12T")})
same(changes={"001-one/body.glb": (b'"now"', b'"old"')})
same(changes={"001-one/page.html": (b'"seconds":1.5', b'"seconds":9.5')})
same(changes={"002-two/data/stages.json": (b"a hash", b"b hash")})

# What is found: numbers, with the unit that they are measured in.
differs("001-one, result.json, /mass: ", "2 units", changes={"001-one/result.json": (b"9181", b"91812")})
differs("/coefficients/3/2: ", changes={"001-one/result.json": (b"1e-09", b"1.5e-09")})
code, out = compared(changes={"001-one/result.json": (b"1e-09", b"1.0001e-09")})
units = 1e-13 / 2**-53  # of the degree's largest, 0.5
assert code == 1 and f"largest difference of numbers {units:.3g} units" in out, out
code, out = compared(changes={"001-one/table.csv": (b"1e-9", b"1.0001e-9")})
assert code == 1 and f"largest difference of numbers {units:.3g} units" in out, out
differs("line 3, number 1: 1.25 | 1.26", changes={"001-one/stdout": (b"1.25", b"1.26")})
differs("line 1, count 1: 12 | 13", changes={"001-one/stdout": (b"12 triangles", b"13 triangles")})
differs("/counts/0: 3 | 5", changes={"001-one/result.json": (b"[3, 4]", b"[5, 4]")})

# Words, keys, files, exit codes, bytes.
differs("volume", "area", changes={"001-one/stdout": (b"volume", b"area  ")})
differs("/mass: ", "/mess: ", changes={"001-one/result.json": (b'"mass"', b'"mess"')})
differs("/timings: ", changes={"001-one/result.json": (b'"timings"', b'"timing"')})
differs("order of members", changes={"001-one/page.html": (b'"order":4,"x":2.5', b'"x":2.5,"order":4')})
differs("002-two, exit_code", "3 | 2", changes={"002-two/exit_code": (b"3", b"2")})
differs("001-one, stderr: only in ", missing=["001-one/stderr"])
differs("001-one, body.glb, 1 bytes, first at ", changes={"001-one/body.glb": (b"x\x9c", b"x\x9d")})
differs("001-one, body.glb, /x: 1.5 | 2.5", changes={"001-one/body.glb": (b"1.5", b"2.5")})
differs("page.html, data 1 /x: 2.5 | 3.5", changes={"001-one/page.html": (b'"x":2.5', b'"x":3.5')})
differs("line 2", changes={"001-one/page.html": (b"<p>page", b"<p>Page")})
differs("lines: 4 | 5", "(nothing) | a line more", changes={"001-one/stdout": (b"1.25\n", b"1.25\na line more\n")})

with tempfile.TemporaryDirectory() as empty:
    for arguments, code in (([], 2), ([empty], 2), ([empty, empty], 3)):
        assert subprocess.run([sys.executable, SCRIPT, *arguments], capture_output=True, check=False).returncode == code
