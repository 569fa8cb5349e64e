"""Writes docs/reference.md from what the program lists, and checks that the committed page is what it lists now.

    python3 tests/repository/reference.py build/lostbits            # writes docs/reference.md
    python3 tests/repository/reference.py build/lostbits --check    # ends with 1 if the page differs, and says where
"""
import difflib
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import textwrap

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "reference.md"
SHAPES = ("sphere", "box", "triangle", "ellipsoid", "cylinder", "capsule", "tube", "cone", "disc", "plane", "torus")
COMMANDS = ("map", "render", "sweep", "explain", "judge", "choose", "trade", "mend", "offsets", "consistency", "check",
            "report", "diff", "merge", "plugin", "devices", "list")
# Small runs whose datapackage.json describes the columns of each kind of table.
RUNS = (("map", "map near-benign --size 4x4 -i sphere.press -f f32 --pixels csv --metric culprit"),
        ("sweep", "sweep sphere-distance --steps 3 --set views=4 -i sphere.press -f f32"),
        ("sweep of cases", "sweep extremes/contact -i sphere.press -f f32"),
        ("render", "render raycast-course.small --size 4x4 -i sphere.unified -f f32"),
        ("offsets", "offsets offset-tiny --size 4x3 -i sphere.half_b -f f32"),
        ("consistency", "consistency near-benign --size 4x3 -i sphere.half_b -f f32"),
        ("choose", "choose near-benign --bits 4 --size 8x8 -i sphere.unified -f f32 --quick"))


def run(program, *arguments):
    return subprocess.run([program, "--progress", "none", *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          check=True, text=True, encoding="utf-8", cwd=ROOT).stdout


def table(columns, rows):
    """A table of Markdown, with the first cell of each row as code."""
    def cell(text):
        return str(text).replace("|", "\\|").replace("*", "\\*").replace("<", "\\<")
    lines = ["| " + " | ".join(columns) + " |", "|---" * len(columns) + "|"]
    return lines + ["| " + " | ".join([f"`{row[0]}`", *map(cell, row[1:])]) + " |" for row in rows]


def listed(program, what, columns):
    return table(columns, [[row[column] for column in columns] for row in json.loads(run(program, "list", what, "--json"))])


def forms(program):
    columns = ("name", "title", "direction", "roots", "touching", "at_origin", "inside", "facing", "next_crossing",
               "formats", "source")
    rows = [[row[column] for column in columns] for row in json.loads(run(program, "list", "forms", "--json"))]
    lines = []
    for shape in dict.fromkeys(row[0].split(".")[0] for row in rows):
        lines += ["", f"### `{shape}.*`", "", *table(columns, [row for row in rows if row[0].split(".")[0] == shape])]
    return lines


def members():
    """The members of each primitive, as a form finds them, from the first lines of its struct."""
    rows = []
    for shape in SHAPES:
        text = (ROOT / "src/shapes" / shape / f"{shape}.hpp").read_text(encoding="utf-8")
        body = text[re.search(r"^struct \w+ \{\n", text, re.M).end():]
        found = []
        for line in body.splitlines():
            match = re.fullmatch(r"    (Vec<T>|T) ([\w, ]+);(?: *///< .*)?", line)
            if match:
                found += [f"{match[1]} {name}" for name in match[2].split(", ")]
            elif found and line.strip():
                break
        if not found:
            raise SystemExit(f"{shape}.hpp: its members are not where this script looks for them")
        rows.append([shape, ", ".join(f"`{member}`" for member in found)])
    return ["| primitive | members |", "|---|---|", *(f"| `{name}` | {cell} |" for name, cell in rows)]


def tables_of_runs(program):
    lines, seen = [], {}
    for title, command in RUNS:
        with tempfile.TemporaryDirectory() as folder:
            run(program, "-j", "1", *command.split(), "-o", folder)
            package = next(pathlib.Path(folder).rglob("datapackage.json"))
            resources = json.loads(package.read_text(encoding="utf-8"))["resources"]
        for resource in resources:
            name = pathlib.PurePath(resource["path"]).name
            rows = [[field["name"], field["type"], field.get("unit", ""), field.get("description", "")]
                    for field in resource["schema"]["fields"]]
            if seen.get(name) == rows:
                continue
            seen[name] = rows
            lines += ["", f"### `{title.split()[0]}`: `{name}`", "", textwrap.fill(resource.get("title", "") + ".", 120), "",
                      *table(("column", "type", "unit", "meaning"), rows)]
    return lines


def options(program, command):
    text = run(program, command, "--help")
    return text[text.index("Usage:"):text.index("\nOptions of every command:")].rstrip("\n").splitlines()


def page(program):
    lines = ["# Reference", "",
             "This page is generated: `python3 tests/repository/reference.py build/lostbits` writes it again, and a test checks",
             "that it is current. Keys of scenes, sweeps and claims are in [data/README.md](../data/README.md); options of every",
             "command and the exit status are in [install.md](install.md#options-of-every-command).", "", "Contents: "
             + ", ".join(f"[{name}](#{name.lower().replace(' ', '-')})" for name in
                         ("Forms", "Members of primitives", "Formats", "Metrics", "Transform methods", "Ray generators",
                          "Bounding boxes", "Offset strategies", "Consistency checks", "Columns of tables", "Commands"))
             + ".", "", "## Forms", "",
             "[The contract of a form](your-own-intersector.md#the-contract-of-a-form) explains the columns from `direction` to",
             "`next_crossing`.", *forms(program)]
    lines += ["", "## Members of primitives", "",
              "A form reads these members. `T` is its number type; `Vec<T>` has `x`, `y` and `z`.", "", *members()]
    for title, what, columns in (
            ("Formats", "formats", ("name", "meaning")),
            ("Metrics", "metrics", ("name", "unit", "layer", "default", "meaning")),
            ("Transform methods", "transforms", ("name", "title", "direction", "source")),
            ("Ray generators", "generators", ("name", "title", "begins", "source")),
            ("Bounding boxes", "boxes", ("name", "title", "source")),
            ("Offset strategies", "strategies", ("name", "title", "source")),
            ("Consistency checks", "checks", ("name", "title", "first", "second"))):
        lines += ["", f"## {title}", "", *listed(program, what, columns)]
    lines += ["", "## Columns of tables", "", "A `datapackage.json` beside each table of results describes its columns. The"
              " following tables are the usual ones.", *tables_of_runs(program)]
    lines += ["", "## Commands"]
    for command in COMMANDS:
        lines += ["", f"### `lostbits {command}`", "", "```text", *options(program, command), "```"]
    return "\n".join(lines) + "\n"


def main():
    now = page(str(pathlib.Path(sys.argv[1]).resolve()))
    if "--check" not in sys.argv[2:]:
        PAGE.write_text(now, encoding="utf-8")
        return 0
    kept = PAGE.read_text(encoding="utf-8")
    difference = list(difflib.unified_diff(kept.splitlines(), now.splitlines(), "docs/reference.md", "now", lineterm="", n=0))
    print("\n".join(difference[:40]))
    return 1 if difference else 0


if __name__ == "__main__":
    sys.exit(main())
