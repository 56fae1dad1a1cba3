#!/usr/bin/env python3
"""Tests of check_layers.py on small trees with at most one violation each."""

import contextlib
import io
import tempfile
import unittest
from pathlib import Path

import check_layers

LEVELS = {"base": 0, "geometry": 1, "kernels": 1, "input/video": 3, "object/mesh": 3, "object/render": 3, "place/geolocate": 3, "store": 3,
          "input/terrain": 4, "apps/cli": 7}  # fmt: skip
LAYERS = "[levels]\n" + "".join(f'"{folder}" = {level}\n' for folder, level in LEVELS.items())


class CheckLayersTest(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.root = Path(scratch.name)
        self.put("layers.toml", LAYERS)
        for folder in LEVELS:
            self.put(f"src/victorious/{folder}/CMakeLists.txt", "")

    def put(self, path, text):
        (self.root / path).parent.mkdir(parents=True, exist_ok=True)
        (self.root / path).write_text(text, encoding="utf-8")

    def findings(self, path=None, text=""):
        if path is not None:
            self.put(path, text)
        return [str(finding) for finding in check_layers.check(self.root)]

    def assert_one(self, expected, path, text):
        self.assertEqual(self.findings(path, text), [expected])

    def test_lower_levels_and_the_own_folder_are_fine(self):
        text = '#include "victorious/input/video/reader.h"\n#include "victorious/base/error.h"\n#include <vector>\n'
        self.assertEqual(self.findings("src/victorious/input/video/reader.cc", text), [])

    def test_higher_level_is_reported_with_its_line(self):
        self.assert_one(
            "src/victorious/base/error.h:3: includes victorious/geometry/box.h (level 1) from base (level 0): "
            "only lower levels may be included",
            "src/victorious/base/error.h",
            '// text\n\n#include "victorious/geometry/box.h"\n',
        )

    def test_same_level_is_reported(self):
        self.assert_one(
            "src/victorious/store/export.cc:1: includes victorious/input/video/reader.h (level 3) from store (level 3): "
            "only lower levels may be included",
            "src/victorious/store/export.cc",
            '#include "victorious/input/video/reader.h"\n',
        )

    def test_test_may_include_folders_of_its_own_level(self):
        text = '#include "victorious/input/video/reader.h"\n'
        self.assertEqual(self.findings("src/victorious/store/export_test.cc", text), [])
        self.assert_one(
            "src/victorious/geometry/box_test.cc:1: includes victorious/input/video/reader.h (level 3) from geometry (level 1): "
            "only lower levels may be included",
            "src/victorious/geometry/box_test.cc",
            text,
        )

    def test_product_includes_no_research_and_no_tool(self):
        for header in ("experiments/experiment.h", "assets/make/mesh.h", "bench/harness.h"):
            for path in ("src/victorious/apps/cli/main.cc", "src/victorious/apps/cli/main_test.cc"):
                with self.subTest(header=header, path=path):
                    found = self.findings(path, f'#include "{header}"\n')
                    self.assertEqual(found, [f"{path}:1: includes {header}: the product includes no research and no tool"])
                    (self.root / path).unlink()
            for path in ("experiments/table.cc", "bench/bench_frame.cc", "tests/e2e/draw.cc"):
                self.assertEqual(self.findings(path, f'#include "{header}"\n'), [])

    def test_research_may_include_every_folder_and_third_party(self):
        text = '#include "victorious/apps/cli/main.h"\n#include "testing/data.h"\n#include <ceres/ceres.h>\n'
        self.assertEqual(self.findings("experiments/table.cc", text), [])

    def test_public_headers_include_the_standard_library_and_each_other(self):
        self.assertEqual(self.findings("include/victorious/a.h", "#include <vector>\n#include <victorious/b.h>\n"), [])
        self.assert_one(
            "include/victorious/a.h:1: includes opencv2/core.hpp: a public header includes <victorious/….h> and the "
            "standard library",
            "include/victorious/a.h",
            "#include <opencv2/core.hpp>\n",
        )

    def test_public_headers_are_included_by_library_alone(self):
        self.put("layers.toml", LAYERS + '"apps/library" = 6\n')
        self.put("src/victorious/apps/library/CMakeLists.txt", "")
        self.assertEqual(self.findings("src/victorious/apps/library/a.cc", '#include "victorious/a.h"\n'), [])
        self.assert_one(
            "src/victorious/base/a.cc:1: includes victorious/a.h: the public headers are for callers of the library",
            "src/victorious/base/a.cc",
            '#include "victorious/a.h"\n',
        )

    def test_subfolders_belong_to_their_folder(self):
        self.assertEqual(
            self.findings("src/victorious/store/sqlite/store.cc", '#include "victorious/store/index_store.h"\n'), []
        )
        found = self.findings("src/victorious/geometry/robust/a.h", '#include "victorious/input/video/reader.h"\n')
        self.assertIn("from geometry (level 1)", found[0])

    def test_angle_brackets_and_spaces_are_parsed(self):
        found = self.findings("src/victorious/base/a.h", "#  include  <victorious/apps/cli/main.h>\n")
        self.assertIn("includes victorious/apps/cli/main.h (level 7) from base (level 0)", found[0])

    def test_include_in_a_comment_is_ignored(self):
        self.assertEqual(self.findings("src/victorious/base/a.h", '// #include "victorious/apps/cli/main.h"\n'), [])

    def test_unknown_folder_is_reported(self):
        self.assert_one(
            "src/victorious/apps/cli/main.cc:1: includes victorious/magic/wand.h: layers.toml lists no folder of it",
            "src/victorious/apps/cli/main.cc",
            '#include "victorious/magic/wand.h"\n',
        )

    def test_folders_and_the_list_agree(self):
        self.put("src/victorious/magic/CMakeLists.txt", "")
        self.put("layers.toml", LAYERS + "pose = 3\n")
        self.assertEqual(
            self.findings(),
            [
                "src/victorious/magic:1: folder magic is not listed in layers.toml: give it a level",
                "layers.toml:1: lists pose, which is no folder of src/victorious: take it out",
            ],
        )

    def test_the_last_part_of_a_path_names_one_folder(self):
        self.put("layers.toml", LAYERS + '"search/video" = 3\n')
        self.put("src/victorious/search/video/CMakeLists.txt", "")
        self.assertEqual(
            self.findings(),
            [
                f"layers.toml:1: lists {name}, whose last part names another folder, too: rename one"
                for name in ("input/video", "search/video")
            ],
        )

    def test_headers_are_named_from_the_root(self):
        for name in ("error.h", "../base/error.h"):
            found = self.findings("src/victorious/base/error.cc", f'#include "{name}"\n')
            self.assertEqual(len(found), 1)
            self.assertIn("name it from the root", found[0])

    def test_third_party_headers_have_their_folders(self):
        cases = (
            ("<libavformat/avformat.h>", "input/video/a.cc", "apps/cli/a.cc", "FFmpeg"),
            ("<libswscale/swscale.h>", "input/video/a.h", "store/a.cc", "FFmpeg"),
            ("<sqlite3.h>", "store/sqlite/a.cc", "store/a.cc", "SQLite"),
            ("<libpq-fe.h>", "store/postgres/a.cc", "store/a.cc", "libpq"),
            ("<hwy/highway.h>", "kernels/a.cc", "input/video/a.cc", "Highway"),
            ('"hwy/foreach_target.h"', "kernels/a.cc", "apps/cli/a.cc", "Highway"),
            ("<assimp/scene.h>", "object/mesh/a.cc", "object/render/a.cc", "assimp"),
            ("<GL/gl.h>", "object/render/a.cc", "object/mesh/a.cc", "OpenGL"),
            ("<EGL/egl.h>", "object/render/a.h", "apps/cli/a.cc", "OpenGL"),
            ("<GLES3/gl3.h>", "object/render/a.cc", "input/video/a.cc", "OpenGL"),
            ("<GeographicLib/Geoid.hpp>", "geometry/a.cc", "geometry/a.h", "GeographicLib"),
            ("<gdal_priv.h>", "input/terrain/a.cc", "input/video/a.cc", "GDAL"),
            ("<ogr_api.h>", "input/terrain/a.cc", "input/terrain/a.h", "GDAL"),
            ("<ceres/problem.h>", "place/geolocate/a.cc", "place/geolocate/a.h", "Ceres"),
            ("<CLI/CLI.hpp>", "apps/cli/argument_parser.cc", "input/video/a.cc", "CLI11"),
            ("<CLI/App.hpp>", "apps/cli/output_files.cc", "apps/cli/output_files_test.cc", "CLI11"),
            ("<CLI/App.hpp>", "apps/cli/describe_commands.cc", "apps/cli/argument_parser.h", "CLI11"),
            ("<CLI/App.hpp>", "apps/cli/argument_parser.cc", "apps/cli/cmd_a.cc", "CLI11"),
            ("<nlohmann/json.hpp>", "base/a.cc", "base/a.h", "json_fwd.hpp"),
            ('"testing/data.h"', "base/a_test.cc", "base/a.cc", "only tests"),
        )
        for header, right, wrong, text in cases:
            with self.subTest(header=header):
                self.assertEqual(self.findings(f"src/victorious/{right}", f"#include {header}\n"), [])
                found = self.findings(f"src/victorious/{wrong}", f"#include {header}\n")
                self.assertEqual(len(found), 1)
                self.assertTrue(found[0].startswith(f"src/victorious/{wrong}:1: "))
                self.assertIn(text, found[0])
                (self.root / "src/victorious" / wrong).unlink()

    def test_cli11_is_refused_outside_the_product_too(self):
        self.assertIn("argument_parser.h", self.findings("experiments/main.cc", "#include <CLI/App.hpp>\n")[0])
        self.assertEqual(self.findings("experiments/main.cc", '#include "victorious/apps/cli/argument_parser.h"\n'), [])

    def test_json_declarations_are_allowed_in_headers(self):
        self.assertEqual(self.findings("src/victorious/base/a.h", "#include <nlohmann/json_fwd.hpp>\n"), [])

    def test_opencvs_umbrella_header_is_refused_everywhere(self):
        for path in ("src/victorious/input/video/a.cc", "tests/e2e/a.cc"):
            self.assertIn("modules that are used", self.findings(path, "#include <opencv2/opencv.hpp>\n")[0])
            (self.root / path).unlink()
        self.assertEqual(self.findings("src/victorious/input/video/a.cc", "#include <opencv2/core.hpp>\n"), [])

    def test_long_files_are_reported(self):
        self.assertEqual(self.findings("src/victorious/base/a.cc", "\n" * check_layers.LONGEST_FILE), [])
        found = self.findings("src/victorious/base/a.cc", "\n" * (check_layers.LONGEST_FILE + 1))
        self.assertIn("601 lines, more than 600", found[0])

    def test_unfinished_work_is_reported(self):
        for mark in ("TO" + "DO: later", "FIX" + "ME", "X" * 3, "Not " + "implemented", "not yet " + "implemented"):
            with self.subTest(mark=mark):
                found = self.findings("bench/a.cc", f"int a;\n// {mark}\n")
                self.assertEqual(len(found), 1)
                self.assertTrue(found[0].startswith("bench/a.cc:2: says "))

    def test_template_of_a_temporary_name_is_no_mark(self):
        self.assertEqual(self.findings("testing/data.cc", f'mkdtemp("test-{"X" * 6}");\n'), [])

    def test_every_finding_is_reported_with_exit_status_1(self):
        self.put("src/victorious/base/a.h", '#include "victorious/apps/cli/b.h"\n#include "victorious/input/video/c.h"\n')
        output = io.StringIO()
        with contextlib.redirect_stdout(output):
            self.assertEqual(check_layers.main([str(self.root)]), 1)
        self.assertEqual(len(output.getvalue().splitlines()), 2)
        self.put("src/victorious/base/a.h", "")
        self.assertEqual(check_layers.main([str(self.root)]), 0)

    def test_parallel_work_runs_on_onetbb_alone(self):
        remedy = "run in parallel by oneTBB, or list the file in MAY_START_THREADS"
        for code in ("cv::parallel_for_", "std::jthread", "std::thread", "std::async", "pthread_create", "#pragma omp"):
            for path in ("src/victorious/object/mesh/bake.cc", "experiments/table.cc", "bench/bench_frame.cc"):
                with self.subTest(code=code, path=path):
                    self.assertEqual(self.findings(path, f"\n{code} x;\n"), [f"{path}:2: uses {code}: {remedy}"])
                    (self.root / path).unlink()
        fine = "n = std::thread::hardware_concurrency();  // no std::thread\noneapi::tbb::parallel_for(0, n, f);\n"
        self.assertEqual(self.findings("src/victorious/object/mesh/bake.cc", fine), [])
        self.assertEqual(self.findings("src/victorious/object/mesh/bake_test.cc", "std::thread x;\n"), [])


if __name__ == "__main__":
    unittest.main()
