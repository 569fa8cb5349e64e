"""Tests that the paper's numbers come from their sources, and that each check finds an offence."""
import copy
import re
import sys
import tomllib
import unittest

from rules import ROOT, read

sys.path.insert(0, str(ROOT / "docs" / "paper"))
import macros  # noqa: E402
import small_formats  # noqa: E402

PAPER = "docs/paper/paper.tex"


def argument_end(text, begin):
    """The index after the brace that closes the one at `begin`."""
    depth = 0
    for m in re.compile(r"\\.|[{}]", re.S).finditer(text, begin):
        depth += {"{": 1, "}": -1}.get(m[0], 0)
        if depth == 0:
            return m.end()
    return len(text)


def without_arguments(text, commands):
    """The text without the arguments of some commands, whose names a regular expression matches."""
    found = re.search(rf"\\({commands})\*?(?=\{{)", text)
    while found:
        end = found.end()
        while text[end:end + 1] == "{":
            end = argument_end(text, end)
        text = text[:found.start()] + text[end:]
        found = re.search(rf"\\({commands})\*?(?=\{{)", text)
    return text


def body_of(text):
    """The paper between \\begin{document} and the references, without comments."""
    text = re.sub(r"(?<!\\)%.*", "", text)
    return text.partition(r"\begin{document}")[2].partition(r"\begin{thebibliography}")[0]


def typed_numbers(text):
    """Numbers that are typed: all but whole numbers up to 100, years, and digits in names such as binary32."""
    text = re.sub(r"\\begin\{tabular\}", r"\\tabular", body_of(text))
    text = without_arguments(text, "label|ref|cite|texttt|url|drawing|tabular")
    numbers = re.findall(r"(?<![A-Za-z\d])\d+(?:(?:\\,|\{[.,]\}|[.,])\d+)*", text)
    return [n for n in numbers if not (n.isdigit() and (int(n) <= 100 or 1900 <= int(n) < 2100))]


def used(text):
    return set(re.findall(r"\\N([A-Z][A-Za-z]*)", body_of(text))) - {"umberSources"}


def outside_of_mathematics(text):
    """Macros that stand outside of $...$, where they would swallow the space after them."""
    return re.findall(r"\\N[A-Z][A-Za-z]*", re.sub(r"(?<!\\)\$.*?(?<!\\)\$", "", body_of(text), flags=re.S))


def unbalanced(text):
    """Braces and environments that are not closed, in order of the text."""
    text, offences, open_ones = re.sub(r"(?<!\\)%.*", "", text), [], []
    for m in re.finditer(r"\\(begin|end)\{(\w+\*?)\}|\\.|[{}]", text, re.S):
        if m[1] == "begin" or m[0] == "{":
            open_ones.append(m[2] or "{")
        elif m[1] == "end" or m[0] == "}":
            expected = m[2] or "{"
            if not open_ones or open_ones.pop() != expected:
                offences.append(f"line {text.count(chr(10), 0, m.start()) + 1}: {m[0]} closes nothing")
    return offences + [f"{name} is not closed" for name in open_ones]


def dangling(text):
    """References without a label or an entry, entries that are not cited, and labels that are not referenced."""
    labels, references = set(re.findall(r"\\label\{(.*?)\}", text)), set(re.findall(r"\\ref\{(.*?)\}", text))
    entries = set(re.findall(r"\\bibitem\{(.*?)\}", text))
    cited = {key for keys in re.findall(r"\\cite\{(.*?)\}", text) for key in keys.split(",")}
    return sorted(references - labels) + sorted(cited ^ entries)


class Paper(unittest.TestCase):
    """The paper as it is committed. LaTeX is not needed."""

    def setUp(self):
        self.text = read(PAPER)
        self.numbers = tomllib.loads(read("docs/paper/numbers.toml"))

    def test_the_macros_are_those_of_the_sources(self):
        self.assertEqual(macros.document(self.numbers, macros.Sources()), read("docs/paper/numbers.tex"),
                         "run docs/paper/macros.py")

    def test_every_number_is_a_macro_and_every_macro_is_used(self):
        self.assertEqual(typed_numbers(self.text), [])
        self.assertEqual(used(self.text), set(self.numbers["number"]))
        self.assertEqual(outside_of_mathematics(self.text), [])

    def test_braces_environments_and_references_are_complete(self):
        for path in (PAPER, "docs/paper/numbers.tex"):
            self.assertEqual(unbalanced(read(path)), [])
        self.assertEqual(dangling(self.text), [])

    def test_every_figure_has_a_rule(self):
        figures = re.findall(r"\\drawing\{([\w.]+)\}", self.text)
        self.assertEqual(len(figures), 2)
        for figure in figures:
            self.assertIn(f"$(OUT)/{figure}:", read("docs/paper/Makefile"))


