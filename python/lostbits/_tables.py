"""Tables of results, column by column, in the memory of the library."""

from __future__ import annotations

import ctypes as c
import difflib
from typing import Any, Dict, Iterator, List, Optional

import numpy as np
from numpy.typing import NDArray

from ._library import ColumnWords, EnvironmentFault, Handle, TableWords, library


def _view(address: int, rows: int, item: Any, keeps: Handle) -> NDArray[Any]:
    """The memory of a result as an array, without a copy. The array keeps the result for as long as it lives."""
    if rows == 0:
        return np.empty(0, dtype=np.dtype(item))
    memory = (item * rows).from_address(address)
    memory.keeps = keeps
    array = np.frombuffer(memory, dtype=np.dtype(item))
    array.flags.writeable = False
    return array


class Column:
    """A column of a table: `values` (floats with nan where missing, texts with None, or codes), unit and meaning."""

    def __init__(self, raw: ColumnWords, rows: int, keeps: Handle) -> None:
        self.name, self.type = raw.name.decode(), raw.type.decode()
        self.unit, self.meaning = raw.unit.decode(), raw.meaning.decode()
        self.categories: Optional[List[str]] = None
        self.codes: Optional[NDArray[np.uint8]] = None
        self._texts: Optional[List[Optional[str]]] = None
        if raw.categories:
            self.codes = _view(c.addressof(raw.categories.contents), rows, c.c_uint8, keeps)
            self.categories = [raw.names[i].decode() for i in range(raw.name_count)]
        elif raw.texts:
            self._texts = [None if raw.texts[i] is None else raw.texts[i].decode() for i in range(rows)]
        else:
            self._numbers = _view(c.addressof(raw.numbers.contents) if rows else 0, rows, c.c_double, keeps)

    @property
    def values(self) -> NDArray[Any]:
        """As numpy has them: integers where none is missing, categories as texts."""
        if self.codes is not None and self.categories is not None:
            names = np.array([*self.categories, *[None] * (256 - len(self.categories))], dtype=object)
            return names[self.codes]
        if self._texts is not None:
            return np.array(self._texts, dtype=object)
        if self.type in ("integer", "boolean") and not np.isnan(self._numbers).any():
            return self._numbers.astype(bool if self.type == "boolean" else np.int64)
        return self._numbers


class Table:
    """Columns of one length, as the CSV files of the program have them: `table["false_miss"]`, `table.frame`."""

    def __init__(self, name: str, columns: Dict[str, Column], rows: int) -> None:
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
        return (f"no column {column!r}; there are {len(names)}, such as {', '.join(near)}. Columns of a metric are there "
                "where it was asked for, as in metrics=[\"lost_bits\", \"culprit\"]")

    def __dir__(self) -> List[str]:
        return [*super().__dir__(), *self.columns]

    @property
    def frame(self) -> Any:
        """The table as a pandas.DataFrame."""
        try:
            import pandas
        except ImportError:
            raise EnvironmentFault("pandas is not installed; table['COLUMN'] gives arrays without it") from None
        return pandas.DataFrame({name: self[name] for name in self.columns})

    def __repr__(self) -> str:
        return f"<lostbits table {self.name}: {self._rows} rows of {', '.join(self.columns)}>"


def tables_of(result: Handle) -> Dict[str, Table]:
    """All tables of a result, by their names."""
    tables: Dict[str, Table] = {}
    table, column = TableWords(), ColumnWords()
    while library.lostbits_result_table(result.pointer, len(tables), c.byref(table)) == 0:
        columns: Dict[str, Column] = {}
        for k in range(table.columns):
            library.lostbits_result_column(result.pointer, len(tables), k, c.byref(column))
            made = Column(column, table.rows, result)
            columns[made.name] = made
        name = table.name.decode()
        tables[name] = Table(name, columns, table.rows)
    return tables


def texts_of(result: Handle) -> List[str]:
    """All texts of a result."""
    texts: List[str] = []
    while (text := library.lostbits_result_text(result.pointer, len(texts))) is not None:
        texts.append(text.decode())
    return texts

