"""Writes what the package knows of entries from the JSON Schema of problems: `entries.py`, `parts.py` and `_questions.py`.

    python python/generate.py    after the schema has changed and the package was installed; a test compares the files with what this makes
"""

from __future__ import annotations

import json
import keyword
import re
import sys
import textwrap
from pathlib import Path
from typing import Any

PLACE = Path(__file__).parent / "proboscis"
WIDTH = 150
NOTE = "Written by `python/generate.py` from the JSON Schema of problems."

#: Parts by the entry of the scene that lists them: the class, the word that names are made of.
PARTS = {
    "materials": ("Material", "material"),
    "bodies": ("Body", "body"),
    "joints": ("Joint", "joint"),
    "muscles": ("Muscle", "muscle"),
    "solids": ("Solid", "solid"),
    "springs": ("Spring", "spring"),
    "tendons": ("Tendon", "tendon"),
    "shapes": ("ContactShape", "shape"),
    "contacts": ("Contact", "contact"),
    "loads": ("Load", "load"),
    "markers": ("Marker", "marker"),
}
QUESTIONS = {
    "control": "Returns the optimal control problem with these entries of `control` in a problem file.",
    "simulate": "Simulates with these entries of `simulate` in a problem file; the others are those of `Problem.simulate`.",
    "equilibrium": "Finds the state of rest with these entries of `equilibrium` in a problem file; the others are those of `Problem.equilibrium`.",
    "identify": "Fits constants with these entries of `identify` in a problem file; the others are those of `Problem.identify`.",
}

Schema = dict[str, Any]


class Types:
    """Python types of the definitions of a schema."""

    def __init__(self, schema: Schema) -> None:
        self.definitions: dict[str, Schema] = schema["$defs"]
        self.names = self._named()

    def _named(self) -> dict[str, str]:
        """Names of classes by definition; definitions that differ in units alone are one class."""
        names = {name: re.sub(r"(Spec|Document)(\d*)$", r"\2", name) for name in self.definitions}
        while True:
            self.names = names
            bodies: dict[tuple[str, str], str] = {}
            merged = {}
            for definition, name in names.items():
                stem = name.rstrip("0123456789")
                body = re.sub(r"(?m)^\s+\"\"\".*?\"\"\"$", "", "\n".join(self.definition(definition, stem)), flags=re.DOTALL)
                merged[definition] = bodies.setdefault((stem, re.sub(r"([A-Za-z])\d\b", r"\1", body)), name)
            if merged == names:
                return names
            names = merged

    def of(self, schema: Schema, place: str = "") -> str:
        """The type of a value; where nothing stands is none of it."""
        if "$ref" in schema:
            name = schema["$ref"].rsplit("/", 1)[-1]
            return "Quantity" if self._is_quantity(self.definitions[name]) else place + self.names[name]
        for key in ("anyOf", "oneOf"):
            if key in schema:
                return self._union([self.of(one, place) for one in schema[key] if one.get("type") != "null"])
        if "const" in schema:
            return f'Literal["{schema["const"]}"]'
        if "enum" in schema:
            return f"Literal[{', '.join(json.dumps(one) for one in schema['enum'])}]"
        kinds = schema.get("type", [])
        kinds = kinds if isinstance(kinds, list) else [kinds]
        if set(kinds) - {"null"} == {"number", "string"}:
            return "Quantity"
        return self._union([self._plain(kind, schema, place) for kind in kinds if kind != "null"]) if kinds else "Any"

    def _plain(self, kind: str, schema: Schema, place: str) -> str:
        if kind == "array":
            item = schema.get("items", {})
            entry = self.of(item, place)
            kinds = [one.get("type") for one in item.get("anyOf", [])]
            entry += " | None" if "null" in kinds or "null" in item.get("type", []) else ""
            numbers = " | Numbers" if entry.split(" | ")[0] in ("Quantity", "float", "int") else ""
            return f"Sequence[{entry}]{numbers}"
        if kind == "object":
            entries = schema.get("additionalProperties")
            return f"Mapping[Any, {self.of(entries, place)}]" if isinstance(entries, dict) else "Mapping[str, Any]"
        return {"integer": "int", "number": "float", "boolean": "bool", "string": "Text"}[kind]

    @staticmethod
    def _is_quantity(schema: Schema) -> bool:
        return schema.get("type") == ["number", "string"]

    @staticmethod
    def _union(kinds: list[str]) -> str:
        words = [kind for kind in dict.fromkeys(kinds) if kind.startswith("Literal[")]
        if len(words) > 1:
            literal = f"Literal[{', '.join(word[len('Literal[') : -1] for word in words)}]"
            kinds = [literal, *(kind for kind in kinds if kind not in words)]
        return " | ".join(dict.fromkeys(kinds))

    def definition(self, name: str, called: str) -> list[str]:
        """Lines that define a type."""
        schema = self.definitions[name]
        told = schema.get("description", "")
        if "properties" not in schema and not (schema.get("type") == "object" and schema.get("additionalProperties") is False):
            kind = self.of(schema)
            return [f'{called}: TypeAlias = "{escaped(kind)}"', *document(told, "")]
        required = schema.get("required", [])
        properties = schema.get("properties", {})
        if any(keyword.iskeyword(key) for key in properties):
            lines = [f"{called} = TypedDict(", f'    "{called}",', "    {"]
            for key, entry in properties.items():
                lines.append(f'        "{key}": "{escaped(self._entry(entry, key in required))}",')
            return [*lines, "    },", ")", *document(told, "")]
        lines = [f"class {called}(TypedDict):", *document(told, "    ")]
        for key, entry in properties.items():
            lines += ["", f"    {key}: {self._entry(entry, key in required)}", *document(entry.get("description", ""), "    ")]
        return lines

    def _entry(self, schema: Schema, is_required: bool) -> str:
        kind = self.of(schema)
        return kind if is_required else f"NotRequired[{kind}]"