class Theorems(unittest.TestCase):
    """The theorems on slabs, for every ray in formats of few bits."""

    def test_slabs_part_by_no_more_than_is_proved(self):
        for p in range(4, 9):
            gaps = list(small_formats.parted(p))
            self.assertGreater(len(gaps), 0)
            for tmax, tmin in gaps:
                self.assertLessEqual(tmin * 2**(3 * p), tmax * (2**p + 2)**3)  # tmin <= tmax (1 + 2u)^3
                self.assertLessEqual(tmin - tmax, 3)  # last places

    def test_a_factor_of_six_u_is_enough_and_one_of_four_is_not(self):
        for p in range(5, 9):
            self.assertTrue(all(small_formats.padded(tmax, 3, p) >= tmin for tmax, tmin in small_formats.parted(p)))
        self.assertFalse(all(small_formats.padded(tmax, 2, 7) >= tmin for tmax, tmin in small_formats.parted(7)))

    def test_with_division_a_factor_of_four_u_is_enough_and_one_of_two_is_not(self):
        for p in range(5, 9):
            gaps = list(small_formats.parted(p, divides=True))
            self.assertTrue(all(tmin * 2**(2 * p) <= tmax * (2**p + 2)**2 for tmax, tmin in gaps))  # tmax (1 + 2u)^2
            self.assertTrue(all(small_formats.padded(tmax, 2, p) >= tmin for tmax, tmin in gaps))
            self.assertFalse(all(small_formats.padded(tmax, 1, p) >= tmin for tmax, tmin in gaps))


class Checks(unittest.TestCase):
    """Each check finds an offence."""

    def wrong(self, message, change, name="SlabWorst"):
        numbers = tomllib.loads(read("docs/paper/numbers.toml"))
        change(numbers["number"][name])
        with self.assertRaisesRegex(macros.Wrong, message):
            macros.document(numbers, macros.Sources())

    def test_a_source_that_is_wrong_is_detected(self):
        self.wrong("is not the id of a claim", lambda n: n.update(claim="bound.slabs-nothing"))
        self.wrong("rests on proof", lambda n: n.update(evidence="sample"))
        self.wrong("is not a whole number", lambda n: n.pop("digits"))
        self.wrong("must have one of", lambda n: n.update(file="docs/bounds.md"))
        self.wrong("different matches", lambda n: n.update(pattern="no such text"), "SlabEta")
        self.wrong("is missing", lambda n: n.update(file="docs/nothing.md"), "SlabEta")
        self.wrong("prints as", lambda n: n.update(digits=6), "VdbBits")
        self.wrong("is not one of the commands", lambda n: n.update(command="nowhere"), "MeshWoop")

    def test_a_claim_that_changes_changes_the_macros(self):
        numbers, sources = tomllib.loads(read("docs/paper/numbers.toml")), macros.Sources()
        before = macros.document(numbers, sources)
        changed = copy.deepcopy(sources)
        changed.measured["bound.slabs-worst"]["measured"] = "5.98"
        self.assertNotEqual(macros.document(numbers, changed), before)
        changed.measured["bound.slabs-worst"]["state"] = "differs"
        with self.assertRaisesRegex(macros.Wrong, "bound.slabs-worst differs"):
            macros.document(numbers, changed)

    def test_values_are_printed_as_they_are_read(self):
        for value, entry, text in [("29813", {}, r"29\,813"), ("4100", {}, "4100"), ("6.6e10", {}, r"6.6\cdot 10^{10}"),
                                   ("10^9", {}, "10^{9}"), ("0.5118", {"scale": 100, "digits": 2}, "51"),
                                   ("1.997", {"digits": 3}, "2.00"), ("10.0.1", {}, "10.0.1"), ("5,120", {}, "5120"),
                                   ("1961.5", {"digits": 3}, "1960"), ("0.00058", {"digits": 2}, "0.00058")]:
            self.assertEqual(macros.printed(value, entry), text)

    def test_a_typed_number_is_detected(self):
        paper = "\\begin{document}%s\\begin{thebibliography}{9}1.5\\end{thebibliography}"
        for text in ["5.99", r"29\,813", "29,813", "4100", "0{.}99", "101", "$6.0u$", r"\textbf{137}"]:
            self.assertEqual(len(typed_numbers(paper % text)), 1, text)
        for text in ["binary32", "$2^{-23}$", r"\tfrac{16}{3}", "in 2019", "% 5.99", r"\cite{a5.9}", r"\texttt{v{1.5}}",
                     r"\begin{tabular}{p{0.5\linewidth}r}", r"$\eta = 0, 24$"]:
            self.assertEqual(typed_numbers(paper % text), [], text)
        self.assertEqual(outside_of_mathematics(paper % r"$\NGood$ and \NBad rays"), [r"\NBad"])

    def test_what_is_not_closed_or_not_there_is_detected(self):
        for text in ["{", "}", r"\begin{a}", r"\end{a}", r"\begin{a}\end{b}", r"\begin{a}{\end{a}}", r"{\}"]:
            self.assertNotEqual(unbalanced(text), [], text)
        for text in ["{}", r"\{", "% {", r"\begin{a}{b}\end{a}"]:
            self.assertEqual(unbalanced(text), [], text)
        for text in [r"\ref{a}", r"\cite{a}", r"\bibitem{a}"]:
            self.assertEqual(dangling(text), ["a"])


if __name__ == "__main__":
    unittest.main()
