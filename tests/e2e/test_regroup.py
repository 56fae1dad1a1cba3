"""`victorious object`: a person joins objects and splits them, and a search that is done again obeys."""

import contextlib
import json
import shutil
import sqlite3
import urllib.error
import urllib.request

import program

# Tracks of another program, which become an object each: number, first frame, left edge of the box.
TRACKS = ((1, 1, 40), (2, 11, 60), (3, 21, 200))


class RegroupTest(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.video = self.scratch / "flight.mkv"
        shutil.copy(program.flight() / "flight.mkv", self.video)
        self.db = self.scratch / "index.db"
        self.enter()

    def enter(self):
        lines = [f"{first + i},{track},{x},50,40,30,0.9,-1,-1,-1\n" for track, first, x in TRACKS for i in range(8)]
        list_ = self.write("tracks.txt", "".join(lines))
        self.succeeds("index", self.video, "--detections", list_, "--detector", "radar", "--db", self.db)

    def objects(self) -> dict[int, list[float]]:
        """When the moments of each object begin, s; by its id."""
        with contextlib.closing(sqlite3.connect(self.db)) as index:
            rows = index.execute("SELECT object_id, first_time_s FROM tracklets ORDER BY object_id, first_time_s").fetchall()
        return {id: [round(time, 3) for of, time in rows if of == id] for id, _ in rows}

    def groups(self) -> list[list[float]]:
        return sorted(self.objects().values())

    def regroup(self, *arguments) -> list[int]:
        done = self.succeeds("object", *arguments, "--db", self.db, "--by", "ann", "--json")
        said = json.loads(done.out)
        self.correction = said["correction"]
        return said["object_ids"]

    def test_join_and_split(self):
        self.assertEqual(self.groups(), [[0], [1], [2]])
        first, second, third = self.objects()
        self.assertEqual(self.regroup("join", third, first), [first])
        self.assertEqual(self.groups(), [[0, 2], [1]])
        (row,) = [one for one in self.succeeds("export", "--db", self.db, "--format", "objects").rows() if one["object_id"] == first]
        self.assertEqual(row["frames"], 16)
        self.assertEqual(self.regroup("split", first, "--video", "flight.mkv", "--from", 1.9), [first, third])
        self.assertEqual(self.groups(), [[0], [1], [2]])
        said = self.succeeds("object", "join", first, second, "--db", self.db).out
        undo = self.correction + 1
        while f"undo {undo}`" not in said:
            undo += 1
            self.assertLess(undo, 100, said)
        self.assertIn(f"joined objects {first}, {second}: object {first} has 2 moments (", said)
        self.assertEqual(self.groups(), [[0, 1], [2]])
        self.assertEqual(self.succeeds("object", "undo", undo, "--db", self.db).out, f"took back correction {undo}\n")
        self.assertEqual(self.groups(), [[0], [1], [2]])
        log = self.succeeds("user", "log", "--db", self.db, "--json").rows()
        self.assertEqual([one["action"] for one in log], ["undo_regroup"] + ["regroup"] * 3)
        self.assertEqual({one["actor"] for one in log[2:]}, {"ann"})
        self.succeeds("doctor", self.db, "--check")

    def test_a_new_search_obeys(self):
        first, second, third = self.objects()
        self.regroup("join", first, second, third)
        self.regroup("split", first, "--video", "flight.mkv", "--to", 0.1)
        self.assertEqual(self.groups(), [[0], [1, 2]])
        before = set(self.objects())
        self.enter()
        self.assertFalse(before & set(self.objects()), "all tracklets are new ones")
        self.assertEqual(self.groups(), [[0], [1, 2]])

    def test_by_the_server(self):
        first, second, third = self.objects()
        with program.Server(self.db) as server:

            def post(body) -> tuple[int, dict]:
                request = urllib.request.Request(f"{server.url}/api/v1/objects/regroup", json.dumps(body).encode(), {"Content-Type": "application/json"})
                try:
                    with urllib.request.urlopen(request) as answer:
                        return answer.status, json.load(answer)
                except urllib.error.HTTPError as error:
                    return error.code, json.load(error)

            status, joined = post({"groups": [[second, third]]})
            self.assertEqual((status, joined["object_ids"]), (200, [second]))
            with urllib.request.urlopen(f"{server.url}/api/v1/objects/{second}") as answer:
                self.assertEqual([one["id"] for one in json.load(answer)["moments"]], [second, third])
            back = {"groups": [[second], [third]], "undo": joined["correction"]}
            self.assertEqual(post(back), (200, {"object_ids": [second, third], "correction": None}))
            self.assertEqual(post(back)[0], 404, "it was taken back")
            self.assertEqual(self.groups(), [[0], [1], [2]])
            status, said = post({"groups": [[first, first]]})
            self.assertEqual((status, said["field"]), (400, "groups"))
            self.assertIn("named twice", said["message"])
            self.assertEqual(post({"groups": [[first, 999]]})[0], 404)
            for wrong in ([], {"groups": 3}, {"groups": [["a"]]}, {"groups": [[first, second]], "undo": "1"}, {"objects": [first]}):
                self.assertEqual(post(wrong)[0], 400, wrong)
        self.assertEqual(self.groups(), [[0], [1], [2]])

    def test_refused(self):
        first, second, third = self.objects()
        before = self.objects()
        self.refuses(2, f"there is no object {third + 90}", "object", "join", first, third + 90, "--db", self.db)
        self.refuses(2, f"object {first} is named twice", "object", "join", first, first, "--db", self.db)
        self.refuses(2, "fewer than two moments", "object", "join", first, "--db", self.db)
        self.refuses(2, "select all of its moments", "object", "split", second, "--video", "flight.mkv", "--db", self.db)
        self.refuses(2, ["select none of its moments", "flight.mkv 1.0 to 1.7 s"], "object", "split", second, "--video", "other.mkv", "--db", self.db)
        self.refuses(2, "no such index", "object", "join", first, second, "--db", self.scratch / "none.db")
        self.assertEqual(self.objects(), before)


if __name__ == "__main__":
    program.main()