def escaped(text: str) -> str:
    return text.replace('"', "'")


def document(text: str, indent: str) -> list[str]:
    """The lines of a docstring."""
    text = " ".join(text.split("\n")) if "\n\n" not in text else text
    paragraphs = [textwrap.wrap(" ".join(part.split()), WIDTH - len(indent) - 6) for part in text.split("\n\n")]
    lines = [line for paragraph in paragraphs for line in [*paragraph, ""]][:-1]
    if not lines or not lines[0]:
        return []
    lines = [line.replace("\\", "\\\\") for line in lines]
    if len(lines) == 1:
        return [f'{indent}"""{lines[0]}"""']
    return [f'{indent}"""{lines[0]}', *(f"{indent}{line}" if line else "" for line in lines[1:]), f'{indent}"""']


def used(types: Types, schema: Schema, roots: list[str]) -> list[str]:
    """Definitions that are reached from others, in their order."""
    found: dict[str, None] = {}

    def visit(value: Any) -> None:
        if isinstance(value, dict):
            name = value.get("$ref", "").rsplit("/", 1)[-1]
            if name and name not in found:
                found[name] = None
                visit(types.definitions[name])
            for one in value.values():
                visit(one)
        elif isinstance(value, list):
            for one in value:
                visit(one)

    for root in roots:
        visit(types.definitions[root])
    return [name for name in types.definitions if name in found]


def entries(types: Types, schema: Schema) -> str:
    """`entries.py`: a type for each object of the files."""
    lines = [
        f'"""Types of the entries of scenes and problems, to annotate and to complete dicts with.\n\n{NOTE}\n"""',
        "",
        "from __future__ import annotations",
        "",
        "from collections.abc import Mapping, Sequence",
        "from os import PathLike",
        "from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypedDict",
        "",
        "import numpy as np",
        "import numpy.typing as npt",
        "",
        "if TYPE_CHECKING:",
        "    from typing_extensions import NotRequired",
        "",
        "    from proboscis._part import Part",
        "",
        'Quantity: TypeAlias = "float | str | np.number[Any]"',
        '"""A number in SI units, or a text with a unit."""',
        'Numbers: TypeAlias = "npt.NDArray[Any]"',
        '"""An array in place of a list of numbers."""',
        'Text: TypeAlias = "str | Part | PathLike[str]"',
        '"""A text; a part stands for its name, a result for its folder."""',
    ]
    written: set[str] = set()
    for name in used(types, schema, [*PART_SPECS.values(), *SPECS.values(), *APART.values()]):
        called = types.names[name]
        if types._is_quantity(types.definitions[name]) or called in written or name in (*SPECS.values(), *APART.values()):
            continue
        written.add(called)
        lines += ["", "", *types.definition(name, called)]
    for spec in (*SPECS.values(), *APART.values()):
        lines += ["", "", *types.definition(spec, types.names[spec])]
    return "\n".join(lines) + "\n"


