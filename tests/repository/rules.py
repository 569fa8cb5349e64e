"""The rules for the source tree.

A rule takes the path of a file, from the root of the repository, and its text. It returns `path:line: what` for each
offence.
"""
import pathlib
import re
from collections import Counter

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = "analysis"


def read(path):
    return (ROOT / path).read_text()


def tree(*folders):
    """Path and text of each C and C++ file in some folders."""
    paths = (p for folder in folders for p in (ROOT / folder).rglob("*") if p.suffix in (".hpp", ".cpp", ".h"))
    return [(str(p.relative_to(ROOT)), p.read_text()) for p in sorted(paths) if p.is_file()]


def code_of(text):
    """The text with comments and contents of strings replaced by spaces, in the same lines. 1'000 has no string."""
    def blank(m):
        keep = m[0][0] if m[0][0] in "\"'" else ""
        end = keep if keep and len(m[0]) > 1 and m[0].endswith(keep) else ""
        return keep + re.sub(r"[^\n]", " ", m[0][len(keep):len(m[0]) - len(end)]) + end
    return re.sub(r"//[^\n]*|/\*.*?(?:\*/|\Z)|\"(?:\\.|[^\"\\\n])*\"?|(?<![0-9A-Za-z])'(?:\\.|[^'\\\n])*'?", blank, text,
                  flags=re.S)


def includes_of(text):
    """Line, opening character and name of each include."""
    found = re.finditer(r"^[ \t]*#[ \t]*include[ \t]*([<\"])([^>\"\n]+)[>\"]", text, re.M)
    return [(text.count("\n", 0, m.start()) + 1, m[1], m[2]) for m in found]


def room_of(path):
    """The room, a folder below src/ or the program: `measure/truth` for src/measure/truth/x.hpp, `analysis` for
    analysis/x.cpp."""
    return path.rpartition("/")[0].removeprefix("src/")


def rooms_in(readme):
    """All rooms in include order, from the table of src/README.md. The program is the last."""
    return re.findall(r"\| `([\w/]+)` \|", readme) + [PROGRAM]


def folder_of(room):
    """The folder of a room, from the root of the repository."""
    return room if room.startswith(PROGRAM) else f"src/{room}"


def readme_offences(room, text, purpose, files, included):
    """The README of a room has its name, the purpose that the list gives (with a capital letter), the files to begin
    with, and the folders on which its code builds, in at most nine lines. `files` are the files of the room, and
    `included` the rooms whose headers they include."""
    words = " ".join(text.split())
    begin = re.search(r"Begin with (.*?)\. It ", words)
    begin_files = re.findall(r"`([\w/.]+\.(?:hpp|cpp|h))`", begin[1]) if begin else []
    builds = re.search(r"builds mostly on (.*)\.$", words)
    missing_files = [name for name in begin_files
                     if name not in files and not any((f / name).is_file() for f in (ROOT, ROOT / folder_of(room)))]
    missing_rooms = [name for name in re.findall(r"`([\w/]+)`", builds[1] if builds else "") if name not in included]
    return ([f"{room}/README.md: does not begin with its name and its purpose"]
            * (not words.startswith(f"# {room} {purpose[0].upper()}{purpose[1:]}."))
            + [f"{room}/README.md: has more than nine lines"] * (text.count("\n") > 9)
            + [f"{room}/README.md: names no file to begin with"] * (not begin_files)
            + [f"{room}/README.md: names {name}, which does not exist" for name in missing_files]
            + [f"{room}/README.md: says that it builds on {name}, which it does not include" for name in missing_rooms])


def namespace_of(room):
    """The namespace of a room, which follows its path. Numbers, geometry and shapes are in `lostbits`, so that a
    formula over float finds their operations."""
    if m := re.fullmatch(r"shapes/(\w+)/(\w+)", room):
        return ("lostbits::intersect::" if m[2] == "forms" else "lostbits::scene::") + m[1]
    if room in ("number", "geometry") or room.startswith("shapes"):
        return "lostbits"
    return "lostbits::" + room.replace("/", "::")


def include_directions(path, text, rooms):
    """A file lies in a room and includes only that room and rooms before it in the list. Headers are named from src/
    (those of the program, in analysis/, by their bare names)."""
    own = room_of(path)
    if own not in rooms:
        return [f"{path}: is in no folder that src/README.md lists"]
    offences = []
    for line, bracket, name in includes_of(text):
        room = name.rpartition("/")[0]
        # The catalogue is the closed list of forms. Only it may include headers of their rooms.
        lists = path.startswith("src/intersect/catalogue") and (room.startswith("intersect/") or room.endswith("/forms"))
        if room not in rooms:
            if bracket == '"' and not (own == PROGRAM and not room):
                offences.append(f"{path}:{line}: includes {name}, which must be named from src/")
        elif rooms.index(room) > rooms.index(own) and not lists:
            offences.append(f"{path}:{line}: {own} includes {name}, whose folder comes later in src/README.md")
    return offences


