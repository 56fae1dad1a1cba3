"""`cmake --install`, which `make install` and `make package` call: programs, manual page and completion that work."""

import gzip
import subprocess

import program

BUILD = program.PROGRAM.parent


class InstallTest(program.ProgramTest):
    def test_installed_files_work(self):
        done = subprocess.run(
            ["cmake", "--install", BUILD, "--prefix", self.scratch], capture_output=True, text=True, check=False
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        installed = self.scratch / "bin" / "victorious"
        version = subprocess.run([installed, "-V"], capture_output=True, text=True, check=True).stdout
        self.assertEqual(version, self.succeeds("--version").out)
        listed = subprocess.run([installed, "bench", "--help"], capture_output=True, text=True, check=True).stdout
        self.assertIn("match", listed)
        refused = subprocess.run([installed, "experiment", "list"], capture_output=True, text=True, check=False)
        self.assertEqual((refused.returncode, refused.stdout), (2, ""))
        self.assertIn("`make build` builds it from the sources", refused.stderr)
        self.assertTrue((self.scratch / "share/victorious/assets/models/jeep.glb").exists(), "for self-test and the page")
        self.assertTrue((self.scratch / "share/victorious/scenes/demo.json").exists())
        bad = self.scratch / "bad.obj"
        bad.write_text("not a mesh")
        refused = subprocess.run([installed, "model", "add", "bad", bad, "--models", self.scratch / "models"],
                                 capture_output=True, text=True, check=False)  # fmt: skip
        self.assertEqual(refused.returncode, 2, refused.stderr)
        self.assertIn("bad.obj: ", refused.stderr, "the program that reads it is found where it is installed")
        self.assertNotIn("victorious-decoder", refused.stderr)
        page = gzip.decompress((self.scratch / "share/man/man1/victorious.1.gz").read_bytes()).decode()
        self.assertEqual(page, self.succeeds("manual", "man").out)
        for shell, path in {
            "bash": "bash-completion/completions/victorious",
            "zsh": "zsh/vendor-completions/_victorious",
            "fish": "fish/vendor_completions.d/victorious.fish",
        }.items():
            self.assertEqual((self.scratch / "share" / path).read_text(), self.succeeds("manual", shell).out)


if __name__ == "__main__":
    program.main()