def parameters(types: Types, schema: Schema, skipped: tuple[str, ...] = ()) -> list[tuple[str, str, str, str, bool]]:
    """Keyword, entry, type, description and whether it has to be given, of each entry; those that have to first."""
    required = schema.get("required", [])
    found = []
    for key, entry in schema["properties"].items():
        if key in skipped or key.startswith("$"):
            continue
        word = f"{key}_" if keyword.iskeyword(key) else key
        found.append((word, key, types.of(entry, "entries."), entry.get("description", ""), key in required))
    return sorted(found, key=lambda one: not one[4])


def listed(chosen: list[tuple[str, str, str, str, bool]], indent: str) -> list[str]:
    """What keywords mean, as a list."""
    lines = []
    for word, _, _, told, _ in chosen:
        text = " ".join(told.split()).replace("\\", "\\\\")
        lines += textwrap.wrap(f"* `{word}`: {text}", WIDTH - len(indent), initial_indent=indent, subsequent_indent=f"{indent}  ")
    return lines


def signature(chosen: list[tuple[str, str, str, str, bool]]) -> list[str]:
    """Keyword parameters."""
    return [f"        {word}: {kind}," if has_to else f"        {word}: {kind} | None = None," for word, _, kind, _, has_to in chosen]


def given(chosen: list[tuple[str, str, str, str, bool]], indent: str) -> list[str]:
    """A dict of what was given."""
    return [f'{indent}"{key}": {word},' for word, key, _, _, _ in chosen]


HEAD = [
    "",
    "from __future__ import annotations",
    "",
]


def parts(types: Types, schema: Schema) -> str:
    """`parts.py`: a class for each kind of part."""
    lines = [
        f'"""What a system is made of: thin names for the entries of a scene file.\n\nNumbers are in SI units, texts have a unit. Positions and axes '
        "are given in the reference configuration, in the ground frame. Where JSON\nwants a name, the part itself may stand; a keyword of Python "
        f'has an underscore behind it (`from_`).\n\n{NOTE}\n"""',
        *HEAD,
        "from collections.abc import Mapping, Sequence",
        "from typing import TYPE_CHECKING, Any, Literal",
        "",
        "from proboscis._part import GROUND, Part",
        "",
        "if TYPE_CHECKING:",
        "    from proboscis import entries",
        "    from proboscis.entries import Numbers, Quantity, Text",
        "",
        f'__all__ = ["GROUND", "Part", {", ".join(json.dumps(one) for one, _ in PARTS.values())}]',
    ]
    for key, (called, noun) in PARTS.items():
        spec = types.definitions[PART_SPECS[key]]
        chosen = parameters(types, spec, ("name",))
        lines += ["", "", f"class {called}(Part):"]
        told = document(spec["description"], "    ")
        lines += told[:-1] + ([told[-1].removesuffix('"""')] if len(told) == 1 else [""])
        lines += ["", *listed(chosen, "    "), '    """', "", f'    kind, noun = "{key}", "{noun}"', ""]
        lines += ["    def __init__(", "        self,", "        name: str | None = None,", "        *,", *signature(chosen), "    ) -> None:"]
        lines += ["        super().__init__(", "            name,", "            {", *given(chosen, "                "), "            },", "        )"]
    return tidy(lines)


def tidy(lines: list[str]) -> str:
    """Text without empty lines one after the other within a docstring."""
    return re.sub(r"\n\n\n(?=    )", "\n\n", "\n".join(lines)) + "\n"