def room_namespace(path, text):
    """A file opens the namespace of its room, and no other namespace of lostbits that is not inside it."""
    own, code = namespace_of(room_of(path)), "\n" + code_of(text)
    names = re.findall(r"\n(?:inline )?namespace ([\w:]+) \{", code)
    offences = [f"{path}: opens {name}, but its folder has {own}" for name in names
                if name.startswith("lostbits") and not (name + "::").startswith(own + "::")]
    return offences + [f"{path}: does not open {own}"] * ("\nnamespace " in code and own not in names)


def definitions_in(path, text):
    """Definitions at namespace scope, outside of anonymous namespaces. Each is path:line, the name with its namespaces
    (for an inline function with its parameters), and for a type also the name alone."""
    code = re.sub(r"(?m)^[ \t]*#[^\n]*", lambda m: " " * len(m[0]), code_of(text))
    found, scopes, begin = [], [], 0
    for m in re.finditer(r"[{};]", code):
        head = code[begin:m.start()]
        line = code.count("\n", 0, begin + len(head) - len(head.lstrip())) + 1
        begin, flat, scope = m.end(), re.sub(r"\s+", " ", head.lstrip()), ""
        space = re.match(r"(?:inline )?namespace ?([\w:]*) ?$", flat)
        kind = re.search(r"\b(?:struct|class|union|enum(?: class)?) (?:\[\[\w+\]\] ?)?(\w+(?:<.*>)?) ?"
                         r"(?:final ?)?(?::[^:(].*)?$", flat)
        alias = re.match(r"(?:template ?<[^=]*> ?)?using (\w+) ?=", flat)
        if m[0] == "}":
            scopes = scopes[:-1]
            continue
        if all(scopes) and not space:
            plain = alias[1] if m[0] == ";" and alias else kind[1] if m[0] == "{" and kind and "(" not in flat else ""
            if plain or (m[0] == "{" and re.match(r"(template|inline|constexpr)\b", flat)):
                found.append((f"{path}:{line}", "::".join([*scopes, plain or flat]), plain))
        if m[0] == "{":
            scopes.append(space[1] if space else "")
    return found


def names_are_unique(files):
    """No qualified name is defined twice, which would be undefined behaviour that no linker reports. No two types in
    different namespaces share a name, since a reader would mix them up."""
    names, words, offences = {}, {}, []
    for place, name, plain in (d for path, text in files for d in definitions_in(path, text)):
        if name in names:
            offences.append(f"{place}: {name} is also defined at {names[name]}")
        elif plain in words:
            offences.append(f"{place}: {name} has the same name as {words[plain]}")
        names.setdefault(name, place)
        if plain:
            words.setdefault(plain, f"{name} at {place}")
    return offences


def script_names_are_unique(files):
    """Offences: names that two scripts of the page define at their outermost level, since they share one scope."""
    found, offences = {}, []
    for path, text in files:
        for name in re.findall(r"^(?:async )?(?:function\*? |const |let |var |class )(\w+)", text, re.MULTILINE):
            if name in found:
                offences.append(f"{path}: {name} is also defined in {found[name]}")
            found[name] = path
    return offences


def room_sizes(files):
    """A room has at most 22 files, so that a reader can survey it. Forms do not count, since each is read alone."""
    sizes = Counter(room_of(path) for path, text in files if not is_form(path, text))
    return [f"{room}: {n} files, but at most 22 are allowed" for room, n in sizes.items() if n > 22]


def in_shape_folder(path):
    return re.fullmatch(r"src/(shapes/\w+/forms|intersect/sdf)/\w+\.hpp", path)


def is_form(path, text):
    """True if a file declares an `Info`, unlike a helper of forms."""
    return in_shape_folder(path) and "static constexpr Info info" in text


def form_includes(path, text):
    """A file in a shape's folder of forms includes only from these four layers."""
    allowed = ("number/", "geometry/", "shapes/", "intersect/")
    return [f"{path}:{line}: a form includes {name}" for line, _, name in includes_of(text)
            if in_shape_folder(path) and not name.startswith(allowed)]


def find_all(path, text, patterns):
    code = code_of(text)
    return [f"{path}:{code.count(chr(10), 0, m.start()) + 1}: {what}: {m[0]}"
            for what, pattern in patterns.items() for m in re.finditer(pattern, code)]


