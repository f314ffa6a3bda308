#!/usr/bin/env python3
"""Checks what `--json` prints against the schemas. Arguments: the program, the folder of schemas."""
import json
import os
import subprocess
import sys
import tempfile

try:
    import jsonschema
except ImportError:
    print("SKIPPED: python3-jsonschema is not installed")
    sys.exit(77)

program, folder_of_schemas = sys.argv[1:]


def load_schema(name):
    with open(os.path.join(folder_of_schemas, f"cowgpu.{name}.v1.json"), encoding="utf-8") as schema_file:
        loaded = json.load(schema_file)
    jsonschema.Draft7Validator.check_schema(loaded)
    return loaded


def output_of(*arguments):
    run = subprocess.run([program, *arguments], capture_output=True, text=True, check=True)
    return json.loads(run.stdout)


def expand(*arguments):
    return output_of("expand", *arguments)


def refuses(schema, document, why):
    """A broken document must not pass, or the checks say nothing."""
    try:
        jsonschema.validate(document, schema)
    except jsonschema.ValidationError:
        return
    sys.exit(f"the schema accepts {why}")


schema = load_schema("result")


for arguments in (
    ["--lmax", "0", "--device", "cpu"],
    ["builtin:box:1,2,3", "--lmax", "7"],
    ["builtin:sphere@2", "--lmax", "40", "--origin", "mesh", "--density", "2.5", "--verify", "full"],
    ["builtin:tetrahedron", "--lmax", "3", "--origin", "1,-2,3", "--verify", "none"],
    ["builtin:box:3,2,2", "--lmax", "5", "--device", "cpu", "--length-unit", "cm", "--density", "2g/cm3", "--part", "builtin:box:1,1,1=-500kg/m3"],
    ["builtin:box", "--lmax", "2", "--device", "cpu", "--origin", "mesh", "--part", "builtin:box=-1"],
):
    result = expand(*arguments, "--json")
    jsonschema.validate(result, schema)
    assert result["accuracy"]["passed"] is (None if "none" in arguments else True), "only what was checked has passed"
    mass = result["expansions"]["mass"]
    expected = [(l, m) for l in range(mass["lmax"] + 1) for m in range(l + 1)]
    assert [(row[0], row[1]) for row in mass["coefficients"]] == expected, "sorted by l, then m"
    q00 = mass["coefficients"][0][2]
    body = result["mesh"]
    weigh = [body["volume"] * mass["density"]] + [part["mass"] for part in body["parts"]]
    assert abs(body["mass"] - sum(weigh)) <= 1e-15 * sum(map(abs, weigh))
    assert abs(q00 - body["mass"] / (4 * 3.141592653589793) ** 0.5) < 1e-14 * max(map(abs, weigh)), "Q_00 is the mass over sqrt(4 pi)"

for of, want in (("all", ["mass", "harmonic", "stretch", "smooth", "flow"]), ("stretch,harmonic", ["harmonic", "stretch"])):
    both = expand("builtin:cow@1", "--of", of, "--lmax", "9", "--device", "cpu", "--aliasing", "--json", *(["--flow-grid", "64"] if of == "all" else []))
    jsonschema.validate(both, schema)
    assert list(both["expansions"]) == want
    for name in want[-2:]:
        surface = both["expansions"][name]
        assert [row[:2] for row in surface["coefficients"]] == [[l, m] for l in range(10) for m in range(l + 1)]
        assert surface["coefficients"][0][4:8] == [0, 0, 0, 0], "the means of the angles are removed"
        assert len(surface["truncation"]) == len(surface["aliasing"]) == 10 and surface["dphi"] == "signed" and surface["map"]["method"] == name
paper = expand("builtin:cow@1", "--of", "harmonic", "--recipe", "paper", "--lmax", "3", "--device", "cpu", "--json")
jsonschema.validate(paper, schema)
assert (paper["expansions"]["harmonic"]["recipe"], paper["expansions"]["harmonic"]["dphi"]) == ("paper", "absolute")
assert paper["accuracy"]["passed"] is None and paper["expansions"]["harmonic"]["origin"] == [0, 0, 0]
paper["expansions"]["harmonic"]["dphi"] = "wavy"
refuses(schema, paper, "an angle of no kind")

result["mesh"]["sha256"] = "milk"
refuses(schema, result, "a hash that is none")

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

