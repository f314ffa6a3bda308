#!/usr/bin/env python3
"""pages_self_check.py SCRIPT: tests/pages_check.py finds samples that are wrong, and lets pass what may differ."""

import contextlib
import importlib.util
import io
import os
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
specification = importlib.util.spec_from_file_location("pages_check", sys.argv[1])
pages_check = importlib.util.module_from_spec(specification)
specification.loader.exec_module(pages_check)

# What the program under test prints. It knows one mesh, which is not on this machine.
PROGRAM = r"""#!/bin/sh
case "$*" in
  meshes\ --json) echo '{"named": [{"name": "benchmark", "path": null}]}' ;;
  man) printf '.B \\-\\-lmax, \\-\\-other\n' ;;
  expand\ --help) echo '  --lmax INT' ;;
  fail) echo "cowgpu: error" >&2; exit 3 ;;
  write) echo kept > file ;;
  *) cat <<'END'
cowgpu: wrote m.json
computed: moments, in 1.187 s (26396 pairs)
device: Vulkan 1.3 on a device
time: load 0.019 s, in all 1.292 s

  mass                       0.06659036229964
  force                      1450.53 N
  power                      6.76395298e-48 W
  angle                      78 degrees
    0   0  +1.878479e-02                         3   1  +1.177140e-04 + 2.617709e-05 i
    1   1  -9.194025e-20 + 4.941788e-19 i        3   3  -1.217691e-04 - 1.708861e-04 i
  +0.5825+0.0000i  -0.0000+0.1234i
last line
END
  ;;
esac
"""

PAGE = """# A page

[itself](page.md), [a heading](page.md#a-page), `cowgpu expand --lmax 8`

```console
$ ./cowgpu expand
cowgpu: wrote m.json
computed: moments, in 1.187 s (26396 pairs)
device: Vulkan 1.3 on a device
time: load 0.019 s, in all 1.292 s

  mass                       0.06659036229964
  force                      1450.53 N
  power                      6.76395298e-48 W
  angle                      78 degrees
    0   0  +1.878479e-02                         3   1  +1.177140e-04 + 2.617709e-05 i
    1   1  -9.194025e-20 + 4.941788e-19 i        3   3  -1.217691e-04 - 1.708861e-04 i
  +0.5825+0.0000i  -0.0000+0.1234i
last line
$ cowgpu expand \\
  --lmax 8
cowgpu: wrote m.json
...
  force                      1450.53 N
...
last line
```

Between the blocks.

```console
$ ./cowgpu write
$ cat file
kept
$ ./cowgpu fail
cowgpu: error
$ echo $?
3
```
"""


def checked(page, *options):
    """Exit code, what is printed, and the page afterwards."""
    with tempfile.TemporaryDirectory() as folder:
        program, file = Path(folder) / "program", Path(folder) / "page.md"
        program.write_text(PROGRAM)
        os.chmod(program, 0o755)
        file.write_text(page)
        out = io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
            code = pages_check.main(["--program", str(program), *options, str(file)])
        return code, out.getvalue(), file.read_text()


def changed(old, new):
    assert PAGE.count(old) >= 1, old
    return PAGE.replace(old, new, 1)


def passes(page):
    code, out, _ = checked(page)
    assert code == 0 and not out, (code, out)


def fails(page, *words):
    code, out, _ = checked(page)
    assert code == 1 and all(word in out for word in words), (code, out, words)
    return out


passes(PAGE)

# What may differ: times, devices, the last digit, what is nothing but rounding.
passes(changed("1.187 s", "12.5 s"))
passes(changed("Vulkan 1.3 on a device", "CPU path"))
passes(changed("in all 1.292 s", "in all 9 s"))
passes(changed("0.06659036229964", "0.06659036229965"))
passes(changed("0.06659036229964", "0.0665903622996"))
passes(changed("-9.194025e-20 + 4.941788e-19 i", "+0.000000e+00 - 1.5e-21 i     "))
passes(changed("+0.5825+0.0000i  -0.0000", "+0.5825-0.0000i  +0.0001"))

# What may not: words, counts, digits, signs, units, blanks, lines too many or too few, exit codes.
out = fails(changed("0.06659036229964", "0.06659036229984"), "page.md, line 12, `./cowgpu expand`")
assert "expected:   mass                       0.06659036229984" in out, out
assert "got:        mass                       0.06659036229964" in out, out
fails(changed("1450.53 N", "1450.55 N"), "line 13")
fails(changed("1450.53 N", "1450.53 kN"), "line 13")
fails(changed("6.76395298e-48", "6.76395298e-47"), "line 14")
fails(changed("78 degrees", "79 degrees"), "line 15")
fails(changed("26396 pairs", "26395 pairs"), "line 8")
fails(changed("- 1.708861e-04 i", "+ 1.708861e-04 i"), "line 17")
fails(changed("+0.5825+0.0000i", "+0.5825+0.0003i"), "line 18")
fails(changed("  angle      ", "  angle "), "line 15")
fails(changed("computed: moments", "computed: mass"), "line 8")
fails(changed("last line\n$", "$"), "(no more lines)", "got:      last line")
fails(changed("last line\n$", "last line\none more\n$"), "expected: one more", "(no more lines)")
fails(changed("  force                      1450.53 N\n...", "  farce                      1450.53 N\n..."), "expected:   farce")
fails(changed("...\nlast line", "...\nlost line"), "expected: lost line", "got:      last line")
fails(changed("$ echo $?\n3\n", ""), "`./cowgpu fail` ends with exit code 3, and no `$ echo $?` follows")
fails(changed("$ echo $?\n3\n", "$ echo $?\n2\n"), "expected: 2", "got:      3")
fails(changed("$ cowgpu expand \\\n", "no command\n$ cowgpu expand \\\n"), "expected: no command")
fails(changed("```console\n$ ./cowgpu write", "```console\n./cowgpu write"), "a block ```console begins with a command")

# A mesh that is not here: its block is left out, the others are held to what is printed.
absent = PAGE + "\n```console\n$ ./cowgpu expand benchmark\nwhatever\n```\n"
code, out, _ = checked(absent)
assert code == 77 and out.startswith("SKIPPED: ") and "the mesh benchmark is not here" in out, (code, out)
fails(absent.replace("78 degrees", "79 degrees", 1), "SKIPPED: ", "line 15")

# --update writes what is printed, where it differs, and keeps `...`.
wrong = PAGE.replace("1450.53 N", "1.5 N").replace("78 degrees", "77 degrees")
code, out, page = checked(wrong, "--update")
assert (code, page) == (0, PAGE) and "2 samples written anew" in out, (code, out, page)
code, out, page = checked(PAGE.replace("1.187 s", "12.5 s"), "--update")
assert (code, out, page) == (0, "", PAGE.replace("1.187 s", "12.5 s")), (code, out, page)

# --links: links, headings, options.
for page in (PAGE, changed("`cowgpu expand --lmax 8`", "`--other`")):
    code, out, _ = checked(page, "--links")
    assert code == 0 and not out, (code, out)
for old, new, word in (("(page.md)", "(pages.md)", "the link pages.md leads to nothing"),
                       ("#a-page", "#no-page", "has no heading #no-page"),
                       ("`cowgpu expand --lmax 8`", "`cowgpu expand --lmux 8`", "no option --lmux"),
                       ("`cowgpu expand --lmax 8`", "`cowgpu expand --other`", "no option --other"),
                       ("`cowgpu expand --lmax 8`", "`--lmux`", "no option --lmux")):
    code, out, _ = checked(changed(old, new), "--links")
    assert code == 1 and word in out, (code, out, word)
