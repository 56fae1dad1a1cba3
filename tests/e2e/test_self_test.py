"""`victorious self-test`: every check of this machine is good; without its sample it says where that should be."""

import json
import shutil

import program


class SelfTestTest(program.ProgramTest):
    def test_every_check_is_good(self):
        said = json.loads(self.succeeds("self-test", "--json").out)
        self.assertTrue(said["good"], said)
        checks = {row["check"]: row["text"] for row in said["checks"]}
        self.assertEqual(list(checks), ["processor", "CUDA device", "sandbox", "drawing", "video", "model", "search"])
        self.assertRegex(checks["search"], r"^jeep is found in \d+ frames, 0\.\d\d m from where it stands$")

    def test_a_program_without_its_sample_says_so(self):
        alone = self.scratch / "bin" / "victorious"
        alone.parent.mkdir()
        shutil.copy2(program.PROGRAM, alone)
        self.refuses(2, ["self-test", "package"], "self-test", executable=alone)


if __name__ == "__main__":
    program.main()
