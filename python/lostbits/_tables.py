"""Tables of results, whose columns lie in the memory of the library."""

from __future__ import annotations

import ctypes as c
import difflib
import importlib
from typing import Any, Iterator

import numpy as np
from numpy.typing import NDArray

from ._library import ColumnWords, EnvironmentFault, Handle, TableWords, library


def optional(module: str) -> Any:
    """Imports a package that is needed only for a convenience. Raises an EnvironmentFault if it is missing."""
    try:
        return importlib.import_module(module)
    except ImportError:
        package = module.partition(".")[0]
        raise EnvironmentFault(f"{package} is not installed; install it, or use the arrays, which do not need "
                               "it") from None


class Column:
    """A column of a table: `values`, `unit` and `meaning`.

    A missing value is nan among numbers and None among texts and categories.
    """

    def __init__(self, raw: Any, rows: int, keeps: Handle) -> None:
        self.name, self.type, self.unit, self.meaning = (
            text.decode() for text in (raw.name, raw.type, raw.unit, raw.meaning))
        self.codes: NDArray[np.uint8] | None = None
        self.colours: NDArray[np.uint8] | None = None  # red, green and blue of each category, as in pictures
        if raw.categories:
            self.codes = _view(raw.categories, rows, c.c_uint8, keeps)
            self.categories = [raw.names[i].decode() for i in range(raw.name_count)]
            if raw.colours:
                self.colours = _view(raw.colours, 3 * raw.name_count, c.c_uint8, keeps).reshape(-1, 3)
        elif raw.texts:
            texts = [None if text is None else text.decode() for text in raw.texts[:rows]]
            self._kept = np.array(texts, dtype=object)
        else:
            self._kept = _view(raw.numbers, rows, c.c_double, keeps)

    def rename(self, values: NDArray[Any]) -> None:
        """Replaces each text, an index into `values`, by that value."""
        self._kept = np.array([None if text is None else values[int(text)] for text in self._kept], dtype=object)

    @property
    def values(self) -> NDArray[Any]:
        """The values as a numpy array. Integers and booleans become floats if any is missing; categories are texts."""
        if self.codes is not None:
            names = np.array([*self.categories, *[None] * (256 - len(self.categories))], dtype=object)
            return names[self.codes]
        if self.type in ("integer", "boolean") and not np.isnan(self._kept).any():
            return self._kept.astype(bool if self.type == "boolean" else np.int64)
        return self._kept


def _view(address: int | None, rows: int, item: Any, keeps: Handle) -> NDArray[Any]:
    """A read-only array over the memory of a result, without a copy. The array keeps the result alive."""
    if rows == 0 or address is None:
        return np.empty(0, dtype=np.dtype(item))
    memory = (item * rows).from_address(address)
    memory.keeps = keeps
    array = np.frombuffer(memory, dtype=np.dtype(item))
    array.flags.writeable = False
    return array


class Table:
    """Columns of one length, with the names of the program's CSV files: `table["false_miss"]`, `table.frame`."""

    def __init__(self, name: str, columns: dict[str, Column], rows: int) -> None:
        self.name, self.columns, self._rows = name, columns, rows

    def __len__(self) -> int:
        return self._rows

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __getitem__(self, column: str) -> NDArray[Any]:
        if column not in self.columns:
            raise KeyError(self._no(column))
        return self.columns[column].values

    def __getattr__(self, column: str) -> NDArray[Any]:
        if column.startswith("_") or column not in self.__dict__.get("columns", {}):
            raise AttributeError(self._no(column))
        return self[column]

    def _no(self, column: str) -> str:
        names = list(self.__dict__.get("columns", {}))
        near = difflib.get_close_matches(column, names, 3) or names[:8]
        return (f"no column {column!r}; there are {len(names)}, such as {', '.join(near)}. To get the columns of a "
                "metric, name it in the call, as in metrics=[\"lost_bits\", \"culprit\"]")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.columns]

    @property
    def frame(self) -> Any:
        """The table as a pandas.DataFrame."""
        return optional("pandas").DataFrame({name: column.values for name, column in self.columns.items()})

    def __repr__(self) -> str:
        return f"<lostbits table {self.name}: {self._rows} rows of {', '.join(self.columns)}>"


def tables_of(result: Handle) -> dict[str, Table]:
    """All tables of a result, by their names."""
    tables: dict[str, Table] = {}
    table, column = TableWords(), ColumnWords()
    while library.lostbits_result_table(result.pointer, c.c_size_t(len(tables)), c.byref(table)) == 0:
        columns: dict[str, Column] = {}
        for k in range(table.columns):
            library.lostbits_result_column(result.pointer, c.c_size_t(len(tables)), c.c_size_t(k), c.byref(column))
            made = Column(column, table.rows, result)
            columns[made.name] = made
        name = table.name.decode()
        tables[name] = Table(name, columns, table.rows)
    return tables


def texts_of(result: Handle) -> list[str]:
    """All texts of a result."""
    texts: list[str] = []
    while (text := library.lostbits_result_text(result.pointer, c.c_size_t(len(texts)))) is not None:
        texts.append(text.decode())
    return texts
