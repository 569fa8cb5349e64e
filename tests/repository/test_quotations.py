"""Tests that the quotations of claims can be looked up, and that as many claims have one as were checked."""
import pathlib
import re
import tomllib
import unittest

ROOT = pathlib.Path(__file__).parents[2]
MOST_WORDS = 12
CHECKED = 124  # claims whose source was opened and the quotation found there; the number may only grow
PLACE = re.compile(r"https?://\S|\bpages? \d")


def offences(claim):
    """What is wrong with the quotation of a claim."""
    source, quotation = claim["source"], claim.get("quotation")
    if quotation is None:
        return []
    words = len(quotation.split())
    return (["quotes nobody"] * (source == "-")
            + [f"quotes {words} words"] * (not 1 <= words <= MOST_WORDS)
            + ["names neither an address nor a page"] * (source != "-" and not PLACE.search(source)))


class Quotations(unittest.TestCase):
    def setUp(self):
        self.claims = [claim for file in sorted(ROOT.glob("data/claims/*.toml"))
                       for claim in tomllib.loads(file.read_text(encoding="utf-8"))["claim"]]

    def test_a_quotation_is_short_and_its_source_has_an_address_or_a_page(self):
        self.assertEqual([(c["id"], o) for c in self.claims for o in offences(c)], [])

    def test_as_many_claims_quote_their_source_as_were_checked(self):
        self.assertGreaterEqual(sum("quotation" in c for c in self.claims), CHECKED)

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

    def test_the_page_about_claims_explains_the_key(self):
        page = (ROOT / "docs/claims.md").read_text(encoding="utf-8")
        self.assertRegex(page, r"`quotation`[^.]* at most twelve words")


if __name__ == "__main__":
    unittest.main()
