#!/usr/bin/python3
"""The scene schema accepts every committed scene and the documented example, refuses what the reader refuses
(refusals.json, as far as a schema can tell), and the committed generators reproduce the committed files.

    tests/scenes/validate_schema.py        exit 0: all well, 1: not

Needs python3-jsonschema; without it the schema is not checked, which the last line then says.
"""

import copy
import json
import pathlib
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SCENES = SOURCE / "scenes"
failures = []


def check(holds, what):
    if not holds:
        failures.append(what)


def patched(document, patch):
    """A JSON patch (RFC 6902) of add, replace and remove."""
    root = {"": copy.deepcopy(document)}
    for step in patch:
        *way, last = [token.replace("~1", "/").replace("~0", "~") for token in step["path"].split("/")]
        parent = root
        for token in way:
            parent = parent[int(token) if isinstance(parent, list) else token]
        if isinstance(parent, list):
            last = len(parent) if last == "-" else int(last)
        if step["op"] == "remove":
            del parent[last]
        elif isinstance(parent, list) and step["op"] == "add":
            parent.insert(last, step["value"])
        else:
            parent[last] = step["value"]
    return root[""]


def check_generators():
    for script, output in (("make_paper.py", "paper.json"), ("make_many_lights.py", "many_lights.json"),
                           ("textures/make_map.py", "textures/map.png"), ("textures/make_sky.py", "textures/sky.exr")):
        made = subprocess.run([sys.executable, SCENES / script], check=True, capture_output=True).stdout
        check(made == (SCENES / output).read_bytes(), f"scenes/{script} does not reproduce scenes/{output}")


def check_schema(jsonschema):
    schema = json.loads((SCENES / "scene.schema.json").read_text())
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)

    scenes = [path for path in sorted(SCENES.rglob("*.json")) if not path.name.endswith(".schema.json")]
    check(len(scenes) >= 8, f"only {len(scenes)} scenes found")
    for path in scenes:
        text = path.read_bytes()
        check(text.isascii(), f"{path.name}: must be ASCII, since the build embeds it byte by byte")
        scene = json.loads(text)
        for error in validator.iter_errors(scene):
            failures.append(f"{path.name}: {error.message[:200]}")
        check((path.parent / scene.get("$schema", "")).is_file(), f"{path.name}: $schema must lead to the schema")

    with tempfile.TemporaryDirectory() as folder:
        for kind in ("spheres", "quads", "cluster"):
            made = pathlib.Path(folder) / "made.json"
            subprocess.run([SCENES / "generate", "200", kind, "-o", made], check=True)
            check(validator.is_valid(json.loads(made.read_text())), f"scenes/generate: {kind} do not fit the schema")

    document = (SOURCE / "docs/scene-format.md").read_text()
    example = json.loads(document.split("```json\n")[1].split("```")[0])
    check(validator.is_valid(example), "the example of docs/scene-format.md does not fit the schema")

    shared = json.loads((SOURCE / "tests/scenes/refusals.json").read_text())
    check(validator.is_valid(shared["base"]), "the base of refusals.json does not fit the schema")
    for case in shared["cases"]:
        refused = not validator.is_valid(patched(shared["base"], case["patch"]))
        check(refused == case["schema_refuses"], f"the schema {'refuses' if refused else 'accepts'} {case['patch']}")
    return f"{len(scenes)} scenes and {len(shared['cases'])} refusals checked against the schema"


def main():
    check_generators()
    try:
        import jsonschema
    except ImportError:
        summary = "SKIPPED the schema: python3-jsonschema is not installed"
    else:
        summary = check_schema(jsonschema)
    for failure in failures:
        print(f"FAILED: {failure}")
    print(summary)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