roundtrip = load_schema("roundtrip")
for arguments in (["--lmax", "0"], ["--lmax", "12", "--fields", "3", "--grid", "dh", "--seed", "9", "--runs", "2"]):
    trip = output_of("transform", "roundtrip", "--device", "cpu", "--json", *arguments)
    jsonschema.validate(trip, roundtrip)
    assert trip["passed"] is True and trip["max_error"] <= trip["bound"]
    assert trip["rms_error"] <= trip["max_error"] * 10
assert (trip["lmax"], trip["fields"], trip["seed"], trip["runs"]) == (12, 3, 9, 2)
assert trip["grid"] == {"kind": "dh", "rings": 26, "ring_length": 52}
trip["max_error"] = "small"
refuses(roundtrip, trip, "an error in words")

transform, spectrum = load_schema("transform"), load_schema("spectrum")
with tempfile.TemporaryDirectory() as folder:
    moments, grid, back = (os.path.join(folder, name) for name in ("moments.csv", "grid.nc", "back.nc"))
    expand("builtin:box:1,2,3", "--lmax", "6", "--device", "cpu", "--json", "-o", moments)
    there = output_of("transform", "synthesise", moments, grid, "--grid", "cc", "--device", "cpu", "--json")
    here = output_of("transform", "analyse", grid, back, "--normalisation", "4pi", "--device", "cpu", "--json")
    for report in (there, here):
        jsonschema.validate(report, transform)
    assert (there["direction"], here["direction"]) == ("synthesis", "analysis")
    assert here["normalisation"] == "4pi" and here["grid"]["kind"] == "cc" and here["fields"] == ["mass"]
    first, second = (output_of("spectrum", path, "--json") for path in (moments, back))
    for report in (first, second):
        jsonschema.validate(report, spectrum)
        assert len(report["fields"][0]["power"]) == report["lmax"] + 1 == 7
    total = first["fields"][0]["total"]
    for a, b in zip(first["fields"][0]["power"], second["fields"][0]["power"]):
        assert abs(a - b) <= 1e-14 * total, "power survives the way over a grid and another convention"
    here["direction"] = "sideways"
    refuses(transform, here, "a direction that is none")
    first["fields"][0]["power"][0] = -1
    refuses(spectrum, first, "a negative power")

sphere_map = load_schema("map")
for arguments in (
    ["builtin:sphere@2"],
    ["builtin:sphere@2", "--converge", "--relabellings", "2"],
    ["builtin:cow@1", "--method", "harmonic", "--pole", "0,1,0", "--lmax", "8"],
    ["builtin:cow@1", "--recipe", "paper"],
    ["builtin:sphere@2", "--method", "smooth", "--lmax", "3"],
):
    judged = output_of("map", "--json", *arguments)
    jsonschema.validate(judged, sphere_map)
    quality = judged["quality"]
    assert quality["seen"] + quality["unseen"]["count"] == quality["triangles"] == judged["mesh"]["faces"]
    assert quality["flipped"]["count"] == len(quality["flipped"]["faces"])
    assert sum(part["triangles"] for part in quality["unseen"]["parts"]) == quality["unseen"]["count"]
judged["method"] = "guess"
refuses(sphere_map, judged, "a method that is none")

