"""Results of the calls that measure."""

from __future__ import annotations

import io
import re
from typing import Any, Iterator

import numpy as np
from numpy.typing import NDArray

from ._library import EnvironmentFault
from ._tables import Table, optional
from ._trace import Tape


class ByRow:
    """Tables by form and format: `of["sphere.unified", "f32"]`. A form of your own also goes by its function's name.

    Raises a KeyError that lists the pairs if there is no table for a form and format.
    """

    def __init__(self, tables: dict[str, Any]) -> None:
        self._tables = {name: table for name, table in tables.items() if name != "summary"}

    def __getitem__(self, key: Any) -> Any:
        if not (isinstance(key, tuple) and len(key) == 2):
            raise KeyError(f"{key!r} is not a pair; write a form and a format, as in [\"sphere.unified\", \"f32\"]")
        form = getattr(key[0], "name", key[0])
        for name in (f"{form}.{key[1]}", f"py.{form}.{key[1]}"):
            if name in self._tables:
                return self._tables[name]
        raise KeyError(f"no table for {form} in {key[1]}; available: {', '.join(map(str, self))}")

    def __iter__(self) -> Iterator[tuple[str, str]]:
        return ((form, format) for form, _, format in (name.rpartition(".") for name in self._tables))

    def __len__(self) -> int:
        return len(self._tables)

    def __repr__(self) -> str:
        return f"<lostbits tables of {', '.join(self._tables)}>"


class Pixels(Table):
    """One form and format of a map. Every column is an array of shape (height, width). `.frame` has a row per pixel."""

    def __init__(self, table: Table, size: tuple[int, int]) -> None:
        super().__init__(table.name, table.columns, len(table))
        self.size = size

    def __getitem__(self, column: str) -> NDArray[Any]:
        return super().__getitem__(column).reshape(self.size[1], self.size[0])

    def outcome_colours(self) -> NDArray[np.uint8]:
        """Red, green and blue of the outcome of each pixel, as an array of shape (height, width, 3)."""
        codes, colours, _ = self._outcomes()
        return colours[codes].reshape(self.size[1], self.size[0], 3)

    def outcomes_in(self, mask: NDArray[np.bool_]) -> list[tuple[str, NDArray[np.uint8]]]:
        """Names and colours of the outcomes of the pixels in a mask, in the order of the program."""
        codes, colours, names = self._outcomes()
        return [(names[k].replace("agree_", "correct_").replace("_", " "), colours[k])
                for k in np.unique(codes[mask.ravel()])]

    def _outcomes(self) -> tuple[NDArray[np.uint8], NDArray[np.uint8], list[str]]:
        """The code of the outcome of each pixel, and the colours and names of the codes."""
        outcome = self.columns["outcome"]
        assert outcome.codes is not None and outcome.colours is not None
        return outcome.codes, outcome.colours, outcome.categories


class Summarised:
    """A result with the table `.summary`, which is `.frame` in pandas."""

    def __init__(self, summary: Table) -> None:
        self.summary = summary

    @property
    def frame(self) -> Any:
        """The summary as a pandas.DataFrame."""
        return self.summary.frame

    def __repr__(self) -> str:
        rows = dict.fromkeys(map(" in ".join, zip(self.summary["form"], self.summary["format"])))
        return f"<lostbits {type(self).__name__.lower()} of {', '.join(rows)}>"


