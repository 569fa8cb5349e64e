"""Tests that the tree obeys its rules, and that each rule finds an offence."""
import concurrent.futures
import os
import re
import shutil
import subprocess
import tempfile
import unittest

from rules import *


class Tree(unittest.TestCase):
    """Each rule, on the files that it is for."""

    def hold(self, rule, *folders):
        self.assertEqual([o for path, text in tree(*folders) for o in rule(path, text)], [])

    def test_includes_point_one_way_between_layers_and_folders(self):
        rooms = rooms_in(read("src/README.md"))
        self.assertGreater(len(rooms), 30)
        self.hold(lambda path, text: include_directions(path, text, rooms), "src", "analysis")

    def test_every_folder_has_the_purpose_of_the_list_and_none_is_too_large(self):
        readme = read("src/README.md")
        files = tree("src", "analysis")
        for room in {room_of(path) for path, _ in files} - {PROGRAM}:
            with self.subTest(room):
                self.assertIn(room, rooms_in(readme))
                if re.fullmatch(r"shapes/\w+(/forms|/distribution)?", room):
                    continue  # src/shapes/README.md is about all of them
                own = [(path, text) for path, text in files if room_of(path) == room]
                included = {room_of("src/" + name) for _, text in own for _, _, name in includes_of(text)}
                purpose = re.search(rf"\| `{room}` \| (.*) \|\n", readme)[1]
                names = {path.rpartition("/")[2] for path, _ in own}
                self.assertEqual(readme_offences(room, read(f"{folder_of(room)}/README.md"), purpose, names, included), [])
        self.assertEqual(room_sizes(files), [])

    def test_every_folder_is_a_namespace(self):
        self.hold(room_namespace, "src", "analysis")

    def test_no_two_definitions_share_a_name(self):
        files = tree("src", "analysis")
        self.assertGreater(sum(len(definitions_in(*file)) for file in files), 500)
        self.assertEqual(names_are_unique(files), [])

    def test_no_two_definitions_of_the_scripts_of_the_page_share_a_name(self):
        folder = "src/output/report/script/"
        names = sorted(name for name in os.listdir(ROOT / folder) if name.endswith(".js"))
        files = [(folder + name, read(folder + name)) for name in names]
        self.assertGreater(len(files), 8)
        self.assertEqual(script_names_are_unique(files), [])

    def test_forms_use_four_folders_and_obey_the_rules_of_a_formula(self):
        self.assertGreaterEqual(sum(bool(is_form(*file)) for file in tree("src/shapes")), 21)
        self.assertFalse(is_form("src/shapes/cone/forms/parts.hpp", read("src/shapes/cone/forms/parts.hpp")))
        self.hold(form_includes, "src/intersect", "src/shapes")
        self.hold(formula_rules, "src/intersect", "src/shapes")

    def test_no_number_is_read_by_the_locale(self):
        self.hold(locale_rules, "src", "analysis")

    def test_code_that_names_a_shape_is_in_its_folder_or_has_a_reason(self):
        conventions = "the only table of conventions, shape by shape"
        guesses = "words by which the code of users names shapes and their parts"
        march = "a march takes all primitives together, and has a name among the shapes"
        reasons = {
            "analysis/selection/ray_options.cpp": march,
            "analysis/selection/sets.hpp": march,
            "analysis/judge.cpp": march,
            "src/intersect/external/formula_of.hpp": "compiler errors for authors of forms: two examples and a march",
            "src/intersect/simd/packed_many_kernels.hpp": "a hand-written loop over the planes of a box",
            "src/intersect/simd/plain_many_w256.cpp": "loops over boxes as other projects write them",
            "src/intersect/conventions.hpp": conventions,
            "src/intersect/function/common_names.hpp": guesses,
            "src/intersect/function/signature.cpp": guesses,
            "src/intersect/form_shape.hpp": march,
            "src/intersect/target.hpp": march,
            "src/scene/file/scene.cpp": march,
            "src/scene/sweep/sweep_file.hpp": march}
        found = {path: names_of_shapes(text) for path, text in tree("src", "analysis")
                 if not path.startswith("src/shapes/") and names_of_shapes(text)}
        self.assertEqual(found.keys(), reasons.keys())
        self.assertLessEqual(sum(count for path, count in found.items() if reasons[path] not in (conventions, guesses)), 15)

    def test_the_catalogue_and_the_form_files_agree(self):
        files = tree("src/intersect", "src/shapes")
        lists = [text for path, text in files if "intersect/catalogue" in path or path.endswith("/forms/forms.hpp")]
        self.assertEqual(catalogue_agrees(files, "".join(lists)), [])

    def test_code_reserved_to_one_file_is_only_there(self):
        for text, path in (("#include <CLI/", "analysis/shell/command_line.cpp"),):
            self.assertEqual([file for file, has in tree("src", "analysis", "bench") if text in has], [path])

    def test_every_long_body_has_paragraphs(self):
        self.hold(paragraphs, "src", "analysis")

    def test_no_file_is_too_long(self):
        self.hold(file_length, "src", "analysis", "tests")


