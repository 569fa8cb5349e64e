"""Writes docs/paper/numbers.tex, the numbers of the paper as macros, from numbers.toml, and checks that it is current.

    python3 docs/paper/macros.py                               # writes numbers.tex
    python3 docs/paper/macros.py --check                       # ends with 1 if numbers.tex differs
    python3 docs/paper/macros.py --measure build/lostbits      # runs the commands of numbers.toml, ends with 1 if a
                                                                # recorded value differs from the measured one

The entries of numbers.toml say what they are. A claim is measured again by `lostbits check --filter ID`, and a report
by the test of reports/specimens, where the library is installed.
"""
import argparse
import csv
import decimal
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
TARGET = HERE / "numbers.tex"
KINDS = ("claim", "count", "file", "command")
DESCRIPTIONS = {"claim": "Claims, by {lostbits check --filter ID}",
                "count": "Rows of {reports/claims.csv}",
                "file": "Recorded in a file of the tree",
                "command": "Columns of tables that a command writes"}


class Wrong(Exception):
    """A number that has no source, or one that its source does not give."""


class Sources:
    """The claims that were measured, and the expectations of those that need a library."""

    def __init__(self, root=ROOT):
        self.root = root
        with open(root / "reports/claims.csv", newline="") as file:
            self.rows = list(csv.DictReader(file))
        self.measured = {row["id"]: row for row in self.rows}
        self.expected = {}
        for path in sorted((root / "data/claims").glob("*.toml")):
            for claim in tomllib.loads(path.read_text()).get("claim", []):
                self.expected[claim["id"]] = claim

    def claim(self, entry):
        """The measured value of a claim. A claim about a library is not in reports/claims.csv: its value is known as
        an interval, both ends of which must print alike."""
        name = entry["claim"]
        if row := self.measured.get(name):
            if row["state"] != "agrees" or row["evidence"] != entry.get("evidence", row["evidence"]):
                raise Wrong(f"the claim {name} {row['state']}, and rests on {row['evidence'] or 'a measurement'}")
            return [row[entry.get("column", "measured")]]
        if name not in self.expected:
            raise Wrong(f"{name} is not the id of a claim")
        return self.expected[name]["expect"]["in"]

    def count(self, entry):
        """The number of claims in reports/claims.csv with these values in these columns."""
        return [sum(all(row[k] == v for k, v in entry["count"].items()) for row in self.rows)]

    def file(self, entry):
        """What the group of a pattern matches in a file, which must be the same wherever it matches."""
        found = set(re.findall(entry["pattern"], (self.root / entry["file"]).read_text(), re.M))
        if len(found) != 1:
            raise Wrong(f"{entry['file']} has {len(found)} different matches of {entry['pattern']}")
        return list(found)

    def command(self, entry):
        """The value that was recorded when the command ran; --measure compares."""
        return [entry["value"]]


def grouped(digits):
    """65536 as 65\\,536; numbers of four digits stay as they are."""
    return re.sub(r"(?<=\d)(?=(\d{3})+$)", r"\\,", digits) if len(digits) > 4 else digits


def printed(value, entry):
    """A value as LaTeX: times `scale`, to `digits` significant digits; whole numbers are exact without `digits`. Powers
    of ten and products with them are for mathematics, versions such as 10.0.1 and hexadecimal floats are text."""
    text = str(value).replace(",", "")
    if m := re.fullmatch(r"(?:(\d+(?:\.\d+)?)e|10\^)(\d+)", text):
        return (f"{m[1]}\\cdot " if m[1] else "") + f"10^{{{m[2]}}}"
    if not re.fullmatch(r"-?\d+(\.\d+)?(e-?\d+)?", text):
        return text
    number = decimal.Decimal(text) * decimal.Decimal(str(entry.get("scale", 1)))
    if digits := entry.get("digits"):
        number = decimal.Context(prec=digits, rounding=decimal.ROUND_HALF_EVEN).plus(number)
        text = f"{number:f}"
        missing = digits - len(text.replace(".", "").lstrip("-0"))
        return text if missing <= 0 or "." not in text else text + "0" * missing
    if number != number.to_integral_value():
        raise Wrong(f"{value} is not a whole number, and the entry has no digits")
    sign, body = ("-", -number) if number < 0 else ("", number)
    return sign + grouped(f"{body:.0f}")