class Map(Summarised):
    """Result of `map`: `.summary`, `.frame`, `.pixels[form, format]`. A notebook shows it as a picture."""

    def __init__(self, tables: dict[str, Table], size: tuple[int, int]) -> None:
        super().__init__(tables["summary"])
        self.size = size
        self.pixels = ByRow({name: Pixels(table, size) for name, table in tables.items()})

    def figure(self, column: str = "lost_bits") -> Any:
        """A picture for each form and format, as a matplotlib Figure. All have the same range.

        A ray without a value has the colour of its outcome, as in the program's pictures, and a legend names it.
        """
        rows = list(self.pixels)
        images = [np.asarray(self.pixels[row][column], dtype=float) for row in rows]
        figure = optional("matplotlib.figure").Figure(figsize=(3 * len(rows) + 0.8, 3.4))
        top = max((float(np.nanmax(i)) for i in images if np.isfinite(i).any()), default=1.0)
        axes = figure.subplots(1, len(rows), squeeze=False)[0]
        for axis, (form, format), image in zip(axes, rows, images):
            axis.imshow(self.pixels[form, format].outcome_colours(), interpolation="nearest")
            shown = axis.imshow(image, vmin=0, vmax=max(top, 1e-9), interpolation="nearest")
            axis.set_title(f"{form}, {format}", fontsize=9)
            axis.set_xticks([]), axis.set_yticks([])
        label = f"{column} ({self.pixels[rows[0]].columns[column].unit})"
        figure.colorbar(shown, ax=list(axes), label=label, shrink=0.8)
        seen = {name: colour for row, image in zip(rows, images)
                for name, colour in self.pixels[row].outcomes_in(np.isnan(image))}
        patch = optional("matplotlib.patches").Patch
        figure.legend(handles=[patch(color=colour / 255, label=name) for name, colour in seen.items()],
                      loc="lower center", ncols=max(len(seen), 1), fontsize=8, frameon=False)
        return figure

    def _repr_png_(self) -> bytes | None:
        if len(self.pixels) == 0:
            return None
        try:
            out = io.BytesIO()
            self.figure().savefig(out, format="png", dpi=100, bbox_inches="tight")
            return out.getvalue()
        except EnvironmentFault:
            return None


def _explaining(form: str, command: str) -> str:
    """The call that explains a ray of a form of the user; a command of the program for the others."""
    pixel = re.search(r"--pixel (\d+),(\d+)", command)
    if not form.startswith("py.") or pixel is None:
        return command
    return f"lb.explain({form.removeprefix('py.')}, scene, pixel=({pixel[1]}, {pixel[2]}))"


class Checked:
    """Result of `check`: true if the requirement is met. `.ok`, `.text`, `.summary` (one row, as of a map)."""

    wrong_names = ("false_hit", "false_miss", "not_a_number", "wrong_primitive", "crack", "double_hit", "out_of_order",
                   "unresolved")

    def __init__(self, summary: Table, bits: float | None, fewer: float, wrong: float) -> None:
        self.summary = summary
        row = {name: summary[name][0] for name in summary}
        count = sum(int(row[name]) for name in self.wrong_names if name in row)
        rays, hits = int(row["rays"]), int(row["agree_hit"])
        parts = [f"decides {count} of {rays} rays wrongly, where {int(wrong * rays)} are allowed"]
        self.ok = count <= wrong * rays
        if bits is not None:
            few = int(row["enough_bits_too_few"])
            self.ok = self.ok and few <= fewer * hits and hits > 0
            parts.append(f"keeps fewer than {bits:g} bits on {few} of {hits} correct hits, where {int(fewer * hits)} "
                         "are allowed")
        self.text = f"{row['form']} in {row['format']} {', and '.join(parts)}"
        for name, words in (("fault_explain", "a wrong decision"), ("worst_explain", "the largest error of t")):
            if row.get(name):
                self.text += f"\n  {words}: {_explaining(str(row['form']), str(row[name]))}"

    def __bool__(self) -> bool:
        return self.ok

    def __repr__(self) -> str:
        return f"<lostbits check: {'ok' if self.ok else 'not met'}: {self.text}>"


class Judgement(Summarised):
    """Result of `judge`: `.summary`, `.frame`, `.rays` (the judged answers, a row per ray), `.of[form, format]`."""

    def __init__(self, tables: dict[str, Table]) -> None:
        super().__init__(tables["summary"])
        self.of = ByRow(tables)

    @property
    def rays(self) -> Table:
        """A row per ray for the judged answers, or for the first form if no answers were given."""
        for row in self.of:
            return self.of[row]  # type: ignore[no-any-return]
        raise AttributeError("the rays were not kept; call lb.judge with rows=True")


class Study(Summarised):
    """Result of `study`, `consistency`, `offsets` or `render`: `.summary`, the rows of summary.csv, and `.frame`."""


class Truths:
    """Result of `truth`: arrays with an item per ray, hit, t, t_lo, primitive, resolved."""

    def __init__(self, table: Table) -> None:
        decision = table["decision"]
        self.hit: NDArray[np.bool_] = decision == 1
        self.resolved: NDArray[np.bool_] = decision != 2
        self.t: NDArray[np.float64] = table.columns["t_hi"].values
        self.t_lo: NDArray[np.float64] = table.columns["t_lo"].values
        self.primitive: NDArray[np.int64] = np.where(self.hit, np.nan_to_num(table["primitive"]), -1).astype(np.int64)

    def __len__(self) -> int:
        return len(self.hit)

    def __repr__(self) -> str:
        return f"<lostbits truths of {len(self)} rays, {int(self.hit.sum())} hits>"


