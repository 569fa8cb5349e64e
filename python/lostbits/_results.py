"""What the questions give back."""

from __future__ import annotations

import io
from typing import Any, Dict, Iterator, List, Optional, Tuple

import numpy as np
from numpy.typing import NDArray

from ._library import EnvironmentFault
from ._tables import Table
from ._trace import Tape


def _pyplot() -> Any:
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise EnvironmentFault("matplotlib is not installed; the arrays are there without it") from None
    return Figure


class ByRow:
    """Tables by form and format: `of["sphere.unified", "f32"]`; of a form of one's own, its function's name will do."""

    def __init__(self, tables: Dict[str, Table]) -> None:
        self._tables = tables

    def __getitem__(self, key: Any) -> Any:
        if not (isinstance(key, tuple) and len(key) == 2):
            raise KeyError(f"{key!r}: name a form and a format, as in [\"sphere.unified\", \"f32\"]")
        form = getattr(key[0], "name", key[0])
        for name in (f"{form}.{key[1]}", f"py.{form}.{key[1]}"):
            if name in self._tables:
                return self._tables[name]
        raise KeyError(f"no {form} in {key[1]}; there are {', '.join(map(str, self))}")

    def __iter__(self) -> Iterator[Tuple[str, str]]:
        for name in self._tables:
            form, _, format = name.rpartition(".")
            yield form, format

    def __len__(self) -> int:
        return len(self._tables)

    def __repr__(self) -> str:
        return f"<lostbits tables of {', '.join(self._tables)}>"


class Pixels(Table):
    """A row of a map, pixel by pixel: every column is an array of height x width."""

    def __init__(self, table: Table, size: Tuple[int, int]) -> None:
        super().__init__(table.name, table.columns, len(table))
        self.size = size

    def __getitem__(self, column: str) -> NDArray[Any]:
        return super().__getitem__(column).reshape(self.size[1], self.size[0])

    @property
    def frame(self) -> Any:
        """A pandas.DataFrame with a row a pixel."""
        return Table(self.name, self.columns, len(self)).frame


class Summarised:
    """A table with a row a form and format."""

    def __init__(self, summary: Table) -> None:
        self.summary = summary

    @property
    def frame(self) -> Any:
        """The summary as a pandas.DataFrame."""
        return self.summary.frame


class Map(Summarised):
    """What `map` found: `.summary`, `.frame`, `.pixels[form, format]`; in a notebook it is a picture."""

    def __init__(self, tables: Dict[str, Table], size: Tuple[int, int]) -> None:
        super().__init__(tables["summary"])
        self.size = size
        rest = {name: Pixels(table, size) for name, table in tables.items() if name != "summary"}
        self.pixels = ByRow(rest)  # type: ignore[arg-type]

    def figure(self, column: str = "lost_bits") -> Any:
        """A picture a form and format, of one range, as a matplotlib Figure; grey: no agreed hit."""
        rows = list(self.pixels)
        images = [np.asarray(self.pixels[row][column], dtype=float) for row in rows]
        figure = _pyplot()(figsize=(3 * len(rows) + 0.8, 3.4))
        top = max((float(np.nanmax(i)) for i in images if np.isfinite(i).any()), default=1.0)
        axes = figure.subplots(1, len(rows), squeeze=False)[0]
        for axis, (form, format), image in zip(axes, rows, images):
            axis.set_facecolor("0.85")
            shown = axis.imshow(image, vmin=0, vmax=max(top, 1e-9), interpolation="nearest")
            axis.set_title(f"{form}, {format}", fontsize=9)
            axis.set_xticks([]), axis.set_yticks([])
        figure.colorbar(shown, ax=list(axes), label=self._unit(column), shrink=0.8)
        return figure

    def _unit(self, column: str) -> str:
        for row in self.pixels:
            return f"{column} ({self.pixels[row].columns[column].unit})"
        return column

    def _repr_png_(self) -> Optional[bytes]:
        if len(self.pixels) == 0:
            return None
        try:
            out = io.BytesIO()
            self.figure().savefig(out, format="png", dpi=100, bbox_inches="tight")
            return out.getvalue()
        except EnvironmentFault:
            return None

    def __repr__(self) -> str:
        return f"<lostbits map, {self.size[0]} x {self.size[1]}, of " + ", ".join(
            f"{form} in {format}" for form, format in zip(self.summary["form"], self.summary["format"])) + ">"


class Judgement(Summarised):
    """What `judge` found: `.summary`, `.frame`, `.rays` (the answers that were judged, a row a ray), `.of[form,
    format]`."""

    def __init__(self, tables: Dict[str, Table]) -> None:
        super().__init__(tables["summary"])
        self.of = ByRow({name: table for name, table in tables.items() if name != "summary"})

    @property
    def rays(self) -> Table:
        """Of the answers, or of the first form where there are none."""
        for row in self.of:
            return self.of[row]  # type: ignore[no-any-return]
        raise AttributeError("rays were not asked for: rows=True keeps them")

    def __repr__(self) -> str:
        return f"<lostbits judgement of {', '.join(self.summary['form'])}>"