def formula_rules(path, text):
    """A formula uses no libm function by name, no decimal literal, no `if` on a mask, no ternary, no float or double,
    and no epsilon. (`if` on `widens` is allowed, since that depends only on the format.)"""
    shared = path in ("src/intersect/roots.hpp", "src/intersect/outward.hpp")
    return find_all(path, text, {
        "libm by name": r"(?:\bstd::|(?<![:\w])::)(?:sqrt|cbrt|hypot|fma|f?abs|f?min|f?max|copysign|signbit|pow|exp|log"
                        r"|sin|cos|tan|floor|ceil|nextafter)\w*\b",
        "a decimal literal": r"(\b\d+\.\d*|\.\d+)([eE][-+]?\d+)?[fFlL]?|\b\d+[eE][-+]?\d+"
                             r"|\b0[xX][0-9a-fA-F.]*[pP][-+]?\d+",
        "a branch that is not on any_of": r"\b(if|while|switch)\s*\((?!\s*!?\s*any_of\b|number::wide::widens\b)",
        "a ternary": r"\?",
        "a type that is not T": r"\b(float|double)\b",
        "an epsilon": r"\b(numeric_limits|FLT_EPSILON|DBL_EPSILON)\b"}) if shared or in_shape_folder(path) else []


def locale_rules(path, text):
    """No function that uses the decimal point of the locale reads numbers, since a loaded library may change it."""
    return find_all(path, text, {"reads a number by the locale; use std::from_chars":
                                 r"\b(stod|stof|stold|strtod|strtof|strtold|atof|setlocale)\s*\("})


def catalogue_agrees(files, catalogue):
    """The catalogue includes and lists every form once, and nothing else."""
    included = Counter(name for _, _, name in includes_of(catalogue))
    listed = Counter(re.findall(r"\b\w+::[A-Z]\w+\b", code_of(catalogue)))
    offences = []
    for path, text in files:
        if not is_form(path, text):
            continue
        shape, header = path.split("/")[2], path.removeprefix("src/")
        declared = re.search(r"struct (\w+) [^{;]*\{\s*static constexpr Info info", text)
        form, name = f"{shape}::{declared and declared[1]}", re.search(r'\.name = "([^"]*)"', text)[1]
        if (times := included.pop(header, 0)) != 1:
            offences.append(f"{path}: the catalogue includes it {times} times instead of once")
        if (times := listed.pop(form, 0)) != 1:
            offences.append(f"{path}: the catalogue lists {form} {times} times instead of once")
        if name != f"{shape}.{pathlib.Path(path).stem}":
            offences.append(f"{path}: the form is named {name}; it must be {shape}.{pathlib.Path(path).stem}")
    offences += [f"the catalogue includes {name}, which is not a form" for name in included
                 if in_shape_folder("src/" + name) and not name.endswith("/forms/forms.hpp")]
    return offences + [f"the catalogue lists {form}, which has no file" for form in listed if not form.endswith("Forms")]


def file_length(path, text):
    """A file has at most 500 lines, and a line at most 120 characters."""
    lines = text.count("\n")
    return [f"{path}: {lines} lines; at most 500 are allowed"] * (lines > 500) + [
        f"{path}:{i}: {len(line)} characters; at most 120 are allowed"
        for i, line in enumerate(text.split("\n"), 1) if len(line) > 120]


def paragraphs(path, text):
    """A body of 25 lines or more has a blank line or a comment, so that it can be read step by step."""
    code, lines, offences, opened, begin = code_of(text), text.split("\n"), [], [], 0
    for m in re.finditer(r"[{};]", code):
        head = re.sub(r"\s+", " ", code[begin:m.start()].strip())
        begin, line = m.end(), code.count("\n", 0, m.start())
        if m[0] == "{":
            is_function = re.search(r"\)[^()]*$", head) and not re.match(r"(\} ?)?(if|for|while|switch|else|catch)\b", head)
            opened.append(line if is_function and "=" not in head and "[" not in head.rpartition("]]")[2] else None)
        elif m[0] == "}" and opened and (first := opened.pop()) is not None:
            body = lines[first + 1:line]
            if len(body) >= 25 and not any(not b.strip() or "//" in b for b in body):
                offences.append(f"{path}:{first + 1}: a body of {len(body)} lines without a blank line or a comment")
    return offences


def names_of_shapes(text):
    """Counts lines that name a shape by `Shape::` or by its struct, also in comments and strings."""
    structs = re.findall(r"    line\(\w+, (\w+)\)", read("src/shapes/list.hpp"))
    name = re.compile("|".join(["Shape::", *(rf"\b{s}<" for s in structs)]))
    return sum(bool(name.search(line)) for line in text.split("\n"))
