"""`serve`: every route against api/openapi.json, ranges of the video, refusals, reviews that outlive the server."""

import concurrent.futures
import contextlib
import functools
import http.client
import json
import os
import re
import shutil
import signal
import socket
import sqlite3
import ssl
import subprocess
import time
import unittest
import urllib.parse
import warnings
from pathlib import Path

import program
import streams

API = json.loads((program.REPOSITORY / "api" / "openapi.json").read_text())
# A stream without an end (test_events_tell_of_jobs); what needs telemetry, which the drawn flight lacks (api_test.cc).
NOT_ASKED = ("/api/v1/events", "/api/v1/models/{id}/coverage")

HEADER = "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg,hfov_deg"


def resolve(schema):
    """Follows a reference within the description."""
    while "$ref" in schema:
        node = API
        for part in schema["$ref"].removeprefix("#/").split("/"):
            node = node[part]
        schema = node
    return schema


TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None)}


def has_type(value, name) -> bool:
    if name == "integer":
        return isinstance(value, int) and not isinstance(value, bool)
    if name == "number":
        return isinstance(value, (int, float)) and not isinstance(value, bool)
    return isinstance(value, TYPES[name])


def problems(value, schema, at="$"):
    """What of `value` contradicts `schema`: the keywords that api/openapi.json uses."""
    schema = resolve(schema)
    if "anyOf" in schema and all(list(problems(value, one, at)) for one in schema["anyOf"]):
        yield f"{at}: none of anyOf: {value!r}"
    for one in schema.get("allOf", ()):
        yield from problems(value, one, at)
    if "enum" in schema and value not in schema["enum"]:
        yield f"{at}: {value!r} is not one of {schema['enum']}"
    if "type" in schema:
        names = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
        if not any(has_type(value, name) for name in names):
            yield f"{at}: {value!r} is no {' or '.join(names)}"
            return
    if isinstance(value, dict) and ("properties" in schema or "required" in schema):
        properties = schema.get("properties", {})
        yield from (f"{at}: lacks {name}" for name in schema.get("required", ()) if name not in value)
        for name, member in value.items():
            if name in properties:
                yield from problems(member, properties[name], f"{at}.{name}")
            elif schema.get("additionalProperties") is False:
                yield f"{at}: has {name}, which is not described"
    if isinstance(value, list):
        if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
            yield f"{at}: has {len(value)} items"
        for i, item in enumerate(value):
            yield from problems(item, schema.get("items", {}), f"{at}[{i}]")


@functools.cache
def index_of_mp4():
    path = program.folder_until_exit() / "index.db"
    done = program.run("index", program.flight() / "flight.mp4", "--models", program.models(), "--db", path)
    assert done.status == 0, done.err
    return path


class ServerCase(program.ProgramTest):
    """What tests ask a server."""

    def ask(self, server, path, method="GET", body=None, **headers):
        port = urllib.parse.urlsplit(server.url).port
        with contextlib.closing(http.client.HTTPConnection("127.0.0.1", port, timeout=60)) as connection:
            if body is not None:
                headers.setdefault("Content-Type", "application/json")
            connection.request(method, path, body=body, headers=headers)
            response = connection.getresponse()
            return response.status, dict(response.getheaders()), response.read()

    def get(self, server, path, status=200):
        got, _, body = self.ask(server, path)
        self.assertEqual(got, status, body)
        return json.loads(body)

    def review(self, server, number, **review):
        path = f"/api/v1/objects/{number}/review"
        status, _, body = self.ask(server, path, "PUT", json.dumps(review))
        self.assertEqual(status, 200, body)
        return json.loads(body)

    def upload(self, server, path, name=None):
        status, _, body = self.ask(
            server, f"/api/v1/uploads?name={urllib.parse.quote(name or path.name)}", "POST", path.read_bytes(),
            **{"Content-Type": "application/octet-stream"},
        )  # fmt: skip
        self.assertEqual(status, 200, body)
        return self.described(body, "Upload")["id"]

    def described(self, body, schema):
        value = json.loads(body)
        self.assertEqual(list(problems(value, {"$ref": f"#/components/schemas/{schema}"})), [])
        return value

    def post_job(self, server, **job):
        status, _, body = self.ask(server, "/api/v1/jobs", "POST", json.dumps(job))
        self.assertEqual(status, 200, body)
        return self.described(body, "Job")["id"]

    def wait_for_job(self, server, number, *states):
        """The job once it is in one of these states."""
        for _ in range(int(program.TIMEOUT_S / 0.05)):
            jobs = self.described(self.ask(server, "/api/v1/jobs")[2], "JobList")["jobs"]
            job = next(one for one in jobs if one["id"] == number)
            if job["state"] in states:
                return job
            self.assertIn(job["state"], ("queued", "running"), job)
            time.sleep(0.05)
        self.fail(f"job {number} is still {job}")