reconstruct = load_schema("reconstruct")
with tempfile.TemporaryDirectory() as folder:
    coefficients, mapped, table = (os.path.join(folder, name) for name in ("cow.json", "cow.ply", "cow.csv"))
    subprocess.run([program, "map", "builtin:cow@1", "-o", mapped], capture_output=True, check=True)
    over = ["builtin:cow@1", "--of", "mass,stretch", "--lmax", "9", "--device", "cpu"]
    direct = expand(*over, "--json", "-o", coefficients, "-o", table)
    read = expand(*over, "--map", mapped, "--json")
    jsonschema.validate(read, schema)
    assert read["expansions"]["stretch"]["map"]["method"] == "file"
    assert read["expansions"]["stretch"]["map"]["file"] == mapped
    assert read["expansions"]["stretch"]["coefficients"] == direct["expansions"]["stretch"]["coefficients"]
    with open(table, encoding="utf-8") as file:
        lines = [line.rstrip("\n").split(",") for line in file if not line.startswith("#")]
    assert lines[0][:6] == ["l", "m", "mass_re", "mass_im", "stretch_f_r_re", "stretch_f_r_im"]
    want = [m + s[2:] for m, s in zip(*(direct["expansions"][name]["coefficients"] for name in ("mass", "stretch")))]
    assert [[float(word) for word in line] for line in lines[1:]] == want, "the CSV holds what the JSON holds"
    for arguments in (
        ["builtin:cow@1", "--order", "0,3", "--lmax", "9", "--samples", "100"],
        [coefficients, "--order", "0..2", "--fields", "f"],
        [coefficients, "--mesh", "builtin:cow@1", "--samples", "100"],
    ):
        rebuilt = output_of("reconstruct", *arguments, "--device", "cpu", "--json")
        jsonschema.validate(rebuilt, reconstruct)
        known = "--fields" not in arguments
        assert all((row["distance"] is not None) == known for row in rebuilt["orders"])
        assert (rebuilt["mesh"] is not None) == known
        sphere = 4 / 3 * 3.141592653589793 * rebuilt["expansion"]["spherical_radius"] ** 3
        assert abs(rebuilt["orders"][0]["volume"] - sphere) < 1e-14 * sphere
    assert [row["order"] for row in rebuilt["orders"]] == list(range(9)), "0 to 8 unless told otherwise"
    rebuilt["orders"][0]["distance"] = "far"
    refuses(reconstruct, rebuilt, "a distance in words")
for arguments, meaning in (
    (["--time", "0.2", "--flow-grid", "64"], "level-set"),
    (["--sheets", "signed", "--refinements", "1"], "sheets"),
    (["--recipe", "paper", "--refinements", "1"], "paper"),
):
    flowed = expand("builtin:cow@1", "--of", "flow", "--lmax", "3", "--device", "cpu", "--json", *arguments)
    jsonschema.validate(flowed, schema)
    flow = flowed["expansions"]["flow"]["flow"]
    assert flow["meaning"] == meaning and ("converged" in flow) == (meaning == "paper")
    assert len(flow["sheets"]) == (0 if meaning == "level-set" else 2)
    assert len(flow["uncertainty"]) == (0 if meaning == "paper" else 4)
flow["meaning"] = "vague"
refuses(schema, flowed, "a flow that means nothing")
flowed = output_of("map", "--json", "builtin:cow@1", "--method", "flow", "--time", "0.1", "--lmax", "8")
jsonschema.validate(flowed, sphere_map)
assert flowed["flow"]["points"]["points"] == flowed["mesh"]["vertices"]
inflate = load_schema("inflate")
for arguments in (["--star"], ["--levels", "0.1,star", "--cells", "16"]):
    inflated = output_of("inflate", "builtin:cow@1", *arguments, "--device", "cpu", "--json")
    jsonschema.validate(inflated, inflate)
    assert inflated["star_shape"]["lower"] < inflated["star_shape"]["upper"]
assert [level["name"] for level in inflated["levels"]] == ["0.1", "star"]
inflated["levels"][0]["closed"] = False
refuses(inflate, inflated, "an open level set")

distance = load_schema("distance")
with tempfile.TemporaryDirectory() as folder:
    points = os.path.join(folder, "points.csv")
    with open(points, "w", encoding="utf-8") as file:
        file.write("x,y,z\n0,0,0\n3,0,0\n0.5,0.1,0\n")
    for arguments in ([points], [points, "--unsigned"], ["--grid", "5"]):
        report = output_of("distance", "builtin:box:1,1,1", *arguments, "--device", "cpu", "--json")
        jsonschema.validate(report, distance)
        assert ("grid" in report) is ("--grid" in arguments) and ("inside" in report) is report["signed"]
    assert report["points"] == 125 and report["inside"] == 27 and report["outside"] == 98
report["grid"]["counts"] = [1, 2]
refuses(distance, report, "a grid of two axes")
streamlines = load_schema("streamlines")
for arguments in (["--count", "7"], ["--plane", "1,1,0,0.1", "--spacing", "0.5"], ["--plane", "xy", "--vertices", "1"]):
    drawn = output_of("streamlines", "builtin:box:1,1,1", *arguments, "--device", "cpu", "--json")
    jsonschema.validate(drawn, streamlines)
    assert drawn["counts"]["lines"] == len(drawn["lines"]) and drawn["counts"]["slid"] == 0
    assert all(("loop" in line) is ("--vertices" not in arguments) for line in drawn["lines"])