class Rules(unittest.TestCase):
    """Each rule, on text that breaks it and on text that does not."""

    def test_a_forbidden_include_is_detected(self):
        rooms = rooms_in(read("src/README.md"))
        for path, text, offences in (
                ("src/number/x.hpp", '#include "geometry/vec.hpp"\n', 1),
                ("src/intersect/table/table.cpp", '#include <cmath>\n#include "measure/truth/truth.hpp"\n', 1),
                ("src/shapes/sphere/forms/x.hpp", "  #  include <scene/rays/camera.hpp>\n", 1),
                ("src/measure/truth/x.cpp", '#include "measure/metric/metrics.hpp"\n', 1),
                ("src/output/file/x.hpp", '#include "output/plot/plot_axis.hpp"\n', 1),
                ("src/intersect/info.hpp", '#include "shapes/sphere/forms/press.hpp"\n', 1),
                ("src/output/map/x.cpp", '#include "analysis/main.hpp"\n', 1),
                ("src/number/x.hpp", '#include "../geometry/vec.hpp"\n', 1),
                ("src/output/file/x.cpp", '#include "csv.hpp"\n', 1),
                ("src/measure/x.hpp", "", 1),
                ("src/extra/x.hpp", "", 1),
                ("src/measure/metric/x.hpp", '#include "measure/truth/truth.hpp"\n#include <mpfr.h>\n', 0),
                ("src/intersect/catalogue_first.hpp", '#include "shapes/sphere/forms/press.hpp"\n', 0),
                ("analysis/x.cpp", '#include "output/file/csv.hpp"\n#include "commands.hpp"\n', 0)):
            self.assertEqual(len(include_directions(path, text, rooms)), offences, (path, text))

    def test_an_incomplete_readme_of_a_folder_is_detected(self):
        right = ("# output/map\n\nThe files of a map.\n\nBegin with `map.hpp`. It may include every folder above it, and "
                 "builds mostly on `output/file`.\n")
        for text, offences in ((right, 0), (right.replace("of a map", "of a sweep"), 1), (right.replace("# o", "o"), 1),
                               (right + "\n" * 5, 1), (right.replace("`map.hpp`", "a header"), 1),
                               (right.replace("map.hpp", "gone.hpp"), 1), (right.replace("/file", "/plot"), 1)):
            found = readme_offences("output/map", text, "the files of a map", {"map.hpp"}, {"output/file"})
            self.assertEqual(len(found), offences, text)

    def test_a_crowded_folder_and_a_wrong_namespace_are_detected(self):
        plain, helper = ("src/output/map/x.cpp", ""), ("src/shapes/sphere/forms/x.hpp", "")
        form = (helper[0], "static constexpr Info info{};")
        self.assertEqual(len(room_sizes([plain] * 23 + [helper] * 23)), 2)
        self.assertEqual(room_sizes([plain] * 22 + [form] * 99 + [helper] * 22), [])
        for path, name, offences in (("src/measure/evaluate/x.cpp", "lostbits::measure::sweep", 2),
                                     ("src/measure/evaluate/x.cpp", "lostbits", 2),
                                     ("src/measure/evaluate/x.cpp", "lostbits::measure::evaluate", 0),
                                     ("src/geometry/x.hpp", "lostbits", 0)):
            self.assertEqual(len(room_namespace(path, f"namespace {name} {{\n}}\n")), offences, name)

    def test_two_definitions_of_one_name_are_detected(self):
        room, other = "namespace lostbits::measure {\n", "namespace lostbits::output {\n"
        kind, function = "struct Standing {\n    int x;\n};\n", "inline int twice(int x) {\n    return 2 * x;\n}\n"
        for a, b, offences in (
                (room + kind, room + kind, 1),
                (room + kind, other + kind, 1),
                (room + kind, other + "using Standing = int;\n", 1),
                (room + kind, room + "enum class Standing : char { a, b };\n", 1),
                (room + function, room + function, 1),
                (room + function, other + function, 0),
                (room + kind, room + "namespace {\n" + kind + "}\n", 0),
                (room + kind, room + "struct Standing;\nstruct Place {\n    struct Standing {};\n};\n", 0),
                (room + kind, room + "/* struct Standing {} */ void f() { struct Standing {}; }\n", 0)):
            files = [("src/measure/evaluate/a.hpp", a + "}\n"), ("src/measure/sweep/b.hpp", b + "}\n")]
            self.assertEqual(len(names_are_unique(files)), offences, (a, b))

    def test_two_definitions_of_one_name_in_scripts_are_detected(self):
        for a, b, offences in (("const twice = 2;\n", "function twice(x) {\n}\n", 1),
                               ("let twice;\n", "async function twice() {\n}\n", 1),
                               ("const twice = 2;\n", "function f() {\n    const twice = 3;\n}\n", 0)):
            self.assertEqual(len(script_names_are_unique([("a.js", a), ("b.js", b)])), offences, (a, b))

    def test_a_forbidden_include_in_a_form_and_a_broken_formula_rule_are_detected(self):
        form, table = "src/shapes/sphere/forms/snippet.hpp", "src/intersect/table/table.cpp"
        for name, offences in (("<cmath>", 1), ('"scene/rays/camera.hpp"', 1), ('"roots.hpp"', 1),
                               ('"intersect/roots.hpp"', 0), ('"number/concept.hpp"', 0)):
            self.assertEqual(len(form_includes(form, f"#include {name}\n")), offences, name)
            self.assertEqual(form_includes(table, f"#include {name}\n"), [])
        for bad in ("const T l = std::sqrt(a);", "const T e = std::fma(a, b, c);", "const T e = std::abs(a);",
                    "T m = std::min(a, b);", "T m = std::max<T>(a, b);", "T m = ::sqrt(a);", "T m = std::fabs(a);",
                    "T s = std::copysign(a, b);", "const T h = T(0.5);", "const T h = 1e-3 * x;",
                    "const T h = x * 2.0f;", "const T h = .5 * x;", "const T h = 4. * x;", "const T h = T(0x1p-3);",
                    "if (disc < T(0)) return miss;", "if(hit) t = far;", "while (t < T(1)) {}",
                    "const T t = near < T(0) ? far : near;", "double t = 0;", "const float k(1);",
                    "std::numeric_limits<T>::epsilon();"):
            self.assertTrue(formula_rules(form, "line one\n" + bad + "\n"), bad)
            self.assertEqual(formula_rules(table, bad), [])
        self.assertEqual(formula_rules(form, "// std::sqrt(x) is mentioned here\n\nconst T l = std::sqrt(a);\n"),
                         [form + ":3: libm by name: std::sqrt"])
        for good in ("const T l = sqrt(a);", "// 0.5 * x and if (a < b), std::sqrt(x)?", "/* t = a ? b : c;\n 1e-3 */",
                     '.source = "eq. 6, section 7.2 (2004)?",', "const T h = T(1) / T(2);",
                     "if (!any_of(active)) break;", "for (int i = 0; i < 64; ++i) {}", "const T t0 = a.x * T(10);"):
            self.assertEqual(formula_rules(form, good), [], good)

    def test_a_number_read_by_the_locale_is_detected(self):
        for bad in ("double x = std::stod(text);", "x = strtod(a, &b);", 'std::setlocale(LC_ALL, "");'):
            self.assertEqual(len(locale_rules("src/x.cpp", bad)), 1, bad)
        self.assertEqual(locale_rules("src/x.cpp", "// strtod() reads 0.5 as 0\nstd::from_chars(a, b, x);"), [])

    def test_a_catalogue_that_disagrees_is_detected(self):
        path = "src/shapes/sphere/forms/thin_lens.hpp"
        text = 'struct ThinLens {\n    static constexpr Info info{\n        .name = "sphere.thin_lens",\n'
        include = '#include "shapes/sphere/forms/thin_lens.hpp"\n'
        entry = "using SphereForms = FormList<sphere::ThinLens>;\n"
        ghost = '#include "shapes/sphere/forms/ghost.hpp"\n'
        for catalogue, offences in ((include + entry, 0), (entry, 1), (include, 1), (include + "// sphere::ThinLens\n", 1),
                                    (include + include + entry, 1), (include + entry + entry, 1),
                                    (include + ghost + entry, 1), (include + entry + "sphere::Ghost\n", 1)):
            self.assertEqual(len(catalogue_agrees([(path, text)], catalogue)), offences, catalogue)
        renamed = text.replace("sphere.thin_lens", "sphere.thick_len")
        self.assertEqual(len(catalogue_agrees([(path, renamed)], include + entry)), 1)

    def test_long_files_names_of_shapes_and_code_are_recognised(self):
        self.assertEqual(file_length("x", "\n" * 500 + "ü" * 120), [])
        self.assertEqual([len(file_length("x", text)) for text in ("\n" * 501, "x" * 121)], [1, 1])
        self.assertEqual(names_of_shapes("if (solid.shape != Shape::box) return;\nconst Sphere<S> sphere;"), 2)
        self.assertEqual(names_of_shapes("// of Cone<T>\nif (shape == Shape::sdf) return;\nShapes all;"), 2)
        for text, code in (('a "b\\" c" d', 'a "     " d'), ("a // b\nc", "a     \nc"),
                           ("a /* b\n c */ d", "a     \n      d"), ("x = 'y'; 1'000", "x = ' '; 1'000")):
            self.assertEqual(code_of(text), code)

    def test_a_long_body_without_paragraphs_is_detected(self):
        lines = ["    f(1);"] * 25
        for head, body, offences in (("void f() {", lines, 1), ("void f() {", lines[:24], 0), ("struct F {", lines, 0),
                                     ("void f() {", lines[:20] + ["", "    // Ends."] + lines[:20], 0)):
            self.assertEqual(len(paragraphs("x", "\n".join([head, *body, "}"]))), offences, head)


class Format(unittest.TestCase):
    """The format of files, by one clang-format per processor at a time."""

    def test_every_file_is_formatted_and_one_that_is_not_is_detected(self):
        program = shutil.which("clang-format-14") or shutil.which("clang-format")
        if not program:
            self.skipTest("clang-format is not installed")

        def offences(files):
            return subprocess.run([program, "--dry-run", "-Werror", *files], stderr=subprocess.PIPE, text=True).stderr

        files = [path for folder in ("src", "analysis", "tests", "bench") for kind in ("hpp", "cpp", "js")
                 for path in (ROOT / folder).rglob("*." + kind)]
        self.assertGreater(len(files), 300)
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            self.assertEqual("".join(pool.map(offences, (files[i::16] for i in range(16)))), "")
        with tempfile.TemporaryDirectory() as folder:
            shutil.copy(ROOT / ".clang-format", folder)
            control = pathlib.Path(folder, "control.cpp")
            control.write_text("int  twice(int x){return 2*x;}\n")
            self.assertIn("control.cpp:1:4", offences([control]))


if __name__ == "__main__":
    unittest.main()
