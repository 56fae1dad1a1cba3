"""--params: unknown names and values out of range are rejected, all in one line, and no file is written."""

import json
import unittest

import program

VIDEO, MODELS, INDEX = program.flight() / "flight.mkv", program.models(), program.index()
CRATE = program.flight() / "crate.png"


class ParamsTest(program.ProgramTest):
    def refuses_params(self, text, words):
        params = self.write("params.json", text)
        words = [params, *([words] if isinstance(words, str) else words)]
        self.refuses(2, words, "index", VIDEO, "--models", MODELS, "--db", self.scratch / "out", "--params", params)
        self.assertEqual(list(self.files()), ["params.json"])

    def test_names(self):
        self.refuses_params('{"match": {"ration": 0.7}}', ["match.ration", "unknown", "match.ratio"])
        self.refuses_params('{"frobnicate": 1}', ["frobnicate", "unknown"])
        self.refuses_params('{"match": {"ratio": 0.7}, "match.ratio": 0.7}', "given twice")
        self.refuses_params('{"": 1}', "unknown")
        self.refuses_params('{"a\\nb": 1}', "unknown")

    def test_values(self):
        self.refuses_params('{"match": {"ratio": 7}}', ["match.ratio = 7", "to 1"])
        self.refuses_params('{"match": {"ratio": "high"}}', ["match.ratio", "a number"])
        self.refuses_params('{"match": 3}', "match")
        self.refuses_params('{"match": {"ratio": [0.7]}}', ["match.ratio", "a number"])
        self.refuses_params('{"every": 2.5}', ["every = 2.5", "a whole number"])
        self.refuses_params('{"features": {"engine": "nobody"}}', ["features.engine", "one of sift"])
        self.refuses_params(
            '{"every": -1, "match": {"ratio": 7}, "tracklets": {"gap": 1}}', ["every = -1", "match.ratio = 7", "tracklets.gap"]
        )

    def test_files(self):
        for text in ("", "ratio = 0.7", '{"match": {"ratio": 0.7}', '{"match": {"ratio": 1e999}}', "\xff\xfe", "{" * 9999):
            self.refuses_params(text.encode("latin-1"), "not JSON")
        for text in ("[1, 2]", "3", "null", '"match"'):
            self.refuses_params(text, "JSON object")
        out = self.scratch / "out"
        for params in (self.scratch / "none.json", self.scratch):
            self.refuses(2, params, "index", VIDEO, "--models", MODELS, "--db", out, "--params", params)
            self.assertFalse(out.exists())

    def test_other_commands_parameters(self):
        out = self.scratch / "out"
        params = self.write("params.json", '{"match": {"ratio": 7}, "matches": 1}')
        for command in (("match", CRATE, CRATE), ("search", "--db", INDEX, "--image", CRATE)):
            self.refuses(2, [params, "match.ratio = 7", "matches"], *command, "--params", params)
        params = self.write("params.json", '{"min_features": 0, "match": {"ratio": 0.7}}')
        self.refuses(
            2, ["min_features = 0", "match"], "model", "add", "x", CRATE, "--models", out, "--params", params
        )
        params = self.write("params.json", '{"max_side_px": 0}')
        self.refuses(2, "max_side_px = 0", "features", CRATE, "--out", out, "--params", params)
        self.assertFalse(out.exists())

    def test_defaults_are_accepted(self):
        for of, command in (
            ("index", ("match", CRATE, CRATE)),
            ("model", ("model", "add", "x", CRATE, "--models", self.scratch / "models")),
            ("features", ("features", CRATE, "--out", self.scratch / "features.txt")),
        ):
            reported = self.succeeds("params", of, "--json").out
            json.loads(reported)
            self.succeeds(*command, "--params", self.write(f"{of}.json", reported))


if __name__ == "__main__":
    program.main()