def questions(types: Types, schema: Schema) -> str:
    """`_questions.py`: what a system is asked, and its own entries."""
    lines = [
        f'"""Keyword arguments of a system and of what it is asked.\n\n{NOTE}\n"""',
        *HEAD,
        "from collections.abc import Callable, Mapping, Sequence",
        "from os import PathLike",
        "from typing import TYPE_CHECKING, Any, Literal",
        "",
        "if TYPE_CHECKING:",
        "    from proboscis import entries",
        "    from proboscis.entries import Numbers, Quantity, Text",
        "    from proboscis.problem import Problem, Step",
        "    from proboscis.result import Result",
        "",
        "",
        "class Questions:",
        '    """What a system is made with, and what it is asked."""',
        "",
        "    __slots__ = ()",
        "",
        "    def _begin(self, name: str, folder: str | PathLike[str], scene: dict[str, Any]) -> None:",
        "        raise NotImplementedError",
        "",
        "    def _problem(self, task: str, asked: dict[str, Any]) -> Problem:",
        "        raise NotImplementedError",
    ]
    chosen = parameters(types, SCENE, ("name", *PARTS))
    lines += ["", "    def __init__(", "        self,", "        name: str,", "        /,", "        *,"]
    lines += ['        folder: str | PathLike[str] = ".",', *signature(chosen), "    ) -> None:"]
    lines += ['        """A scene with a name, to which parts are added; `folder` is where files that it names are looked for.', ""]
    lines += [*listed(chosen, "        "), '        """']
    lines += ["        self._begin(", "            name,", "            folder,", "            {", *given(chosen, "                "), "            },", "        )"]
    runs = {
        "control": ([], "Problem", "{}"),
        "simulate": (
            ["output: str | PathLike[str] | None = None", "on_step: Callable[[Step], object] | None = None", "max_seconds: float | None = None"],
            "Result",
            "{}.simulate(output=output, on_step=on_step, max_seconds=max_seconds)",
        ),
        "equilibrium": (
            ["output: str | PathLike[str] | None = None", "max_seconds: float | None = None"],
            "Result",
            "{}.equilibrium(output=output, max_seconds=max_seconds)",
        ),
        "identify": (
            ["output: str | PathLike[str] | None = None", "max_seconds: float | None = None"],
            "Result",
            "{}.identify(output=output, max_seconds=max_seconds)",
        ),
    }
    for task, told in QUESTIONS.items():
        others, answer, run = runs[task]
        chosen = parameters(types, types.definitions[SPECS[task]])
        lines += ["", f"    def {task}(", "        self,", "        *,", *signature(chosen)]
        lines += [*(f"        {one}," for one in others), f"    ) -> {answer}:"]
        lines += [f'        """{told}', "", *listed(chosen, "        "), '        """']
        lines += ["        problem = self._problem(", f'            "{task}",', "            {", *given(chosen, "                "), "            },", "        )"]
        lines += [f"        return {run.format('problem')}"]
    return "\n".join(lines) + "\n"


PART_SPECS: dict[str, str] = {}
SPECS: dict[str, str] = {}
APART: dict[str, str] = {}
SCENE: Schema = {}


def reference(schema: Schema) -> str:
    """The definition that an entry is one of, or is a list or map of."""
    for one in (schema, *schema.get("anyOf", []), schema.get("items", {}), schema.get("additionalProperties", {})):
        if isinstance(one, dict) and "$ref" in one:
            return str(one["$ref"].rsplit("/", 1)[-1])
    raise ValueError(f"no definition in {schema}")


def files(scene: Schema, problem: Schema) -> dict[str, str]:
    """Names and texts of all files."""
    SCENE.clear()
    SCENE.update(scene)
    for key in PARTS:
        PART_SPECS[key] = reference(scene["properties"][key])
    for key in QUESTIONS:
        SPECS[key] = reference(problem["properties"][key])
    APART["chain"] = reference(scene["properties"]["chain"])
    for key in ("output", "feedback"):
        APART[key] = reference(problem["properties"][key])
    types = Types({"$defs": {**scene["$defs"], **problem["$defs"]}})
    return {"entries.py": entries(types, problem), "parts.py": parts(types, scene), "_questions.py": questions(types, problem)}


def main() -> None:
    # The installed package is meant, which has the native part.
    sys.path = [place for place in sys.path if Path(place).resolve() != Path(__file__).parent.resolve()]
    from proboscis import _proboscis

    scene, problem = _proboscis.schema()
    for name, text in files(json.loads(scene), json.loads(problem)).items():
        (PLACE / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
