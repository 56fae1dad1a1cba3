#!/usr/bin/env python3
"""Prints what a built program consists of, as a software bill of materials (CycloneDX 1.5, JSON): the Debian packages of
the libraries that it is linked with, directly or by others, and the npm packages that are built into the page.

    tools/sbom.py build/victorious > victorious.cdx.json
"""

import json
import re
import subprocess
import sys
from pathlib import Path
from urllib.parse import quote

ROOT = Path(__file__).resolve().parent.parent


def linked_libraries(program: str) -> list[str]:
    """The files that the dynamic linker loads for it."""
    listed = subprocess.run(["ldd", program], check=True, capture_output=True, text=True).stdout
    return sorted(set(re.findall(r"(/\S+) \(0x", listed)))


def packages_of(files: list[str]) -> set[str]:
    """The installed Debian packages that have them. What no package has is an error: it would be left out in silence."""
    # dpkg knows a file by one of its paths: /lib is a link to /usr/lib.
    paths = {file: {file, str(Path(file).resolve())} for file in files}
    paths = {file: names | {name.removeprefix("/usr") for name in names} for file, names in paths.items()}
    asked = sorted(set().union(*paths.values()))
    found = subprocess.run(["dpkg-query", "--search", *asked], capture_output=True, text=True, check=False).stdout
    package_of = {}
    for line in found.splitlines():
        packages, _, path = line.rpartition(": ")
        package_of[path] = packages.split(", ")[0]
    unknown = [file for file, names in paths.items() if not names & package_of.keys()]
    if unknown:
        sys.exit(f"of no package: {', '.join(unknown)}")
    return {package_of[name] for names in paths.values() for name in names if name in package_of}


def debian_components(packages: set[str]) -> list[dict]:
    form = "--showformat=${Package}\t${Version}\t${Architecture}\t${source:Package}\n"
    shown = subprocess.run(["dpkg-query", "--show", form, *sorted(packages)], check=True, capture_output=True, text=True)
    components = []
    for line in shown.stdout.splitlines():
        name, version, architecture, source = line.split("\t")
        components.append({
            "type": "library",
            "name": name,
            "version": version,
            "purl": f"pkg:deb/debian/{name}@{quote(version)}?arch={architecture}",
            "properties": [{"name": "debian:source", "value": source}],
        })  # fmt: skip
    return components


def npm_components(lock: Path) -> list[dict]:
    """Those that are part of the page, not the ones that only build it."""
    components = []
    for path, package in json.loads(lock.read_text())["packages"].items():
        if not path or package.get("dev") or package.get("link"):
            continue
        name = path.rpartition("node_modules/")[2]
        component = {"type": "library", "name": name, "version": package["version"]}
        component["purl"] = f"pkg:npm/{quote(name)}@{package['version']}"
        if license_id := package.get("license"):
            component["licenses"] = [{"expression": license_id}]
        components.append(component)
    return components


def main() -> None:
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    debian = debian_components(packages_of(linked_libraries(sys.argv[1])))
    version = re.search(r"VERSION (\d+\.\d+\.\d+)", (ROOT / "CMakeLists.txt").read_text())[1]
    bill = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {"component": {"type": "application", "name": "victorious", "version": version}},
        "components": debian + npm_components(ROOT / "web" / "package-lock.json"),
    }
    json.dump(bill, sys.stdout, indent=2)
    print()


if __name__ == "__main__":
    main()