class ServeTest(ServerCase):
    def setUp(self):
        super().setUp()
        self.db = self.scratch / "index.db"
        self.video = self.scratch / "flight.mp4"
        shutil.copy(program.flight() / "flight.mp4", self.video)
        shutil.copy(index_of_mp4(), self.db)
        with contextlib.closing(sqlite3.connect(self.db)) as db, db:
            db.execute("UPDATE videos SET name = ?", (str(self.video),))
            # The drawn flight has no telemetry; the map needs a place.
            db.execute(
                "UPDATE objects SET place_time_s = 1, latitude_rad = 0.9, longitude_rad = 0.2, altitude_m = 40,"
                " covariance_enu_m2 = zeroblob(72), ce90_m = 5, le90_m = 4"
            )

    def serve(self, *flags):
        return program.Server(self.db, *flags)

    def test_answers_as_described(self):
        """Each path of the description is asked once with values that exist, and once with values that do not."""
        seen = set()
        tiles = self.write("map.pmtiles", b"PMTiles\x03" + bytes(91) + b"\x02" + bytes(100))
        with self.serve("--models", program.models(), "--tiles", tiles) as server:
            found = self.get(server, "/api/v1/objects")["objects"][0]
            best = self.get(server, f"/api/v1/objects/{found['id']}")["best"]
            video = found["moments"][0]["video_id"]
            self.wait_for_job(server, self.post_job(server, kind="copy", video_id=video), "done")
            clip = self.post_job(server, kind="clip", object_id=found["id"], video_id=video)
            self.wait_for_job(server, clip, "done")
            for path, item in API["paths"].items():
                real = path.replace("{view}", str(best["view_index"])).replace("{frame}", "3").replace("{name}", "clip")
                wrong = path.replace("{id}", "987654").replace("{z}/{x}/{y}", "3/9/0")
                real = real.replace("{z}/{x}/{y}", "0/0/0")
                number = {"videos": video, "objects": found["id"], "models": found["model_id"], "jobs": clip}.get((path.split("/") + [""] * 2)[3])
                for method in ("get", "put"):
                    if method not in item or path in NOT_ASKED:
                        continue
                    bodies = {"review": '{"verdict": "accepted", "note": "x"}', "threshold": '{"min_score": 0.5}'}
                    body = bodies[path.split("/")[-1]] if method == "put" else None
                    for target in {real.replace("{id}", str(number)), wrong.replace("{view}", "0").replace("{frame}", "3")}:
                        status, headers, text = self.ask(server, target, method.upper(), body)
                        answer = item[method]["responses"].get(str(status))
                        self.assertIsNotNone(answer, f"{target}: {status} is not described: {text[:200]}")
                        seen.add((path, status))
                        content = resolve(answer).get("content", {})
                        if "application/json" in content:
                            self.assertEqual(headers["Content-Type"], "application/json")
                            schema = content["application/json"]["schema"]
                            self.assertEqual(list(problems(json.loads(text), schema)), [], target)
                        elif content:
                            self.assertIn(headers["Content-Type"], content, target)
                            self.assertGreater(len(text), 2 if path == "/healthz" else 100)
        for path, item in API["paths"].items():
            if not {"get", "put"} & set(item) or path in NOT_ASKED:
                continue  # what is posted: the tests of jobs
            self.assertIn((path, 200), seen)
            if "{" in path:
                self.assertIn((path, 404), seen)

    def test_evidence(self):
        """Made again from video and model; an error once one of them is gone."""
        models = self.scratch / "library"
        shutil.copytree(program.models(), models)
        with self.serve("--models", models) as server:
            found = self.get(server, "/api/v1/objects")["objects"][0]
            route = f"/api/v1/objects/{found['id']}/evidence"
            evidence = self.described(self.ask(server, route)[2], "Evidence")
            self.assertEqual(evidence["sighting"], self.get(server, f"/api/v1/objects/{found['id']}")["best"])
            self.assertEqual([one["name"] for one in evidence["stages"]][-1], "inliers")
            counts = [one["matches"] for one in evidence["stages"]]
            self.assertEqual(counts, sorted(counts, reverse=True))
            # Exactly, if its whole frame was searched; a region is not exactly the one that was searched.
            self.assertAlmostEqual(counts[-1], evidence["sighting"]["matches"], delta=0.1 * counts[-1])
            self.assertEqual(len(evidence["matches"]), counts[0])
            self.assertAlmostEqual(evidence["pose"]["score"], evidence["sighting"]["score"], delta=0.05)
            view = f"/api/v1/models/{found['model_id']}/views/{evidence['view']['index']}"
            self.assertEqual(self.ask(server, f"{view}?size=full")[0], 200)
            self.described(self.ask(server, f"{view}?size=huge")[2], "Error")
            other = self.get(server, f"/api/v1/objects/{found['id']}/sightings?limit=1")["sightings"][0]
            at = f"{route}?video={other['video_id']}&frame={other['frame']}"
            self.assertEqual(self.described(self.ask(server, at)[2], "Evidence")["sighting"], other)
            for query, status in (("?video=1", 400), ("?frame=0", 400), ("?video=1&frame=99999", 404), ("?x=1", 400)):
                self.assertEqual(self.ask(server, route + query)[0], status, query)
            # At once from several: one after the other, all with the same answer.
            with concurrent.futures.ThreadPoolExecutor(8) as pool:
                answers = set(pool.map(lambda _: self.ask(server, route)[2], range(16)))
            self.assertEqual(len(answers), 1)
            self.video.rename(self.scratch / "away.mp4")
            self.assertIn("move it back", json.loads(self.ask(server, route)[2])["message"])
            (self.scratch / "away.mp4").rename(self.video)
            (models / f"{found['model']}.vmodel").unlink()
            self.assertEqual(self.ask(server, route)[0], 404)
        damaged = self.video.with_suffix(".srt")
        damaged.write_bytes(b"no subtitles")
        self.addCleanup(damaged.unlink)
        with self.serve("--models", program.models()) as server:
            self.described(self.ask(server, route)[2], "Evidence")
        with self.serve() as server:
            self.assertIn("--models", json.loads(self.ask(server, route)[2])["message"])

    def test_sends_ranges_of_the_video(self):
        whole = self.video.read_bytes()
        with self.serve() as server:
            status, headers, body = self.ask(server, "/api/v1/videos/1/file")
            self.assertEqual((status, body), (200, whole))
            for text, first, last in (("bytes=0-9", 0, 9), (f"bytes={len(whole) - 5}-", -5, None), ("bytes=-7", -7, None)):
                status, part, body = self.ask(server, "/api/v1/videos/1/file", Range=text)
                self.assertEqual(status, 206)
                self.assertEqual(body, whole[first:] if last is None else whole[first : last + 1], text)
                self.assertTrue(part["Content-Range"].endswith(f"/{len(whole)}"))
            self.assertEqual(self.ask(server, "/api/v1/videos/1/file", Range=f"bytes={len(whole)}-")[0], 416)
            etag = headers["ETag"]
            self.assertEqual(self.ask(server, "/api/v1/videos/1/file", **{"If-None-Match": etag})[0], 304)

    def test_accounts(self):
        """From the first account on, every request needs a session or a token; a decision has the account's name."""
        password = "correct horse battery"
        for name in ("analyst", "viewer"):
            self.succeeds("user", "add", name, "--role", name, "--db", self.db, input=password)
        token = self.succeeds("user", "token", "viewer", "--label", "test", "--db", self.db).out.strip()
        with self.serve() as server:
            self.assertEqual(self.described(self.ask(server, "/api/v1/session")[2], "Session")["account"], None)
            for path in ("/api/v1/project", "/api/v1/objects", "/api/v1/videos/1/file", "/api/v1/events"):
                status, headers, body = self.ask(server, path)
                self.assertEqual((status, headers["WWW-Authenticate"]), (401, "Bearer"), path)
                self.described(body, "Error")
            log_in = json.dumps({"name": "analyst", "password": password})
            status, headers, body = self.ask(server, "/api/v1/session", "POST", log_in)
            self.assertEqual(status, 200, body)
            self.assertEqual(self.described(body, "Session")["account"]["role"], "analyst")
            cookie = headers["Set-Cookie"].split(";")[0]
            ids = [one["id"] for one in json.loads(self.ask(server, "/api/v1/objects", Cookie=cookie)[2])["objects"]]
            review = (f"/api/v1/objects/{ids[0]}/review", "PUT", '{"verdict": "rejected", "reviewer": "somebody"}')
            self.assertEqual(self.ask(server, *review, Authorization=f"Bearer {token}")[0], 403)
            status, _, body = self.ask(server, *review, Cookie=cookie)
            self.assertEqual((status, json.loads(body)["review"]["reviewer"]), (200, "analyst"))
            own = json.loads(self.ask(server, "/api/v1/objects?review=own&reviewer=somebody", Cookie=cookie)[2])["objects"]
            self.assertEqual([one["id"] for one in own], ids[:1], "the account's own, whoever is named")
            self.assertEqual(self.ask(server, "/api/v1/project", Authorization=f"Bearer {token}")[0], 200)
            self.succeeds("user", "remove", "analyst", "--db", self.db)
            self.assertEqual(self.ask(server, "/api/v1/project", Cookie=cookie)[0], 401, "at once")
            self.succeeds("user", "change", "viewer", "--role", "admin", "--db", self.db)
            _, _, body = self.ask(server, "/api/v1/audit", Authorization=f"Bearer {token}")
            log = [(one["actor"], one["action"]) for one in self.described(body, "AuditList")["entries"]]
            self.assertEqual(log[-5:-3], [("analyst", "review"), ("analyst", "log_in")], log)

    @unittest.skipIf(shutil.which("openssl") is None, "openssl is not installed")
    def test_tls(self):
        """To another machine: by TLS, with an account, under the name of the certificate."""
        for name in ("server", "other"):
            program.self_signed(self.scratch, name, "search.example", "DNS:search.example")
        certificate = ("--tls-cert", self.scratch / "server.pem")
        key = ("--tls-key", self.scratch / "server.key")
        self.refuses(2, "user add", "serve", "--db", self.db, "--listen", "0.0.0.0:0", *certificate, *key)
        self.succeeds("user", "add", "ann", "--role", "admin", "--db", self.db, input="correct horse battery")
        self.refuses(2, "--tls-key", "serve", "--db", self.db, *certificate)
        self.refuses(2, "other.key", "serve", "--db", self.db, *certificate, "--tls-key", self.scratch / "other.key")
        self.refuses(2, "not a certificate", "serve", "--db", self.db, "--tls-cert", key[1], *key)
        self.refuses(2, "none.pem", "serve", "--db", self.db, "--tls-cert", self.scratch / "none.pem", *key)
        with program.Server(self.db, *certificate, *key, listen="0.0.0.0:0") as server:
            self.assertTrue(server.url.startswith("https://0.0.0.0:"), server.url)
            port = urllib.parse.urlsplit(server.url).port
            context = ssl.create_default_context(cafile=self.scratch / "server.pem")

            def ask(method, path, body=None, **headers):
                with socket.create_connection(("127.0.0.1", port), timeout=60) as plain:
                    connection = http.client.HTTPConnection("search.example", port)
                    connection.sock = context.wrap_socket(plain, server_hostname="search.example")
                    with contextlib.closing(connection):
                        connection.request(method, path, body, {"Content-Type": "application/json", **headers})
                        response = connection.getresponse()
                        return response.status, response.getheader("Set-Cookie"), response.read()

            self.assertEqual(ask("GET", "/api/v1/project")[0], 401)
            log_in = json.dumps({"name": "ann", "password": "correct horse battery"})
            origin = {"Origin": f"https://search.example:{port}"}
            status, cookie, body = ask("POST", "/api/v1/session", log_in, **origin)
            self.assertEqual(status, 200, body)
            self.assertRegex(cookie, f"^__Host-victorious_{port}=.*; Secure$")
            session = {"Cookie": cookie.split(";")[0]}
            self.assertEqual(ask("GET", "/api/v1/videos/1/file", **session)[2], self.video.read_bytes())
            self.assertEqual(ask("GET", "/api/v1/project", Origin="https://other.example", **session)[0], 403)
            # What is no TLS ends at the handshake, and an old protocol is refused.
            with socket.create_connection(("127.0.0.1", port), timeout=60) as plain:
                plain.sendall(b"GET /api/v1/session HTTP/1.1\r\nHost: x\r\n\r\n")
                self.assertNotIn(b"HTTP", plain.recv(4096))
            old = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
            old.check_hostname = False
            old.verify_mode = ssl.CERT_NONE
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", DeprecationWarning)
                old.maximum_version = ssl.TLSVersion.TLSv1_1
            weak = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)  # of TLS 1.2 with CBC
            weak.check_hostname = False
            weak.verify_mode = ssl.CERT_NONE
            weak.maximum_version = ssl.TLSVersion.TLSv1_2
            weak.set_ciphers("ECDHE-ECDSA-AES128-SHA256:ECDHE-ECDSA-AES256-SHA")
            for refused in (old, weak):
                with socket.create_connection(("127.0.0.1", port), timeout=60) as plain, self.assertRaises(ssl.SSLError):
                    refused.wrap_socket(plain)
            self.assertEqual(ask("GET", "/api/v1/session")[0], 200)  # still there
        self.assertNotIn("unencrypted", server.err)

    def test_refuses_foreign_and_broken_requests(self):
        outside = self.write("secret.txt", "secret")
        web = self.scratch / "web"
        self.write("web/index.html", "page")
        (web / "link").symlink_to(outside)
        with self.serve("--web", web) as server:
            self.assertEqual(self.ask(server, "/")[2], b"page")
            for target in ("/../secret.txt", "/%2e%2e/secret.txt", "/..%2fsecret.txt", "/link", "/api/v1/videos/1/file/x"):
                status, _, body = self.ask(server, target)
                self.assertIn(status, (400, 404), target)
                self.assertNotIn(b"secret", body)
            self.assertEqual(self.ask(server, "/api/v1/project", Host="rebound.example")[0], 421)
            self.assertEqual(self.ask(server, "/api/v1/project", Origin="http://other.example")[0], 403)
            self.assertEqual(self.ask(server, "/api/v1/objects/1/review", "PUT", "{}", **{"Content-Type": "text/plain"})[0], 415)
            self.assertEqual(self.ask(server, "/api/v1/project", "DELETE")[0], 405)
            self.assertEqual(self.ask(server, "/api/v1/objects/1/review", "PUT", "x" * 100_000)[0], 413)
            port = urllib.parse.urlsplit(server.url).port
            with socket.create_connection(("127.0.0.1", port), timeout=60) as raw:
                raw.sendall(b"GET / HTTP/1.1\r\nX: " + b"a" * 20_000 + b"\r\n\r\n")
                self.assertIn(b" 431 ", raw.recv(4096))
            self.assertEqual(self.get(server, "/api/v1/project")["videos"], 1)  # still there

    def test_reviews_survive_a_kill(self):
        with self.serve() as server:
            ids = [one["id"] for one in self.get(server, "/api/v1/objects")["objects"]]
            self.review(server, ids[0], verdict="rejected", note="a shadow")
            server.process.send_signal(signal.SIGKILL)
        with self.serve() as server:
            found = self.get(server, f"/api/v1/objects/{ids[0]}")
            self.assertEqual(found["review"]["verdict"], "rejected")
            self.assertEqual(found["review"]["note"], "a shadow")

    def test_weak_finds_are_left_out_unless_asked_for(self):
        """What is more likely false than right is not in exports, but on the page, below all that is not."""
        db = self.scratch / "weak.db"
        shutil.copy(self.db, db)
        listed = self.succeeds("export", "--db", db, "--format", "objects").rows()
        weak = listed[0]["object_id"]
        with contextlib.closing(sqlite3.connect(db)) as index, index:
            index.execute("UPDATE objects SET object_score = 0.49 WHERE id = ?", [weak])
        for command in (("search", "--json"), ("export", "--format", "objects"), ("export", "--format", "sightings")):
            done = self.succeeds(*command, "--db", db)
            self.assertEqual({row["object_id"] for row in done.rows()}, {one["object_id"] for one in listed[1:]})
            self.assertIn("1 weak find left out: it scores below 0.5 (--weak lists it)", done.err)
            for more in (["--weak"], ["--object", weak]):
                self.assertIn(weak, {row["object_id"] for row in self.succeeds(*command, "--db", db, *more).rows()})
        with program.Server(db) as server:
            shown = self.get(server, "/api/v1/objects?sort=rank")["objects"]
            self.assertEqual(shown[-1]["id"], weak)
            self.review(server, weak, verdict="accepted")
        self.assertIn(weak, {row["object_id"] for row in self.succeeds("search", "--json", "--db", db).rows()}, "a person knows better")

    def test_thresholds_are_those_of_the_commands(self):
        """A threshold set by the API leaves out of search, export and sheet what it leaves out of the API's list."""
        def ids(*command):
            return {row["object_id"] for row in self.succeeds(*command, "--db", self.db).rows()}

        search, export = ("search", "--json"), ("export", "--format", "objects")
        sightings = ("export", "--format", "sightings")
        applied = ("--thresholds", "applied")
        before = {command: self.succeeds(*command, "--db", self.db).out for command in (search, export, sightings)}
        everything = ids(*search)
        self.assertEqual(ids(*search, *applied), everything, "none is in force")
        with self.serve() as server:
            first = self.get(server, "/api/v1/objects")["objects"][0]
            target = f"/api/v1/models/{first['model_id']}/threshold"
            self.assertEqual(self.ask(server, target, "PUT", '{"min_score": 1}')[0], 200)
            kept = {one["id"] for one in self.get(server, "/api/v1/objects?thresholds=applied")["objects"]}
            self.assertNotIn(first["id"], kept)
            for command in (search, export, sightings):
                self.assertEqual(ids(*command, *applied), kept)
                self.assertEqual(self.succeeds(*command, "--db", self.db).out, before[command], "ignored by default")
            said = self.succeeds(*search, *applied, "--db", self.db, "--model", first["model"])
            self.assertEqual(said.out, "")
            self.assertIn("below the threshold of its model is left out", said.err)
            sheet = ("sheet", "--db", self.db, "--out", self.scratch / "sheet.png", "--model", first["model"])
            self.refuses(2, "no object", *sheet, *applied)
            self.review(server, first["id"], verdict="accepted")
            self.assertIn(first["id"], ids(*search, *applied))
        self.refuses(2, "--thresholds and --image", "search", "--db", self.db, *applied, "--image", "x.png")
        self.refuses(2, "--thresholds", "search", "--db", self.db, "--thresholds", "some")

    def test_reviews_survive_a_new_search(self):
        """The same video searched again from nothing: other ids, the same objects."""
        with self.serve() as server:
            before = self.get(server, "/api/v1/objects")["objects"][0]
            self.review(server, before["id"], verdict="accepted", note="kept")
            key = self.get(server, f"/api/v1/objects/{before['id']}")["key"]
            by_key = f"/api/v1/objects?key={urllib.parse.quote(key, safe='')}"
            self.assertEqual([one["id"] for one in self.get(server, by_key)["objects"]], [before["id"]])
            self.get(server, "/api/v1/objects?key=7", 400)
        self.succeeds("index", self.video, "--models", program.models(), "--db", self.db, "--redo")
        with self.serve() as server:
            reviewed = self.get(server, "/api/v1/objects?review=accepted")["objects"]
            self.assertEqual([one["id"] for one in self.get(server, by_key)["objects"]], [reviewed[0]["id"]])
        self.assertEqual([(one["model"], one["review"]["note"]) for one in reviewed], [(before["model"], "kept")])
        self.assertNotEqual(reviewed[0]["id"], before["id"])
        self.assertEqual(reviewed[0]["first_time_s"], before["first_time_s"])

    def test_shows_what_another_process_adds(self):
        with self.serve() as server:
            count = self.get(server, "/api/v1/project")["accepted"]
            self.assertEqual(count, 0)
            with self.serve() as second:
                number = self.get(second, "/api/v1/objects")["objects"][0]["id"]
                self.review(second, number, verdict="accepted")
            seen = 0
            for _ in range(200):  # at most once a second the index is looked at again
                seen = self.get(server, "/api/v1/project")["accepted"]
                if seen:
                    break
                time.sleep(0.05)
            self.assertEqual(seen, 1)

    def test_tells_what_was_searched(self):
        """Of a part, of a model that was added later, and of the whole: by the times of frames."""
        part = self.scratch / "part.db"
        self.succeeds("index", self.video, "--models", program.models(), "--db", part, "--from", "1", "--to", "2")
        with program.Server(part) as server:
            (video,) = self.described(self.ask(server, "/api/v1/videos")[2], "VideoList")["videos"]
            detail = self.described(self.ask(server, f"/api/v1/videos/{video['id']}")[2], "VideoDetail")
        self.assertFalse(video["is_searched"])
        self.assertEqual(video["searched"], [{"from_s": 1, "to_s": 2}])
        self.assertEqual(video["searched_s"], 1)
        wanted = [(0, 1, "not_wanted", None), (2, None, "not_wanted", None)]
        self.assertEqual([tuple(one.values()) for one in video["left_out"]], wanted)
        for search in detail["searches"]:
            self.assertTrue(search["finished"])
            self.assertEqual((search["searched_frames"], search["searched"]), (11, video["searched"]))
        with contextlib.closing(sqlite3.connect(self.db)) as db, db:
            db.execute("INSERT INTO models (name, content_id, kind) VALUES ('later', '1', 'cad')")
        with self.serve() as server:
            (video,) = self.described(self.ask(server, "/api/v1/videos")[2], "VideoList")["videos"]
            later = self.get(server, "/api/v1/project")["models"][-1]["id"]
            self.assertFalse(video["is_searched"])
            end = video["duration_s"]
            self.assertEqual([tuple(one.values()) for one in video["left_out"]], [(0, end, "not_begun", [later])])
            with contextlib.closing(sqlite3.connect(self.db)) as db, db:
                db.execute("DELETE FROM models WHERE name = 'later'")
            time.sleep(1.1)
            (video,) = self.get(server, "/api/v1/videos")["videos"]
            self.assertTrue(video["is_searched"])
            self.assertEqual((video["searched"], video["left_out"]), ([{"from_s": 0, "to_s": end}], []))

    def test_jobs_make_a_model_and_search_an_uploaded_video(self):
        """From an empty index and no model to finds, by the API alone."""
        db, models = self.scratch / "new.db", self.scratch / "models"
        db.touch()
        models.mkdir()
        with program.Server(db, "--models", models) as server:
            self.assertTrue(self.get(server, "/api/v1/project")["has_jobs"])
            for name in ("crate", "truck"):
                photo = self.upload(server, program.flight() / f"{name}.png")
                number = self.post_job(server, kind="model", name=name, uploads=[photo])
                self.wait_for_job(server, number, "done")
            video = self.upload(server, self.video, "it's a flight.mp4")
            job = self.wait_for_job(server, self.post_job(server, kind="index", upload=video), "done")
            self.assertEqual(job["title"], "it's a flight.mp4")
            for _ in range(int(program.TIMEOUT_S / 0.05)):  # the list of videos follows within a second, the count at once
                project = self.get(server, "/api/v1/project")
                if project["objects"] and project["videos"]:
                    break
                time.sleep(0.05)
            self.assertGreater(project["objects"], 0)
            self.assertEqual(project["videos"], 1)
            found = self.get(server, "/api/v1/objects")["objects"]
        expected = program.run("export", "--db", index_of_mp4(), "--format", "objects").rows()
        self.assertEqual(
            [(one["model"], one["frames"], one["score"]) for one in found],
            [(one["model"], one["frames"], one["score"]) for one in expected],
            "the same as by the command line",
        )

    def test_copies_for_browsers(self):
        """A video in MPEG-TS: the copy is made once, however many ask for it, and is found again after a restart."""
        video = self.scratch / "flight.ts"
        subprocess.run([program.built("draw_numbers", "VICTORIOUS_DRAW_NUMBERS"), video], check=True)
        db = self.scratch / "copies.db"
        self.succeeds("index", video, "--models", program.models(), "--db", db)
        with program.Server(db, "--models", program.models()) as server:
            self.assertFalse(self.get(server, "/api/v1/videos/1")["has_copy"])
            self.get(server, "/api/v1/videos/1/copy", 404)
            numbers = {self.post_job(server, kind="copy", video_id=1) for _ in range(3)}
            job = self.wait_for_job(server, max(numbers), "done")
            self.assertEqual((job["title"], job["message"]), ("flight.ts", "90 frames, copied as they are"))
            status, _, body = self.ask(server, "/api/v1/jobs", "POST", '{"kind": "copy", "video_id": 1}')
            self.assertEqual(status, 409, body)
            name = self.upload(server, self.video)
            files = [*Path(f"{db}.copies").rglob("*"), *Path(f"{db}.uploads").rglob("*")]
            self.assertEqual([(file.name, oct(file.stat().st_mode & 0o7)) for file in files if file.stat().st_mode & 7], [])
            self.assertEqual(len([file for file in files if file.is_file()]), 2, name)
        with program.Server(db) as server:
            self.assertTrue(self.get(server, "/api/v1/videos")["videos"][0]["has_copy"])
            status, headers, copy = self.ask(server, "/api/v1/videos/1/copy")
            self.assertEqual((status, headers["Content-Type"], copy[4:8]), (200, "video/mp4", b"ftyp"))
            self.assertEqual(self.ask(server, "/api/v1/videos/1/copy", Range="bytes=4-7")[2], b"ftyp")

    def test_clips_of_objects(self):
        """The clip has the frames of one moment and a margin; its telemetry is found with it; the same is made once."""
        rows = [f"{time / 10},{52.5 + 1e-5 * time},13.4,140,0,-80,0,60" for time in range(200)]
        self.video.with_suffix(".telemetry.csv").write_text("\n".join([HEADER, *rows]) + "\n")
        with self.serve("--models", program.models()) as server:
            found = self.get(server, "/api/v1/objects")["objects"][0]
            moment = found["moments"][0]
            asked = {"kind": "clip", "object_id": found["id"], "video_id": moment["video_id"]}
            first_s = moment["first_time_s"]
            numbers = {self.post_job(server, **asked, from_s=first_s, to_s=first_s + 0.1) for _ in range(3)}
            job = self.wait_for_job(server, max(numbers), "done")
            self.assertEqual(job["files"], ["clip", "telemetry"])
            self.assertRegex(job["message"], r"^[\d.]+ s to [\d.]+ s, with telemetry beside it$")
            self.assertEqual(job["title"], f"{found['model']}-{found['id']}-flight")
            status, headers, clip = self.ask(server, f"/api/v1/jobs/{job['id']}/files/clip")
            self.assertEqual((status, headers["Content-Type"], clip[4:8]), (200, "video/mp4", b"ftyp"))
            self.assertEqual(headers["Content-Disposition"], f'attachment; filename="{job["title"]}.mp4"')
            (self.scratch / "clip.mp4").write_bytes(clip)
            table = self.ask(server, f"/api/v1/jobs/{job['id']}/files/telemetry")[2]
            (self.scratch / "clip.telemetry.csv").write_bytes(table)
            self.get(server, f"/api/v1/jobs/{job['id']}/files/..", 400)
            self.get(server, f"/api/v1/jobs/{job['id']}/files/index", 404)
            begin_s = max(0, first_s - 2)
            row = table.decode().splitlines()[1].split(",")
            self.assertAlmostEqual(float(row[1]), 52.5 + 1e-4 * (begin_s + float(row[0])), delta=2e-5)
            times = self.get(server, f"/api/v1/videos/{moment['video_id']}/times")["times_s"]
            seen = self.get(server, f"/api/v1/objects/{found['id']}/sightings?from={first_s}&to={first_s + 0.1}")["sightings"]
        begin, end = seen[0]["time_s"] - 2.0001, seen[-1]["time_s"] + 2.0001
        expected = sum(begin <= time <= end for time in times)
        self.assertLess(expected, len(times), "the test needs a part of the video")
        made = json.loads(self.succeeds("doctor", self.scratch / "clip.mp4", "--json").out)
        self.assertEqual(made["frames_read"], expected)
        self.assertIn("clip.telemetry.csv", json.dumps(made))

    def test_what_was_added_by_mistake_is_removed(self):
        """A model with its objects and its file, then the video; the video's file stays."""
        models = self.scratch / "models"
        shutil.copytree(program.models(), models)
        with self.serve("--models", models) as server:
            listed = self.get(server, "/api/v1/project")["models"]
            gone = next(one for one in listed if one["name"] == "crate")
            self.assertGreater(gone["objects"], 0)
            job = self.wait_for_job(server, self.post_job(server, kind="remove", model_id=gone["id"]), "done")
            self.assertEqual(job["title"], "crate")
            self.assertEqual(list(models.glob("crate*")), [])
            left = [one["model"] for one in json.loads(f"[{','.join(self.succeeds('export', '--db', self.db, '--format', 'objects').out.splitlines())}]")]
            self.assertNotIn("crate", left)
            self.assertEqual(len(left), sum(one["objects"] for one in listed) - gone["objects"])
            for wrong in ({}, {"model_id": 99}, {"video_id": 99}, {"video_id": 1, "model_id": 1}):
                status, _, body = self.ask(server, "/api/v1/jobs", "POST", json.dumps({"kind": "remove", **wrong}))
                self.assertEqual(status, 400, body)
            self.wait_for_job(server, self.post_job(server, kind="remove", video_id=1), "done")
        self.assertEqual(self.succeeds("export", "--db", self.db, "--format", "objects").out, "")
        self.assertTrue(self.video.exists())
        self.refuses(2, "is not in the index", "remove", "--db", self.db, "--video", self.video)
        self.refuses(2, "is not in the index", "remove", "--db", self.db, "--model", "crate", "--models", models)
        self.refuses(2, "add --video NAME or --model NAME", "remove", "--db", self.db)
        self.refuses(2, "nowhere", "remove", "--db", self.db, "--model", "truck", "--models", self.scratch / "nowhere")
        self.refuses(2, "none.db", "remove", "--db", self.scratch / "none.db", "--model", "crate")
        self.assertFalse((self.scratch / "none.db").exists())

    def test_jobs_that_fail_say_why(self):
        with self.serve("--models", program.models()) as server:
            broken = self.upload(server, self.write("broken.mp4", "no video"))
            job = self.wait_for_job(server, self.post_job(server, kind="index", upload=broken), "failed")
            self.assertIn("broken.mp4", job["message"])
            for body, field in (
                ({}, "kind"),
                ({"kind": "dance"}, "kind"),
                ({"kind": "index"}, "upload"),
                ({"kind": "index", "video_id": 99}, "video_id"),
                ({"kind": "copy", "video_id": 99}, "video_id"),
                ({"kind": "copy"}, "video_id"),
                ({"kind": "copy", "video_id": 1, "out": "/etc/x"}, "out"),
                ({"kind": "clip", "object_id": 99, "video_id": 1}, "object_id"),
                ({"kind": "clip", "object_id": 1, "video_id": 99}, "video_id"),
                ({"kind": "clip", "object_id": 1, "video_id": 1, "clip": "/etc/x"}, "clip"),
                ({"kind": "model", "name": "x", "video_id": 99, "frame": 1, "box": [1, 2, 30, 40]}, "video_id"),
                ({"kind": "model", "name": "x", "video_id": 1, "frame": 9999, "box": [1, 2, 30, 40]}, "frame"),
                ({"kind": "model", "name": "x", "video_id": 1, "frame": 1, "box": [1, 2, 30]}, "box"),
                ({"kind": "model", "name": "x", "video_id": 1, "frame": 1, "box": [1, 2, -30, 40]}, "box"),
                ({"kind": "live"}, "url"),
                ({"kind": "live", "url": "http://127.0.0.1/"}, "url"),
                ({"kind": "live", "url": "file:///etc/passwd"}, "url"),
                ({"kind": "live", "url": "rtsp://"}, "url"),
                ({"kind": "live", "url": "rtsp://h/a b"}, "url"),
                ({"kind": "live", "url": "rtsp://h/", "telemetry": "/etc/x"}, "telemetry"),
                ({"kind": "track", "video_id": 99, "frame": 1, "box": [1, 2, 30, 40]}, "video_id"),
                ({"kind": "track", "video_id": 1, "frame": 9999, "box": [1, 2, 30, 40]}, "frame"),
                ({"kind": "track", "video_id": 1, "frame": 1, "box": [1, 2, 0, 40]}, "box"),
                ({"kind": "track", "video_id": 1, "frame": 1, "box": [1, 2, 30, 40], "type": ""}, "type"),
                ({"kind": "track", "video_id": 1, "frame": 1, "box": [1, 2, 30, 40], "track": "/etc/x"}, "track"),
                ({"kind": "model", "name": "x"}, "uploads"),
                ({"kind": "model", "name": "x", "uploads": [broken], "boxes": [[1, 2, 3, 4], [1, 2, 3, 4]]}, "boxes"),
                ({"kind": "model", "name": "x", "uploads": [broken], "boxes": [[1, 2, 0, 4]]}, "boxes"),
                ({"kind": "index", "video_id": 1, "redo": 1}, "redo"),
                ({"kind": "index", "upload": "../../etc", "x": 1}, "x"),
                ({"kind": "model", "name": "../x", "uploads": [broken]}, "name"),
                ({"kind": "model", "name": "x", "uploads": []}, "uploads"),
                ({"kind": "model", "name": "x", "uploads": [broken], "length_m": -1}, "length_m"),
            ):
                status, _, text = self.ask(server, "/api/v1/jobs", "POST", json.dumps(body))
                self.assertEqual((status, json.loads(text)["field"]), (400, field), body)
                self.assertNotIn(f"{field}:", json.loads(text)["message"], "it is for readers, not for programs")
            for upload in ("../../etc", "0" * 16, ""):
                status, _, text = self.ask(server, "/api/v1/jobs", "POST", json.dumps({"kind": "index", "upload": upload}))
                self.assertEqual(status, 404, text)
            for name in ("", "a/b", "..", ".hidden", "x" * 300):
                target = f"/api/v1/uploads?name={urllib.parse.quote(name, safe='')}"
                status, _, _ = self.ask(server, target, "POST", b"x", **{"Content-Type": "application/octet-stream"})
                self.assertEqual(status, 400, name)
            self.assertEqual(self.ask(server, "/api/v1/uploads?name=a", "POST", "{}")[0], 415)
            self.assertEqual(self.ask(server, "/api/v1/uploads?name=a")[0], 405)
        with self.serve() as server:
            octets = {"Content-Type": "application/octet-stream"}
            self.assertEqual(self.ask(server, "/api/v1/uploads?name=a", "POST", b"x", **octets)[0], 403)
            self.assertFalse(self.get(server, "/api/v1/project")["has_jobs"])

    def test_uploads_have_a_limit(self):
        with self.serve("--models", program.models(), "--max-upload", "0.001") as server:
            octets = {"Content-Type": "application/octet-stream"}
            self.assertEqual(self.ask(server, "/api/v1/uploads?name=a", "POST", b"x" * 1_000_000, **octets)[0], 200)
            port = urllib.parse.urlsplit(server.url).port
            with socket.create_connection(("127.0.0.1", port), timeout=60) as raw:
                raw.sendall(
                    f"POST /api/v1/uploads?name=b HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Length: 1000001\r\n"
                    "Content-Type: application/octet-stream\r\n\r\n".encode()
                )
                self.assertIn(b" 413 ", raw.recv(4096))
            kept = [one.name for one in Path(f"{self.db}.uploads").glob("*/*")]
        self.assertEqual(kept, ["a"])

    def test_jobs_survive_a_kill_of_the_server(self):
        """Killed while a job runs and another waits: the next server ends both, and the results are whole."""
        db = self.scratch / "killed.db"
        db.touch()
        with program.Server(db, "--models", program.models()) as server:
            numbers = []
            for name in ("a.mp4", "b.mkv"):
                video = self.upload(server, program.flight() / f"flight{Path(name).suffix}", name)
                numbers.append(self.post_job(server, kind="index", upload=video))
            self.wait_for_job(server, numbers[0], "running", "done")
            server.process.send_signal(signal.SIGKILL)
        with program.Server(db, "--models", program.models()) as server:
            for number in numbers:
                self.wait_for_job(server, number, "done")
        for name in ("a.mp4", "b.mkv"):
            rows = program.run("export", "--db", db, "--format", "sightings", "--video", name).rows()
            alone = self.scratch / f"{name}.db"
            self.succeeds("index", next(Path(f"{db}.uploads").glob(f"*/{name}")), "--models", program.models(), "--db", alone)
            expected = program.run("export", "--db", alone, "--format", "sightings").rows()
            self.assertEqual([(one["frame"], one["box"]) for one in rows], [(one["frame"], one["box"]) for one in expected])

    def test_given_telemetry_is_that_of_one_video(self):
        """Another video that is added has none: with the file of the first one, its track would have places."""
        rows = [f"{time / 10},{52.5 + 1e-5 * time},13.4,140,0,-80,0,60" for time in range(200)]
        table = self.write("table.csv", "\n".join([HEADER, *rows]) + "\n")
        other = self.scratch / "other.mp4"
        other.write_bytes(self.video.read_bytes() + bytes(8))
        box = {"kind": "track", "frame": 3, "box": [40, 40, 80, 60], "type": "truck"}
        with self.serve("--models", program.models(), "--telemetry", table) as server:
            job = self.wait_for_job(server, self.post_job(server, kind="index", upload=self.upload(server, other)), "done")
            for _ in range(int(program.TIMEOUT_S / 0.05)):
                videos = self.get(server, "/api/v1/videos")["videos"]
                if len(videos) == 2:
                    break
                time.sleep(0.05)
            self.assertEqual([Path(one["name"]).name for one in videos], ["flight.mp4", "other.mp4"], job)
            sources = [self.get(server, f"/api/v1/videos/{one['id']}/camera")["source"] for one in videos]
            self.assertEqual(sources, ["telemetry", None])
            for one, has_place in zip(videos, (True, False)):
                job = self.wait_for_job(server, self.post_job(server, **box, video_id=one["id"]), "done")
                (number,) = re.findall(r"is object (\d+),", job["message"])
                boxed = self.get(server, f"/api/v1/objects/{number}")
                self.assertEqual(boxed["model"], "boxed/truck")
                self.assertEqual([one["id"]], [moment["video_id"] for moment in boxed["moments"]])
                self.assertEqual(boxed["place"] is not None, has_place, one["name"])
            kinds = {one["name"]: one["kind"] for one in self.get(server, "/api/v1/project")["models"]}
            self.assertEqual(kinds["boxed/truck"], "boxed")
            self.assertTrue(all(one["is_searched"] for one in self.get(server, "/api/v1/videos")["videos"]))

    def test_live_jobs_say_how_far_they_are_behind(self):
        with streams.Rtsp(program.flight(100) / "flight.ts", seconds=10) as source:
            with self.serve("--models", program.models()) as server:
                number = self.post_job(server, kind="live", url=source)
                said = None
                for _ in range(int(program.TIMEOUT_S / 0.05)):
                    jobs = self.described(self.ask(server, "/api/v1/jobs")[2], "JobList")["jobs"]
                    (job,) = (one for one in jobs if one["id"] == number)
                    said = job["behind_s"] if said is None else said
                    if job["state"] != "queued" and (said is not None or job["state"] != "running"):
                        break
                    time.sleep(0.05)
                self.assertIsNotNone(said, job)
                self.assertGreaterEqual(said, 0)
                self.assertIsNone(self.wait_for_job(server, number, "done")["behind_s"], "it has ended")

    def test_serve_script_opens_the_page(self):
        """tools/serve.sh: in a browser where there is one; the address is printed in any case."""
        opened = self.scratch / "opened"
        browser = self.write("bin/xdg-open", f"#!/bin/sh\necho $1 >{opened}\n")
        browser.chmod(0o755)
        without = self.scratch / "without"
        without.mkdir()
        for tool in ("bash", "uname"):
            (without / tool).symlink_to(shutil.which(tool))
        command = [program.REPOSITORY / "tools" / "serve.sh", program.PROGRAM, "--db", self.db, "--listen", "127.0.0.1:0"]
        paths = {"none": str(without), "xdg-open": f"{browser.parent}:{without}"}
        for display, tools in (("", "xdg-open"), (":1", "none"), (":1", "xdg-open")):
            environment = os.environ | {"DISPLAY": display, "WAYLAND_DISPLAY": "", "PATH": paths[tools]}
            served = subprocess.Popen(
                list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment,
                start_new_session=True,
            )  # fmt: skip
            address = served.stdout.readline().strip()
            self.assertRegex(address, r"^http://127\.0\.0\.1:\d+/$")
            is_opened = bool(display) and tools == "xdg-open"
            if is_opened:
                while not (opened.exists() and opened.read_text()) and served.poll() is None:
                    time.sleep(0.02)
                self.assertEqual(opened.read_text().strip(), address)
            os.killpg(served.pid, signal.SIGINT)
            served.communicate(timeout=program.TIMEOUT_S)
            self.assertEqual(opened.exists(), is_opened)

    def test_jobs_are_cancelled(self):
        with self.serve("--models", program.models()) as server:
            video = self.upload(server, program.flight() / "flight.mkv")
            numbers = [self.post_job(server, kind="index", upload=video) for _ in range(3)]
            for number in reversed(numbers):
                status, _, body = self.ask(server, f"/api/v1/jobs/{number}/cancel", "POST", "{}")
                self.assertEqual(status, 200, body)
                self.described(body, "Job")
            # The one that runs may have ended before it was asked.
            self.assertEqual(self.wait_for_job(server, numbers[2], "cancelled")["done"], 0)
            self.wait_for_job(server, numbers[0], "cancelled", "done")
            self.assertEqual(self.ask(server, "/api/v1/jobs/999/cancel", "POST", "{}")[0], 404)

    def test_telemetry_of_an_upload_belongs_to_its_video(self):
        """In whatever folder it lies: to the map, and to each later search."""
        db = self.scratch / "given.db"
        db.touch()
        rows = [f"{time},52.5,13.407,140,0,-80,0,60" for time in range(10)]
        given = self.write("given.csv", "\n".join([HEADER, *rows]) + "\n")
        with program.Server(db, "--models", program.models()) as server:
            video = self.upload(server, program.flight() / "flight.mp4")
            telemetry = self.upload(server, given)
            self.wait_for_job(server, self.post_job(server, kind="index", upload=video, telemetry=telemetry), "done")
            path = self.get(server, "/api/v1/videos/1/camera")
            self.assertEqual((path["source"], len(path["points"])), ("telemetry", 10))
            for place, showing in (("52.5,13.407", [1]), ("52.6,13.407", []), ("-10,13.407", [])):
                videos = self.get(server, f"/api/v1/videos?shows={place}")["videos"]
                self.assertEqual([one["id"] for one in videos], showing, place)
            for wrong in ("", "52.5", "52.5,x", "91,0", "1,2,3"):
                self.get(server, f"/api/v1/videos?shows={wrong}", 400)
            stored = next(self.scratch.glob("given.db.uploads/*/given.csv"))
            again = self.post_job(server, kind="index", video_id=1)
            self.wait_for_job(server, again, "done")
            with contextlib.closing(sqlite3.connect(db)) as index:
                self.assertEqual(index.execute("SELECT telemetry FROM videos").fetchall(), [(str(stored),)])
        video = next(self.scratch.glob("given.db.uploads/*/flight.mp4"))
        said = self.succeeds("index", video, "--models", program.models(), "--db", db).err
        self.assertIn(f"telemetry: {stored}, as it was given for the video before", said)
        stored.unlink()
        said = self.succeeds("index", video, "--models", program.models(), "--db", db).err
        self.assertIn(f"the telemetry file {stored} that was given for the video is gone: what is in the video", said)
        with program.Server(db, "--models", program.models()) as server:
            path = self.get(server, "/api/v1/videos/1/camera")
            self.assertIn(f"the telemetry file {stored} that was given for the video is gone", path["reason"])

    def test_failed_jobs_are_tried_again_and_removed(self):
        with self.serve("--models", program.models()) as server:
            upload = self.upload(server, self.write("broken.mp4", "no video"))
            number = self.post_job(server, kind="index", upload=upload)
            self.wait_for_job(server, number, "failed")
            upload_path = next(self.scratch.glob(f"*.uploads/{upload}/broken.mp4"))
            shutil.copy(program.flight() / "flight.mkv", upload_path)
            status, _, body = self.ask(server, f"/api/v1/jobs/{number}/retry", "POST", "{}")
            self.assertEqual(status, 200, body)
            self.assertEqual(self.described(body, "Job")["id"], number)
            self.wait_for_job(server, number, "done")
            status, _, body = self.ask(server, f"/api/v1/jobs/{number}/retry", "POST", "{}")
            self.assertEqual(status, 409)
            self.assertRegex(self.described(body, "Error")["message"], r"^Job \d+ is done: only a job that has failed")
            status, _, body = self.ask(server, f"/api/v1/jobs/{number}", "DELETE")
            self.assertEqual((status, body.strip()), (200, b"{}"))
            self.assertEqual(self.ask(server, f"/api/v1/jobs/{number}", "DELETE")[0], 404)
            self.assertEqual(self.ask(server, "/api/v1/jobs/999/retry", "POST", "{}")[0], 404)
            status, headers, _ = self.ask(server, f"/api/v1/jobs/{number}")
            self.assertEqual((status, headers["Allow"]), (405, "DELETE"))
            self.assertEqual(json.loads(self.ask(server, "/api/v1/jobs")[2])["jobs"], [])
            self.assertTrue(upload_path.exists(), "the video is in the index")

    def test_uploads_go_with_the_last_job_that_needs_them(self):
        with self.serve("--models", program.models()) as server:
            upload = self.upload(server, self.write("broken.mp4", "no video"))
            numbers = [self.post_job(server, kind="index", upload=upload) for _ in range(2)]
            folder = next(self.scratch.glob(f"*.uploads/{upload}"))
            for number, is_left in zip(numbers, (True, False), strict=True):
                self.wait_for_job(server, number, "failed")
                self.assertEqual(self.ask(server, f"/api/v1/jobs/{number}", "DELETE")[0], 200)
                self.assertEqual(folder.exists(), is_left)

    def test_a_server_without_models_has_no_jobs(self):
        with self.serve() as server:
            status, _, body = self.ask(server, "/api/v1/jobs")
            self.assertEqual((status, json.loads(body)["jobs"]), (200, []))
            status, _, body = self.ask(server, "/api/v1/jobs", "POST", json.dumps({"kind": "index", "video_id": 1}))
            self.assertEqual(status, 415, body)

    def test_a_clip_of_what_has_changed_is_not_tried_again(self):
        db = self.scratch / "changed.db"
        shutil.copy(self.db, db)
        with program.Server(db, "--models", program.models()) as server:
            (video,) = json.loads(self.ask(server, "/api/v1/videos")[2])["videos"]
            (found, *_) = json.loads(self.ask(server, "/api/v1/objects")[2])["objects"]
            # The object is not seen so late.
            number = self.post_job(server, kind="clip", video_id=video["id"], object_id=found["id"], from_s=1e6)
            self.wait_for_job(server, number, "failed")
            status, _, body = self.ask(server, f"/api/v1/jobs/{number}/retry", "POST", "{}")
            self.assertEqual(status, 200, body)
            self.wait_for_job(server, number, "failed")
            with contextlib.closing(sqlite3.connect(db)) as connection, connection:
                connection.execute("UPDATE tracklets SET frames = frames + 1")
            self.eventually_conflicts(server, number)

    def eventually_conflicts(self, server, number):
        """Within the time after which the server shows what others have changed."""
        for _ in range(100):
            status, _, body = self.ask(server, f"/api/v1/jobs/{number}/retry", "POST", "{}")
            if status == 409:
                break
            time.sleep(0.1)
        self.assertIn("ask for the clip anew", self.described(body, "Error")["message"])

    def test_events_tell_of_jobs_and_finds(self):
        db = self.scratch / "events.db"
        db.touch()
        with program.Server(db, "--models", program.models()) as server:
            port = urllib.parse.urlsplit(server.url).port
            with contextlib.closing(http.client.HTTPConnection("127.0.0.1", port, timeout=program.TIMEOUT_S)) as stream:
                stream.request("GET", "/api/v1/events")
                response = stream.getresponse()
                self.assertEqual(response.getheader("Content-Type"), "text/event-stream")
                video = self.upload(server, self.video)
                number = self.post_job(server, kind="index", upload=video)
                states, newest, name = [], 0, None
                while states[-1:] != ["done"] or newest == 0:
                    line = response.readline().decode().strip()
                    if line.startswith("event: "):
                        name = line.removeprefix("event: ")
                    if not line.startswith("data: "):
                        continue
                    data = json.loads(line.removeprefix("data: "))
                    if name == "index":
                        newest = data["newest_object"]
                        continue
                    self.described(json.dumps(data), "JobList")
                    states += [one["state"] for one in data["jobs"] if one["id"] == number]
            self.assertEqual(sorted(set(states)), sorted(set(states) & {"queued", "running", "done"}))

    def test_a_locked_file_is_said_and_waited_for(self):
        """While another program holds a lock of the file, requests that need it are answered with 503; then as before."""
        db = self.scratch / "locked.db"
        shutil.copy(self.db, db)
        with program.Server(db, "--models", program.models()) as server:
            before = self.get(server, "/api/v1/objects")
            number = before["objects"][0]["id"]
            writes = (("PUT", f"/api/v1/objects/{number}/review", '{"verdict": "accepted"}'),
                      ("PUT", f"/api/v1/models/{before['objects'][0]['model_id']}/threshold", '{"min_score": 0.5}'),
                      ("POST", "/api/v1/jobs", '{"kind": "index", "video_id": 1}'))  # fmt: skip
            with contextlib.closing(sqlite3.connect(db, isolation_level=None)) as other:
                other.execute("BEGIN IMMEDIATE")
                self.assertEqual(self.get(server, "/api/v1/objects"), before, "reading goes on")
                with concurrent.futures.ThreadPoolExecutor(len(writes)) as pool:
                    for status, _, body in pool.map(lambda one: self.ask(server, one[1], one[0], one[2]), writes):
                        self.assertEqual(status, 503, body)
                        error = self.described(body, "Error")
                        self.assertEqual(error["code"], "unavailable")
                        self.assertIn("locked by another process", error["message"])
                other.execute("ROLLBACK")
            self.assertEqual(self.ask(server, writes[0][1], "PUT", writes[0][2])[0], 200)

    def test_lists_that_cannot_be_read_are_shown_as_they_were(self):
        """For a while, to all requests, with their age; said once."""
        db = self.scratch / "damaged.db"
        shutil.copy(self.db, db)

        def ask_until(server, is_aged):
            for _ in range(400):
                status, headers, body = self.ask(server, "/api/v1/videos")
                self.assertEqual((status, json.loads(body)), (200, before))
                if ("Age" in headers) == is_aged:
                    return headers
                time.sleep(0.05)
            self.fail(f"the header Age: {not is_aged}, for 20 s")

        with program.Server(db) as server, contextlib.closing(sqlite3.connect(db, isolation_level=None)) as other:
            before = self.get(server, "/api/v1/videos")
            other.execute("ALTER TABLE searches RENAME TO away")
            self.assertGreater(int(ask_until(server, True)["Age"]), 0)
            for _ in range(20):  # no request gets an error, or a list without its age
                self.assertIn("Age", self.ask(server, "/api/v1/videos")[1])
            other.execute("ALTER TABLE away RENAME TO searches")
            ask_until(server, False)
        said = [line for line in server.err.splitlines() if "lists of the index" in line]
        self.assertEqual(len(said), 2, server.err)
        self.assertIn("cannot be read", said[0])
        self.assertIn("read again", said[1])

    def test_ends_when_asked(self):
        for sent in (signal.SIGINT, signal.SIGTERM):
            with self.serve() as server:
                self.get(server, "/api/v1/project")
                server.process.send_signal(sent)
                self.assertEqual(server.process.wait(timeout=program.TIMEOUT_S), 0)

    def test_begins_from_nothing(self):
        """Alone, `serve` makes its index and library; a name that is mistyped is not made without --create."""
        folder = self.scratch / "nothing"
        folder.mkdir()
        for _ in range(2):
            with program.Server(None, cwd=folder) as server:
                project = self.described(self.ask(server, "/api/v1/project")[2], "Project")
                self.assertTrue(project["can_review"] and project["has_jobs"])
                self.assertFalse(project["has_targets"])
                self.assertEqual((project["videos"], project["models"]), (0, []))
                upload = self.upload(server, program.flight() / "flight.mkv")
                status, _, body = self.ask(server, "/api/v1/jobs", "POST", json.dumps({"kind": "index", "upload": upload}))
                self.assertEqual(status, 409, body)
                self.assertIn("first add photos or a CAD file", self.described(body, "Error")["message"])
        self.assertTrue((folder / "victorious.db").is_file() and (folder / "models").is_dir())
        with program.Server(None, cwd=folder) as server:
            photo = self.upload(server, program.flight() / "crate.png")
            self.wait_for_job(server, self.post_job(server, kind="model", name="crate", uploads=[photo]), "done")
            self.assertTrue(self.get(server, "/api/v1/project")["has_targets"])
            upload = self.upload(server, program.flight() / "flight.mkv")
            self.wait_for_job(server, self.post_job(server, kind="index", upload=upload), "done")
            self.assertGreater(self.get(server, "/api/v1/project")["objects"], 0)
            self.assertFalse(self.get(server, "/api/v1/project")["has_sample"], "there is a video")
        new = self.scratch / "new" / "index.db"
        new.parent.mkdir()
        self.refuses(2, ["index.db: no such file", "--create"], "serve", "--db", new)
        self.assertFalse(new.exists())
        with program.Server(new, "--create") as server:
            self.assertTrue(self.get(server, "/api/v1/project")["has_jobs"])
        self.succeeds("user", "add", "ann", "--role", "admin", "--db", new, input="correct horse battery\n")
        with program.Server(new) as server:
            self.assertEqual(self.ask(server, "/api/v1/project")[0], 401)

    def test_refuses_bad_arguments(self):
        self.refuses(2, "loopback", "serve", "--db", self.db, "--listen", "0.0.0.0:8080")
        self.refuses(2, "127.0.0.1:8080", "serve", "--db", self.db, "--listen", "8080")
        self.refuses(2, "create it first", "serve", "--db", self.scratch / "none" / "new.db", "--create")
        self.refuses(2, "none.db", "serve", "--db", self.scratch / "none.db")
        self.refuses(2, "index.html", "serve", "--db", self.db, "--web", self.scratch)
        self.refuses(2, "no models", "serve", "--db", self.db, "--models", self.scratch / "no models")
        text = self.write("text.db", "no index")
        self.refuses(2, "not an index", "serve", "--db", text)
        with self.serve() as server:
            address = server.url.removeprefix("http://")
            self.refuses(1, "another program", "serve", "--db", self.db, "--listen", address)


if __name__ == "__main__":
    program.main()
