"""Tests that every claim from a source quotes it, in few words that can be looked up."""
import pathlib
import re
import tomllib
import unittest

ROOT = pathlib.Path(__file__).parents[2]
MOST_WORDS = 12
PLACE = re.compile(r"https?://\S|\bpages? \d")


def offences(claim):
    """What is wrong with the source and the quotation of a claim."""
    source, quotation = claim["source"], claim.get("quotation")
    if source == "-":
        return ["quotes nobody"] * (quotation is not None)
    words = 0 if quotation is None else len(quotation.split())
    return ([f"quotes {words} words"] * (not 1 <= words <= MOST_WORDS)
            + ["names neither an address nor a page"] * (not PLACE.search(source)))


class Quotations(unittest.TestCase):
    def setUp(self):
        self.claims = [claim for file in sorted(ROOT.glob("data/claims/*.toml"))
                       for claim in tomllib.loads(file.read_text(encoding="utf-8"))["claim"]]

    def test_every_source_is_quoted_in_few_words_and_has_an_address_or_a_page(self):
        self.assertGreater(sum("quotation" in c for c in self.claims), 200)
        self.assertEqual([(c["id"], o) for c in self.claims for o in offences(c)], [])

    def test_each_rule_detects_a_violation(self):
        right = {"source": "Fell, https://example.org/fell.pdf", "quotation": "no intersection"}
        self.assertEqual(offences(right), [])
        self.assertEqual(offences({"source": "Knuth, page 12", "quotation": "ulp"}), [])
        self.assertEqual(offences({"source": "-"}), [])
        for key, bad, what in (("source", "-", "quotes nobody"), ("source", "Fell, course notes", "names neither"),
                               ("quotation", "a " * 13, "quotes 13"), ("quotation", " ", "quotes 0")):
            with self.subTest(bad):
                [found] = offences(right | {key: bad})
                self.assertIn(what, found)
        self.assertEqual(offences({"source": right["source"]}), ["quotes 0 words"])

    def test_the_page_about_claims_explains_the_key(self):
        page = (ROOT / "docs/claims.md").read_text(encoding="utf-8")
        self.assertRegex(page, r"`quotation`[^.]* at most twelve words")


if __name__ == "__main__":
    unittest.main()