class MeshJudgement(Summarised):
    """Result of `judge_mesh`: `.summary` (one row), `.frame`, and `.rays`, a row for each ray or point (rows=True)."""

    def __init__(self, tables: dict[str, Table]) -> None:
        super().__init__(tables["summary"])
        self.rays = tables.get("rows")


class Hits:
    """Crossings of rays with triangles, one item each, by the ray and then in the exact order of t: ray, place, primitive,
    t, t_lo, front, at_rim. `resolved`: one item for each ray."""

    def __init__(self, tables: dict[str, Table]) -> None:
        crossings = tables["crossings"]
        self.ray: NDArray[np.int64] = crossings["ray"].astype(np.int64)
        self.place: NDArray[np.int64] = crossings["place"].astype(np.int64)
        self.primitive: NDArray[np.int64] = crossings["primitive"].astype(np.int64)
        self.t: NDArray[np.float64] = crossings.columns["t_hi"].values
        self.t_lo: NDArray[np.float64] = crossings.columns["t_lo"].values
        self.front: NDArray[np.bool_] = crossings["front"].astype(bool)
        self.at_rim: NDArray[np.bool_] = crossings["at_rim"].astype(bool)
        self.resolved: NDArray[np.bool_] = tables["rays"]["resolved"].astype(bool)

    def of(self, ray: int) -> slice:
        """The items of one ray: `hits.t[hits.of(7)]`."""
        first, last = np.searchsorted(self.ray, [ray, ray + 1])
        return slice(int(first), int(last))

    def __len__(self) -> int:
        return len(self.ray)

    def __repr__(self) -> str:
        return f"<lostbits hits: {len(self)} crossings of {len(self.resolved)} rays>"


class Inside:
    """Points relative to a mesh, one item a point: inside, winding, crossings, on_surface, resolved.

    `mesh`: counts of its edges and duplicate faces. `inside` is winding != 0 if no edge is unbalanced. Otherwise it is
    an odd number of crossings, which depends on the ray unless mesh["odd"] is 0.
    """

    def __init__(self, tables: dict[str, Table]) -> None:
        points, edges = tables["points"], tables["mesh"]
        self.winding: NDArray[np.int64] = points["winding"].astype(np.int64)
        self.crossings: NDArray[np.int64] = points["crossings"].astype(np.int64)
        self.on_surface: NDArray[np.bool_] = points["on_surface"].astype(bool)
        self.resolved: NDArray[np.bool_] = points["resolved"].astype(bool)
        self.mesh: dict[str, int] = {name: int(edges[name][0]) for name in edges}
        self.inside: NDArray[np.bool_] = (self.winding if self.mesh["unbalanced"] == 0 else self.crossings % 2) != 0

    def __len__(self) -> int:
        return len(self.inside)

    def __repr__(self) -> str:
        return f"<lostbits inside: {int(self.inside.sum())} of {len(self)} points>"


class Sweep(Summarised):
    """Result of `sweep`: `.samples` (a row per form, format and step), `.onsets` (if there is one axis; otherwise
    None), `.frame` and `.plot()`."""

    def __init__(self, tables: dict[str, Table]) -> None:
        super().__init__(tables["samples"])
        self.samples, self.onsets = tables["samples"], tables.get("onsets")

    def plot(self, column: str = "lost_bits_p50") -> Any:
        """A line for each form and format along the first axis, as a matplotlib Figure."""
        name = next(iter(self.samples))
        x, y, forms, formats = (self.samples[k] for k in (name, column, "form", "format"))
        figure = optional("matplotlib.figure").Figure(figsize=(7, 4))
        axis = figure.subplots()
        for form, format in dict.fromkeys(zip(forms, formats)):
            of = (forms == form) & (formats == format)
            axis.plot(x[of], y[of], label=f"{form}, {format}")
        if (x > 0).all() and x.max() > 100 * x.min():
            axis.set_xscale("log", base=2)
        of_axis, of_column = self.samples.columns[name], self.samples.columns[column]
        axis.set(xlabel=f"{name}, {of_axis.unit}" if of_axis.unit else name, ylabel=f"{column}, {of_column.unit}")
        axis.legend(fontsize=8)
        return figure