assert len(drawn["lines"]) == 8
drawn["lines"][0]["path"][0] = [0, 1, 2]
refuses(streamlines, drawn, "a corner without a distance")
coefficients, difference = load_schema("coefficients"), load_schema("diff")
with tempfile.TemporaryDirectory() as folder:
    source, surface, same = (os.path.join(folder, name) for name in ("cow.csv", "cow.nc", "same.json"))
    expand("builtin:cow@1", "--lmax", "9", "--device", "cpu", "--json", "-o", source)
    expand("builtin:cow@1", "--of", "smooth", "--lmax", "9", "--device", "cpu", "--json", "-o", surface)
    for arguments in (
        [source],
        [source, "--kind", "potential", "--si", "--form", "real", "--rotate", "10,20,30"],
        [surface, "--normalisation", "unnormalised", "--phase", "none"],
    ):
        subprocess.run([program, "convert", arguments[0], same, *arguments[1:]], capture_output=True, check=True)
        with open(same, encoding="utf-8") as file:
            document = json.load(file)
        jsonschema.validate(document, coefficients)
        assert [row[:2] for row in document["coefficients"]] == [[l, m] for l in range(10) for m in range(l + 1)]
        assert all(len(row) == 2 + 2 * len(document["fields"]) for row in document["coefficients"])
        found = output_of("diff", same, arguments[0], "--json", *(["--tolerance", "1e-15"] if len(arguments) < 6 else []))
        jsonschema.validate(found, difference)
        assert found["passed"] is (True if len(arguments) < 6 else None) and len(found["fields"]) == len(document["fields"])
    document["phase"] = "full moon"
    refuses(coefficients, document, "a phase of no kind")
    found["fields"][0]["degrees"][0]["norm"] = -1
    refuses(difference, found, "a negative norm")
tensors, radiate = load_schema("tensors"), load_schema("radiate")
with tempfile.TemporaryDirectory() as folder:
    written, table, again = (os.path.join(folder, name) for name in ("cow.json", "cow.csv", "cow.nc"))
    expand("builtin:cow@1", "--lmax", "2", "--device", "cpu", "--json", "-o", written, "-o", table, "-o", again)
    for arguments in (["builtin:cow@1", "--length", "2m"], ["builtin:box:1,2,3", "--origin", "mesh"], [written], [table], [again]):
        found = output_of("tensors", *arguments, "--json")
        jsonschema.validate(found, tensors)
        assert found["input"]["kind"] == ("coefficients" if len(arguments) == 1 else "mesh")
        assert abs(sum(found["quadrupole"][i][i] for i in range(3))) < 1e-15 * sum(found["principal_moments"])
    for arguments in (
        ["builtin:cow@1"],
        ["builtin:cow@1", "--length", "2m", "--density", "1g/cm3", "--axis", "1,2,3", "--period", "1s", "--octupole"],
        ["builtin:sphere@2", "--length", "2m"],
        [written, "--length-unit", "1m", "--omega", "1Hz"],
    ):
        found = output_of("radiate", *arguments, "--json")
        jsonschema.validate(found, radiate)
        assert (found["power_W"] is None) is (len(arguments) == 1)
        assert ("octupole_power_W" in found) is ("--octupole" in arguments)
found["omega_after"] = "1e0"
refuses(radiate, found, "an exponent among all digits")
tip = load_schema("tip")
with tempfile.TemporaryDirectory() as folder:
    surface, push = os.path.join(folder, "cow.json"), os.path.join(folder, "push.csv")
    expand("builtin:cow@1", "--of", "smooth", "--lmax", "5", "--device", "cpu", "--json", "-o", surface)
    with open(push, "w", encoding="utf-8") as file:
        file.write("time,force\n0,0\n0.1,5000\n0.2,0\n")
    for arguments in (
        ["builtin:box:1,2,1"],
        ["builtin:box:1,2,1", "--length", "2m", "--density", "9", "--friction", "0.1", "--push", "1N:1s", "--punch", "1N"],
        ["builtin:cow@1", "--length", "2.5m", "--density", "1g/cm3", "--friction", "0.6", "--push", push, "--punch-duration", "20ms"],
        ["builtin:cow@1", "--length", "2.5m", "--order", "0..2,full", "--of", "smooth", "--as-modelled", "--contact-tolerance", "1cm"],
        [surface, "--order", "0,3", "--fields", "f"],
    ):
        found = output_of("tip", *arguments, "--device", "cpu", "--json")
        jsonschema.validate(found, tip)
        assert set(found) <= set(tip["properties"])
        assert all(set(entry) == set(tip["properties"]["orders"]["items"]["properties"]) for entry in found["orders"])
        assert found["orders"][-1]["order"] == "full" and found["orders"][-1]["force_N"] == found["force_N"]
        assert ("push_tips" in found) is ("--push" in arguments) and ("boundary" in found) is ("--length" in arguments)
    found["orders"][0]["side"] = "up"
    refuses(tip, found, "a side that is none")
