#!/usr/bin/env python3
"""Checks what `cowgpu expand --json` prints against the schema. Arguments: the program, the schema."""
import json
import os
import subprocess
import sys
import tempfile

try:
    import jsonschema
except ImportError:
    print("SKIPPED: python3-jsonschema is not installed")
    sys.exit(0)

program, schema_path = sys.argv[1:]
with open(schema_path, encoding="utf-8") as file:
    schema = json.load(file)
jsonschema.Draft7Validator.check_schema(schema)


def expand(*arguments):
    run = subprocess.run([program, "expand", *arguments], capture_output=True, text=True, check=True)
    return json.loads(run.stdout)


for arguments in (
    ["--lmax", "0", "--device", "cpu"],
    ["builtin:box:1,2,3", "--lmax", "7"],
    ["builtin:sphere@2", "--lmax", "40", "--origin", "mesh", "--density", "2.5", "--verify", "full"],
    ["builtin:tetrahedron", "--lmax", "3", "--origin", "1,-2,3", "--verify", "none"],
):
    result = expand(*arguments, "--json")
    jsonschema.validate(result, schema)
    assert result["accuracy"]["passed"] is (None if "none" in arguments else True), "only what was checked has passed"
    mass = result["expansions"]["mass"]
    expected = [(l, m) for l in range(mass["lmax"] + 1) for m in range(l + 1)]
    assert [(row[0], row[1]) for row in mass["coefficients"]] == expected, "sorted by l, then m"
    q00 = mass["coefficients"][0][2]
    want = result["mesh"]["volume"] * mass["density"] / (4 * 3.141592653589793) ** 0.5
    assert abs(q00 - want) < 1e-14 * abs(want), "Q_00 is the mass over sqrt(4 pi)"

# A broken document must not pass, or the check above says nothing.
result["mesh"]["sha256"] = "milk"
try:
    jsonschema.validate(result, schema)
    sys.exit("the schema accepts a hash that is none")
except jsonschema.ValidationError:
    pass

with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "cow.json")
    table = os.path.join(folder, "cow.csv")
    printed = expand("builtin:cow@1", "--lmax", "30", "--device", "cpu", "--json", "-o", path, "-o", table)
    with open(path, encoding="utf-8") as file:
        written = json.load(file)
    jsonschema.validate(written, schema)
    rows = written["expansions"]["mass"]["coefficients"]
    assert rows == printed["expansions"]["mass"]["coefficients"], "file and standard output agree to the last bit"
    with open(table, encoding="utf-8") as file:
        lines = [line.rstrip("\n") for line in file if not line.startswith("#")]
    assert lines[0] == "l,m,re,im"
    assert [[int(a), int(b), float(c), float(d)] for a, b, c, d in (line.split(",") for line in lines[1:])] == rows
print("4 documents and 2 files passed")