class Choice(Summarised):
    """Result of `choose`: `.chosen`, (form, format) or None, `.candidates` (`.frame`), `.room`, `.text`."""

    def __init__(self, tables: dict[str, Table], text: str, meets: bool) -> None:
        super().__init__(tables["choose"])
        self.candidates, self.room, self.text = tables["choose"], tables["room"], text
        best = int(np.argmax(self.candidates["chosen"])) if meets else None
        self.chosen = None if best is None else tuple(self.candidates[k][best] for k in ("form", "format"))

    def __repr__(self) -> str:
        return self.text


class Trade:
    """Result of `trade`: `.times`, the rows of trade.csv, `.pareto` (`.frame`), those of pareto.csv, and `.text`."""

    def __init__(self, tables: dict[str, Table], text: str) -> None:
        self.times, self.pareto, self.text = tables["trade"], tables["pareto"], text

    @property
    def frame(self) -> Any:
        """The Pareto table as a pandas.DataFrame."""
        return self.pareto.frame

    def __repr__(self) -> str:
        return self.text


class Mended:
    """Result of `mend`. It prints as the text.

    `.meets`: True if any form meets the requirement. `.operations`: the operations that must be wider, each with its
    `line` in the function's file (None for a form that ships with lostbits). `.forms` (`.frame`): the repaired forms
    and those of the catalogue. `.code`: the form to use, as C++, or None if the form itself is as good.
    """

    def __init__(self, tables: dict[str, Table], texts: list[str], meets: bool, followed: Tape | None) -> None:
        self.forms, self.text, self.meets = tables["mend"], texts[0], meets
        self.code: str | None = texts[1] if len(texts) > 1 else None
        lines = [] if followed is None else [line for _, line in _done(followed)]
        minimal = tables["minimal"]
        self.operations: list[dict[str, Any]] = [
            {"operation": str(text), "line": lines[int(step) - 1] if lines else None}
            for text, step in zip(minimal["operation"], minimal["step"])]

    @property
    def frame(self) -> Any:
        """The forms as a pandas.DataFrame."""
        return self.forms.frame

    def __repr__(self) -> str:
        return self.text


class Explanation:
    """Result of `explain`. It prints as the text.

    `.operations`: a row per operation. `.culprit`: the expression of the operation to blame, such as
    `dot(o - centre, d)`, or None. `.line`: its line in the function's file, or None if there is no culprit or the form
    ships with lostbits. `.json`: everything.
    """

    def __init__(self, text: str, found: dict[str, Any], followed: Tape | None) -> None:
        self.text, self.json = text, found
        self.operations: list[dict[str, Any]] = [{**row, "line": None} for row in found.get("operations", [])]
        if followed is not None:
            _put_lines(self.operations, followed)
        blamed = next((row for row in self.operations if row["name"] == found.get("culprit")), None)
        self.culprit: str | None = None if blamed is None else str(blamed["expression"])
        self.line: int | None = None if blamed is None else blamed["line"]

    @property
    def frame(self) -> Any:
        """The operations as a pandas.DataFrame."""
        return optional("pandas").DataFrame([
            {**row, "computed": row["computed"]["decimal"] if isinstance(row["computed"], dict) else row["computed"]}
            for row in self.operations])

    def __repr__(self) -> str:
        return self.text


def _done(followed: Tape) -> list[tuple[str, Any]]:
    """Name and line of each operation, in order, without inputs and constants."""
    return [(op, line) for (op, _, _), line in zip(followed.ops, followed.lines) if op not in ("input", "constant")]


def _put_lines(operations: list[dict[str, Any]], followed: Tape) -> None:
    """Adds its line to each operation.

    Inputs, constants and operations on constants alone are skipped. The tape has one more input, and splits constants
    in its own way.
    """
    constant, rows = dict[str, bool](), list[dict[str, Any]]()
    for row in operations:
        operands = [constant.get(name, False) for name in row["operands"]]
        constant[row["name"]] = row["operation"] == "constant" or bool(operands) and all(operands)
        if row["operation"] not in ("input", "constant") and not constant[row["name"]]:
            rows.append(row)
    for row, (op, line) in zip(rows, _done(followed)):
        if row["operation"] != op:
            return  # a comparison of constants; the lines of what follows are not known
        row["line"] = line