tides, drop = load_schema("tides"), load_schema("drop")
with tempfile.TemporaryDirectory() as folder:
    written = os.path.join(folder, "cow.json")
    expand("builtin:cow@1", "--lmax", "4", "--device", "cpu", "--json", "-o", written)
    for arguments in (
        ["builtin:cow@1", "--length", "2m", "--orbit", "7000km", "--attitude", "z:45"],
        ["builtin:sphere@2", "--length", "2m", "--orbit", "7000km", "--spin", "1rad/s", "--love", "1", "--quality", "9"],
        [written, "--length-unit", "1m", "--orbit", "1au", "--mass", "sun"],
    ):
        found = output_of("tides", *arguments, "--json")
        jsonschema.validate(found, tides)
        assert found["librates"] is ("sphere" not in arguments[0]) and ("shifts" in found) is found["librates"]
        assert ("locking_time_s" in found) is ("--love" in arguments)
    for arguments in ([], ["--attitude", "on-side", "--spin", "y,1rad/s"], ["--attitude", "1,2,3", "--feet", "x"]):
        found = output_of("drop", "builtin:cow@1", "--length", "2m", "--height", "5m", *arguments, "--json")
        jsonschema.validate(found, drop)
        assert (found["turn_first_order_rad"] is None) is ("--spin" in arguments)
found["energy_drift"] = 1
refuses(drop, found, "energy from nowhere")
errata, found = load_schema("errata"), output_of("errata", "--json")
jsonschema.validate(found, errata)
found["errata"][0]["why"] = ""
refuses(errata, found, "an erratum without a reason")
potential = load_schema("potential")
for arguments in (
    ["builtin:cow@1", "--at", "3,0,0"],
    ["builtin:cow@1", "--sphere", "2R", "--resolution", "4", "--length", "2m", "--density", "1uC/m3", "--charge"],
    ["builtin:box", "--plane", "z,0.1,2,9", "--inside", "exact", "--derivatives", "1"],
    ["builtin:cow@1", "--recipe", "paper", "--at", "3,0,0", "--derivatives", "0"],
    ["builtin:box:1,2,3", "--errors", "--orders", "0,4", "--distances", "1,3"],
):
    found = output_of("potential", *arguments, "--device", "cpu", "--json")
    jsonschema.validate(found, potential)
    for table in ("points", "errors", "good_from"):
        assert all(len(row) == len(found[table]["columns"]) for row in found.get(table, {"rows": []})["rows"])
found["law"] = "levity"
refuses(potential, found, "a law of no kind")
surface = load_schema("surface")
with tempfile.TemporaryDirectory() as folder:
    points = os.path.join(folder, "points.csv")
    with open(points, "w", encoding="utf-8") as file:
        file.write("x,y,z\n0,0,0\n30,0,0\n0.5,0.1,0\n")
    for arguments in (
        ["builtin:cow@0"],
        ["builtin:cow@0", "--length", "2m", "--density", "1g/cm3", "--period", "1h", "--at", "vertices", "--height", "1cm"],
        ["builtin:cow@0", "--at", points, "--tolerance", "0"],
        ["builtin:box:1,2,3", "--omega", "0.5", "--spin", "0,1,1", "--guarantee"],
        ["builtin:box", "--length-unit", "km", "--mass", "1e12kg"],
    ):
        found = output_of("surface", *arguments, "--device", "cpu", "--json")
        jsonschema.validate(found, surface)
        assert set(found) <= set(surface["properties"])
        assert ("spin_rate" in found) is ("--period" in arguments or "--omega" in arguments)
        assert ("slopes" in found) is (points not in arguments)
        for table in ("ranges", "slopes"):
            assert all(len(row) == len(found[table]["columns"]) for row in found.get(table, {"rows": []})["rows"])
