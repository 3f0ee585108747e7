"""Puts licences and a list of all libraries into a wheel whose shared libraries were grafted: `licences.py WHEEL FOLDER`.

The libraries and the code of pages come from Debian's packages; maturin lists the crates that the native part is linked of. A part without a licence or a wheel that is too large
ends it.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

HERE = Path(__file__).parent
# With MPI, as in Debian 13, libraries take 27 MB; without, as in Debian 12, 18 MB.
LARGEST = 40_000_000
LICENCE_NAMES = ("licen", "copying", "unlicense", "notice", "copyright")


def told(*command: str | Path) -> str:
    """What a command prints."""
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def packages(grafted: list[str]) -> dict[str, str]:
    """Names and versions of the Debian packages that grafted libraries come from; their names hold eight digits of a hash."""
    loaded = [Path(line.split(" => ")[1]).resolve() for line in told("/sbin/ldconfig", "-p").splitlines() if " => " in line]
    places = {path.name: path for path in loaded}
    found = {}
    for name in grafted:
        path = places[re.sub(r"-[0-9a-f]{8}(?=\.)", "", name)]
        # Packages name files by their places before /lib became a link to /usr/lib.
        files = [str(path), str(path).removeprefix("/usr")]
        lines = subprocess.run(["dpkg", "-S", *files], capture_output=True, text=True).stdout.splitlines()
        if not lines:
            sys.exit(f"{path} belongs to no package of Debian: its licence is not known")
        package = lines[0].split(": ")[0]
        found[package.split(":")[0]] = told("dpkg-query", "-W", "-f", "${Version}", package)
    return found


def embedded() -> dict[str, str]:
    """Versions of the Debian packages whose code the program puts into pages."""
    return {name: told("dpkg-query", "-W", "-f", "${Version}", name) for name in ("libjs-three", "libjs-chart.js")}


def crates() -> Iterator[tuple[str, str]]:
    """Names of the crates that are linked in, and the texts of their licences."""
    manifest = HERE / "Cargo.toml"
    known = json.loads(told("cargo", "metadata", "--locked", "--format-version=1", "--manifest-path", manifest))["packages"]
    tree = told("cargo", "tree", "--locked", "--edges=normal", "--prefix=none", "--format={p}", "--manifest-path", manifest)
    linked = {tuple(line.split()[:2]) for line in tree.splitlines() if line}
    for package in sorted(known, key=lambda package: str(package["name"])):
        name, version = package["name"], package["version"]
        # Packages of this repository have the licences of its root.
        if (name, f"v{version}") not in linked or package["source"] is None:
            continue
        folder = Path(package["manifest_path"]).parent
        files = [file for file in sorted(folder.iterdir()) if file.is_file() and file.name.lower().startswith(LICENCE_NAMES)]
        text = "\n\n".join(file.read_text(encoding="utf-8") for file in files)
        if not text and not package["license"]:
            sys.exit(f"{name} {version} tells no licence")
        yield f"{name} {version}", text or f"{package['license']}: the package holds no text; see https://spdx.org/licenses"


def together(texts: dict[str, list[str]]) -> str:
    """Texts, each once, under the names of those that have it."""
    return "\n\n".join(f"{'=' * 80}\n{', '.join(names)}\n{'=' * 80}\n\n{text.strip()}\n" for text, names in texts.items())


def main(wheel: Path, folder: Path) -> None:
    with tempfile.TemporaryDirectory() as place:
        subprocess.run([sys.executable, "-m", "wheel", "unpack", "--dest", place, wheel], check=True, stdout=subprocess.DEVNULL)
        (root,) = Path(place).iterdir()
        (info,) = root.glob("*.dist-info")
        grafted = [file.name for file in root.glob("*.libs/*")]
        licences = info / "licenses"
        (licences / "debian").mkdir(parents=True)
        component = {"type": "library", "bom-ref": "proboscis", "name": "proboscis", "version": info.name.split("-")[1].removesuffix(".dist")}
        libraries: list[dict[str, Any]] = []
        for name, version in sorted((packages(grafted) | embedded()).items()):
            (licences / "debian" / f"{name}.txt").write_bytes(Path("/usr/share/doc", name, "copyright").read_bytes())
            purl = f"pkg:deb/debian/{name}@{quote(version, safe='')}"
            libraries.append({"type": "library", "bom-ref": purl, "name": name, "version": version, "purl": purl})
        texts: dict[str, list[str]] = {}
        for name, text in crates():
            texts.setdefault(text, []).append(name)
        (licences / "crates.txt").write_text(together(texts), encoding="utf-8")
        for file in HERE.parent.glob("LICENSE-*"):
            (licences / file.name).write_bytes(file.read_bytes())
        sbom = {
            "bomFormat": "CycloneDX",
            "specVersion": "1.5",
            "version": 1,
            "metadata": {"component": component},
            "components": libraries,
            "dependencies": [{"ref": "proboscis", "dependsOn": [library["bom-ref"] for library in libraries]}],
        }
        # In place of that of auditwheel, which misses libraries below /lib.
        (info / "sboms" / "auditwheel.cdx.json").unlink()
        (info / "sboms" / "libraries.cdx.json").write_text(json.dumps(sbom, indent=1), encoding="utf-8")
        metadata = (info / "METADATA").read_text(encoding="utf-8")
        head, gap, body = metadata.partition("\n\n")
        kept = [line for line in head.splitlines() if not line.startswith("License-File:")]
        kept += [f"License-File: {file.relative_to(licences)}" for file in sorted(licences.rglob("*")) if file.is_file()]
        (info / "METADATA").write_text("\n".join(kept) + gap + body, encoding="utf-8")
        folder.mkdir(parents=True, exist_ok=True)
        subprocess.run([sys.executable, "-m", "wheel", "pack", "--dest-dir", folder, root], check=True, stdout=subprocess.DEVNULL)
    made = folder / wheel.name
    size = made.stat().st_size
    print(f"{made}: {size / 1e6:.1f} MB, {len(grafted)} libraries, {len(libraries)} packages of Debian")
    if size > LARGEST:
        made.unlink()
        sys.exit(f"the wheel is larger than {LARGEST / 1e6:.0f} MB")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
