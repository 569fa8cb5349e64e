"""Runs the notebooks of the examples as Jupyter does: `notebook.py FILE.ipynb ...` stores their outputs."""

import ast
import base64
import contextlib
import io
import json
import linecache
import sys
from pathlib import Path
from typing import Any


def shown(value: Any) -> dict[str, Any]:
    """Output of a notebook for the value of a cell's last expression: text, and a picture or a table if it has one."""
    data: dict[str, Any] = {"text/plain": repr(value).splitlines(True)}
    if (html := getattr(value, "_repr_html_", None)) is not None and (text := html()) is not None:
        data["text/html"] = text.splitlines(True)
    if (png := getattr(value, "_repr_png_", None)) is not None and (picture := png()) is not None:
        data["image/png"] = base64.b64encode(picture).decode()
    elif (save := getattr(value, "savefig", None)) is not None:  # a figure of matplotlib
        file = io.BytesIO()
        save(file, format="png", bbox_inches="tight")
        data["image/png"] = base64.b64encode(file.getvalue()).decode()
    return data


def run(notebook: dict[str, Any]) -> tuple[list[list[dict[str, Any]]], dict[str, Any]]:
    """Runs the code cells in order. Gives the outputs of each cell in the format of notebooks, and the variables."""
    space: dict[str, Any] = {}
    outputs = []
    for k, cell in enumerate((cell for cell in notebook["cells"] if cell["cell_type"] == "code"), 1):
        text, name = "".join(cell["source"]), f"cell_{k}.py"
        linecache.cache[name] = (len(text), None, text.splitlines(True), name)
        tree = ast.parse(text)
        last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
        printed, value = io.StringIO(), None
        with contextlib.redirect_stdout(printed):
            exec(compile(tree, name, "exec"), space)
            if last is not None:
                value = eval(compile(ast.Expression(last.value), name, "eval"), space)
        found: list[dict[str, Any]] = []
        if printed.getvalue():
            found.append({"output_type": "stream", "name": "stdout", "text": printed.getvalue().splitlines(True)})
        if value is not None:
            found.append({"output_type": "execute_result", "execution_count": k, "metadata": {}, "data": shown(value)})
        outputs.append(found)
    return outputs, space


def main() -> None:
    for file in map(Path, sys.argv[1:]):
        notebook = json.loads(file.read_text(encoding="utf-8"))
        code = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
        for k, (cell, found) in enumerate(zip(code, run(notebook)[0]), 1):
            cell["outputs"], cell["execution_count"] = found, k
        file.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