found["radius"] = -1
refuses(surface, found, "a negative radius")
equilibria = load_schema("equilibria")
with tempfile.TemporaryDirectory() as folder:
    for arguments in (
        ["builtin:box:3,2,1", "--omega", "0.8"],
        ["builtin:ellipsoid:3,2,1@1", "--length-unit", "km", "--mass", "5e12kg", "--period", "9h"],
        ["builtin:sphere:1@0", "--omega", "0.8", "--spin", "z", "--smallest", "0.05", "--cells", "20000"],
        ["builtin:box:3,2,1", "--omega", "0.8", "--surface", "E2", "--surface-cells", "8", "-o", os.path.join(folder, "z.glb")],
    ):
        found = output_of("equilibria", *arguments, "--device", "cpu", "--json")
        jsonschema.validate(found, equilibria)
        assert set(found) <= set(equilibria["properties"])
        assert ("surface_jacobi" in found) is ("--surface" in arguments)
        for table in ("equilibria", "undecided"):
            assert all(len(row) == len(found[table]["columns"]) for row in found.get(table, {"rows": []})["rows"])
found["complete"] = "mostly"
refuses(equilibria, found, "a search that is mostly complete")
jsonschema.validate(output_of("meshes", "--json"), load_schema("meshes"))
reproduce = load_schema("reproduce")
with tempfile.TemporaryDirectory() as folder:
    subprocess.run([program, "reproduce", "-o", folder, "--mesh", "builtin:box", "--only", "mass,tensors"], capture_output=True, check=True)
    with open(os.path.join(folder, "reproduce.json"), encoding="utf-8") as file:
        found = json.load(file)
    jsonschema.validate(found, reproduce)
    assert sum(found["counts"].values()) == len(found["rows"])
    found["rows"][0]["verdict"] = "probably"
    refuses(reproduce, found, "a verdict of no kind")
inspect = load_schema("inspect")
with tempfile.TemporaryDirectory() as folder:
    path, mended = os.path.join(folder, "open.off"), os.path.join(folder, "mended.ply")
    with open(path, "w", encoding="utf-8") as file:  # a tetrahedron with one vertex doubled and one face turned
        file.write("OFF\n5 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 4\n3 0 2 4\n")
    as_found = output_of("inspect", path, "--json")
    repaired = output_of("inspect", path, "--weld", "0", "--orient", "--largest-shell", "-o", mended, "--json")
    again = output_of("inspect", mended, "--json")
    whole = output_of("inspect", "builtin:cow@1", "--json")
    for report in (as_found, repaired, again, whole):
        jsonschema.validate(report, inspect)
    assert as_found["moments"].startswith("no [mesh-open]") and "volume" not in as_found
    assert repaired["moments"] == again["maps"] == "yes" and len(repaired["notes"]) == 3
    assert repaired["volume"] == again["volume"] and repaired["output"] == mended
    assert whole["overlapped"]["volume"] == 0 and whole["inscribed_radius"] <= whole["largest_ball"]["bound"]
    assert whole["inscribed_radius"] < whole["brillouin_radius"]
    whole["self_intersections"]["listed"] = [{"faces": [1], "kind": "crossing", "place": [0, 0, 0]}]
    refuses(inspect, whole, "a pair of one face")
print("all documents passed")

values = load_schema("values")
with tempfile.TemporaryDirectory() as folder:
    table = os.path.join(folder, "ball.csv")
    for at in ("faces", "vertices"):
        output_of("surface", "builtin:sphere@1", "--at", at, "--device", "cpu", "-q", "--json", "-o", table)
        with open(table + ".json", encoding="utf-8") as about_file:
            about = json.load(about_file)
        jsonschema.validate(about, values)
        with open(table, encoding="utf-8") as table_file:
            rows = table_file.read().splitlines()
        assert rows[0].startswith("id,x,y,z,potential,g_x,g_y,g_z,g,") and len(rows) == about["rows"] + 1
        assert rows[0].split(",") == [column["name"] for column in about["columns"]]
about["place"] = "edges"
refuses(values, about, "values at places of no kind")