class Truths:
    """Certified truths, an item a ray: hit, t, t_lo, solid, resolved."""

    def __init__(self, table: Table) -> None:
        decision = table["decision"]
        self.hit: NDArray[np.bool_] = decision == 1
        self.resolved: NDArray[np.bool_] = decision != 2
        self.t: NDArray[np.float64] = table.columns["t_hi"].values
        self.t_lo: NDArray[np.float64] = table.columns["t_lo"].values
        self.solid: NDArray[np.int64] = np.where(self.hit, np.nan_to_num(table["solid"]), -1).astype(np.int64)

    def __len__(self) -> int:
        return len(self.hit)

    def __repr__(self) -> str:
        return f"<lostbits truths of {len(self)} rays, {int(self.hit.sum())} hits>"


class Sweep:
    """What `sweep` found: `.samples` (a row a form, format and step), `.onsets` (of one axis), `.frame`, `.plot()`."""

    def __init__(self, tables: Dict[str, Table]) -> None:
        self.samples, self.onsets = tables["samples"], tables.get("onsets")

    @property
    def frame(self) -> Any:
        """The samples as a pandas.DataFrame."""
        return self.samples.frame

    def plot(self, column: str = "lost_bits_p50") -> Any:
        """A line a form and format along the first axis, as a matplotlib Figure."""
        axis_name = next(iter(self.samples))
        x, y = self.samples[axis_name], self.samples[column]
        figure = _pyplot()(figsize=(7, 4))
        axis = figure.subplots()
        forms, formats = self.samples["form"], self.samples["format"]
        for form, format in dict.fromkeys(zip(forms, formats)):
            of = (forms == form) & (formats == format)
            axis.plot(x[of], y[of], label=f"{form}, {format}")
        if (x > 0).all() and x.max() > 100 * x.min():
            axis.set_xscale("log", base=2)
        unit = self.samples.columns[axis_name].unit
        axis.set_xlabel(f"{axis_name}, {unit}" if unit else axis_name)
        axis.set_ylabel(f"{column}, {self.samples.columns[column].unit}")
        axis.legend(fontsize=8)
        return figure

    def __repr__(self) -> str:
        return f"<lostbits sweep of {len(self.samples)} samples>"


class Explanation:
    """What `explain` found. Printed, it is the text; `.operations` are rows of the operations, `.culprit` the
    one to blame (None where none is), `.json` everything."""

    def __init__(self, text: str, found: Dict[str, Any], followed: Optional[Tape]) -> None:
        self.text, self.json = text, found
        self._blamed: Optional[str] = found.get("culprit")
        self.operations: List[Dict[str, Any]] = [dict(row) for row in found.get("operations", [])]
        for row in self.operations:
            row["line"] = None
        if followed is not None:
            _put_lines(self.operations, followed)

    @property
    def culprit(self) -> Optional[str]:
        """What it computes: `dot(o - centre, d)`."""
        row = self._row()
        return None if row is None else str(row["expression"])

    def _row(self) -> Optional[Dict[str, Any]]:
        return next((row for row in self.operations if row["name"] == self._blamed), None)

    @property
    def line(self) -> Optional[int]:
        """The line of the function's file that did the culprit; None where there is none, or the form ships."""
        row = self._row()
        return None if row is None else row["line"]

    @property
    def frame(self) -> Any:
        """The operations as a pandas.DataFrame."""
        try:
            import pandas
        except ImportError:
            raise EnvironmentFault("pandas is not installed; .operations are the same rows without it") from None
        frame = pandas.DataFrame(self.operations)
        frame["computed"] = [row["computed"]["decimal"] if isinstance(row["computed"], dict) else row["computed"]
                             for row in self.operations]
        return frame

    def __repr__(self) -> str:
        return self.text


def _put_lines(operations: List[Dict[str, Any]], followed: Tape) -> None:
    """Where each operation was done. The tape has one more input, and constants in pieces of their own."""
    constant: Dict[str, bool] = {}
    rows = []
    for row in operations:
        operands = [constant.get(name, False) for name in row["operands"]]
        constant[row["name"]] = row["operation"] == "constant" or bool(operands) and all(operands)
        if row["operation"] not in ("input", "constant") and not constant[row["name"]]:
            rows.append(row)
    done = [(op, line) for (op, _, _), line in zip(followed.ops, followed.lines) if op not in ("input", "constant")]
    for row, (op, line) in zip(rows, done):
        if row["operation"] != op:
            return  # a comparison of constants, behind which places are not known
        row["line"] = line


class Choice:
    """What `choose` found: `.chosen`, `.candidates`, `.room`, `.text`."""

    def __init__(self, tables: Dict[str, Table], text: str, meets: bool) -> None:
        self.candidates, self.room, self.text = tables["choose"], tables["room"], text
        self.chosen: Optional[Tuple[str, str]] = None
        if meets:
            i = int(np.argmax(self.candidates["chosen"]))
            self.chosen = (self.candidates["form"][i], self.candidates["format"][i])

    @property
    def frame(self) -> Any:
        """The candidates as a pandas.DataFrame."""
        return self.candidates.frame

    def __repr__(self) -> str:
        return self.text
