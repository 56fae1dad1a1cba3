"""The installed library: a program of its own, built by CMake and by pkg-config, finds what the command line finds."""

import os
import re
import shutil
import subprocess
import unittest
from pathlib import Path

import program

BUILD = program.PROGRAM.parent
SOURCES = program.REPOSITORY / "examples" / "installed"


def output(*command, **options) -> str:
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=program.TIMEOUT_S,
                          check=False, **options)  # fmt: skip
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


class LibraryTest(program.ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.folder = program.folder_until_exit()
        for component in ("program", "library", "dev"):
            output("cmake", "--install", BUILD, "--prefix", cls.folder / "first", "--component", component)
        # Nothing of it holds the folder into which it was installed.
        cls.prefix = cls.folder / "prefix"
        (cls.folder / "first").rename(cls.prefix)
        (cls.pkg_config,) = cls.prefix.rglob("pkgconfig")
        cls.libraries = cls.pkg_config.parent

    def configure(self, name: str, *flags) -> subprocess.CompletedProcess:
        command = ["cmake", "-S", SOURCES, "-B", self.scratch / name, f"-DCMAKE_PREFIX_PATH={self.prefix}", *flags]
        return subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)

    def test_consumers_list_what_the_command_line_lists(self):
        done = self.configure("by_cmake")
        self.assertEqual(done.returncode, 0, done.stderr)
        output("cmake", "--build", self.scratch / "by_cmake")
        environment = os.environ | {"PKG_CONFIG_PATH": str(self.pkg_config)}
        flags = output("pkg-config", "--cflags", "--libs", "victorious", env=environment).split()
        self.assertEqual(output("pkg-config", "--modversion", "victorious", env=environment).strip(),
                         self.succeeds("--version").out.split()[-1])  # fmt: skip
        strict = ["-std=c++17", "-Wall", "-Wextra", "-pedantic", "-Werror"]
        output("g++", *strict, SOURCES / "list_finds.cc", *flags, f"-Wl,-rpath,{self.libraries}", "-o",
               self.scratch / "by_pkg_config")  # fmt: skip

        video, models = program.make_placed_flight(self.scratch)
        db = self.scratch / "command.db"
        self.succeeds("index", video, "--models", models, "--db", db)
        expected = []
        for row in self.succeeds("search", "--db", db, "--json").rows():
            self.assertIsNotNone(row["latitude_deg"], row)
            expected.append((row["model"], row["score"], row["latitude_deg"], row["longitude_deg"], row["ce90_m"]))
        self.assertEqual([row[0] for row in expected], ["jeep"])
        for consumer in ("by_cmake/list_finds", "by_pkg_config"):
            own = self.scratch / f"{Path(consumer).name}.db"
            lines = output(self.scratch / consumer, video, models, own).splitlines()
            found = [(line.split()[0], *map(float, line.split()[1:])) for line in lines]
            self.assertEqual(found, expected, consumer)
            self.assertEqual(self.export(own, "sightings"), self.export(db, "sightings"))
        refused = subprocess.run([self.scratch / "by_pkg_config", "none.mp4", models, db], capture_output=True,
                                 text=True, check=False)  # fmt: skip
        self.assertEqual((refused.returncode, refused.stdout), (1, ""))
        self.assertRegex(refused.stderr, r"^list_finds: none\.mp4: .*\n$")

    def test_another_version_is_refused(self):
        shutil.copytree(SOURCES, self.scratch / "other")
        lists = self.scratch / "other" / "CMakeLists.txt"
        lists.write_text(lists.read_text().replace("Victorious 0.1", "Victorious 99.0"))
        command = ["cmake", "-S", self.scratch / "other", "-B", self.scratch / "b", f"-DCMAKE_PREFIX_PATH={self.prefix}"]
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("99.0", done.stderr)

    def test_exports_its_own_names_alone(self):
        (library,) = self.libraries.glob("libvictorious.so.*.*.*")
        listed = [line.split() for line in output("nm", "-D", "--defined-only", library).splitlines()]
        symbols = [name for _, kind, name in listed if kind != "A"]  # that of the version
        self.assertGreater(len(symbols), 50)
        for symbol in symbols:
            self.assertRegex(symbol, r"^_Z(NK?|T[ISV]N)13libvictorious")
        headers = sorted(path.name for path in (self.prefix / "include" / "victorious").iterdir())
        self.assertEqual(headers, sorted([*(p.name for p in (program.REPOSITORY / "include" / "victorious").glob("*.h")),
                                          "version.h"]))  # fmt: skip

    def test_reads_cad_files_by_the_installed_decoder(self):
        source = self.write("make_model.cc", """
            #include <victorious/victorious.h>
            int main(int, char** argv) {
              try {
                libvictorious::MakeModelFromCad("bad", argv[1]);
              } catch (const libvictorious::Error& error) {
                return error.code() == libvictorious::ErrorCode::kDataLoss ? 0 : (puts(error.what()), 1);
              }
            }
        """.replace("#include <victorious", "#include <cstdio>\n#include <victorious", 1))  # fmt: skip
        environment = os.environ | {"PKG_CONFIG_PATH": str(self.pkg_config)}
        flags = output("pkg-config", "--cflags", "--libs", "victorious", env=environment).split()
        output("g++", "-std=c++17", source, *flags, f"-Wl,-rpath,{self.libraries}", "-o", self.scratch / "make_model")
        output(self.scratch / "make_model", self.write("bad.obj", "not a mesh"))


if __name__ == "__main__":
    program.main()