def text_of(name, entry, sources):
    kinds = [kind for kind in KINDS if kind in entry]
    if len(kinds) != 1:
        raise Wrong(f"{name} must have one of {', '.join(KINDS)}")
    try:
        found = {printed(value, entry) for value in getattr(sources, kinds[0])(entry)}
    except (KeyError, FileNotFoundError) as error:
        raise Wrong(f"{name}: {error} is missing")
    except Wrong as error:
        raise Wrong(f"{name}: {error}")
    if len(found) != 1:
        raise Wrong(f"{name}: the interval prints as {' and '.join(sorted(found))}; give fewer digits")
    return found.pop()


def source_of(entry, commands):
    """The kind of a source, and its name in the list of the paper."""
    kind = next(k for k in KINDS if k in entry)
    if kind == "count":
        return kind, ", ".join(f"{k} = {v or '-'}" for k, v in entry["count"].items()) or "all"
    return kind, commands[entry[kind]]["run"] if kind == "command" else entry[kind]


def typewriter(text):
    """Text as \\texttt, with its special characters escaped, that breaks after punctuation."""
    escaped = re.sub(r"[\\{}$&#%_^~]", lambda m: f"\\{m[0]}" if m[0] in "{}$&#%_" else f"\\char`\\{m[0]}{{}}", text)
    return "\\texttt{" + re.sub(r"([./:,-])(?=\S)", r"\1\\allowbreak ", escaped) + "}"


def listing(texts, entries, commands):
    """The list of all numbers with their sources, one paragraph a kind; numbers of one source stand together."""
    paragraphs = []
    for kind in KINDS:
        by_source = {}
        for name, entry in entries.items():
            of, source = source_of(entry, commands)
            if of == kind:
                by_source.setdefault(source, []).append(texts[name])
        items = [typewriter(source) + ": " + ", ".join(f"\\ensuremath{{{value}}}" for value in values)
                 for source, values in by_source.items()]
        title = re.sub(r"\{(.*?)\}", lambda m: typewriter(m[1]), DESCRIPTIONS[kind])
        paragraphs.append(f"\\par\\noindent\\textbf{{{title}.}}\n" + ";\n".join(items) + ".")
    return "\n".join(paragraphs)


def document(numbers, sources):
    """numbers.tex, from what numbers.toml holds."""
    entries, commands = numbers["number"], numbers["command"]
    texts = {name: text_of(name, entry, sources) for name, entry in entries.items()}
    for name, entry in entries.items():
        if entry.get("command", next(iter(commands))) not in commands:
            raise Wrong(f"{name}: {entry['command']} is not one of the commands of numbers.toml")
    macros = "".join(f"\\newcommand{{\\N{name}}}{{{text}}}\n" for name, text in texts.items())
    return ("% Written by docs/paper/macros.py from numbers.toml. Do not edit.\n" + macros
            + "\\newcommand{\\NumberSources}{%\n" + listing(texts, entries, commands) + "}\n")


def differences(program, numbers):
    """Recorded values that differ from what their commands measure now."""
    found = []
    for key, command in numbers["command"].items():
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([program, *shlex.split(command["run"]), "-o", folder], check=True, cwd=ROOT,
                           stdout=subprocess.DEVNULL)
            with open(pathlib.Path(folder) / command["table"], newline="") as file:
                rows = {row["form"]: row for row in csv.DictReader(file)}
        for name, entry in numbers["number"].items():
            if entry.get("command") == key and (now := rows[entry["form"]][entry["column"]]) != entry["value"]:
                found.append(f"{name}: numbers.toml has {entry['value']}, measured is {now}")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--check", action="store_true", help="compare numbers.tex with its sources")
    parser.add_argument("--measure", metavar="PROGRAM", help="run the commands and compare the recorded values")
    options = parser.parse_args()
    numbers = tomllib.loads((HERE / "numbers.toml").read_text())
    if options.measure:
        for difference in (found := differences(str(pathlib.Path(options.measure).resolve()), numbers)):
            print(difference, file=sys.stderr)
        return 1 if found else 0
    try:
        text = document(numbers, Sources())
    except Wrong as error:
        print(f"docs/paper/numbers.toml: {error}", file=sys.stderr)
        return 1
    if not options.check:
        TARGET.write_text(text)
    elif not TARGET.exists() or TARGET.read_text() != text:
        print("docs/paper/numbers.tex differs from its sources; run docs/paper/macros.py", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
