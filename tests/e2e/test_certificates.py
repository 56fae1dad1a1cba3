"""Encrypted live sources: a server without a trusted certificate gets neither name nor password."""

import http.server
import json
import shutil
import ssl
import subprocess
import threading
import unittest

import program
import streams
import test_serve
from test_postgres import Postgres

PASSWORD = "secret"
WITH_PASSWORD = "Authorization: Basic YW5uOnNlY3JldA=="  # ann:secret


@unittest.skipIf(shutil.which("openssl") is None, "openssl is not installed")
class CertificatesTest(test_serve.ServerCase):
    def certificate(self, name, host="IP:127.0.0.1"):
        """The files of a certificate that signs itself, and of its key."""
        return program.self_signed(self.scratch, name, name, host)

    def camera(self, certificate, key):
        return streams.Rtsps(program.flight() / "flight.ts", 2, certificate, key)

    def commands(self, url):
        index = ("--models", program.models(), "--db", self.scratch / "new.db")
        return (("doctor", url), ("index", url, *index), ("frame", url, "--at", 0, "--out", self.scratch / "f.png"),
                ("telemetry", url))  # fmt: skip

    def test_a_false_certificate_gets_no_password(self):
        files = self.certificate("false")
        other, _ = self.certificate("other")
        for number in range(len(self.commands(""))):
            for trust in ((), ("--ca", other)):
                source = self.camera(*files)
                with source as url:
                    said = self.refuses(2, ["not trusted", "--ca FILE"], *self.commands(url)[number], *trust)
                    self.assertNotIn(PASSWORD, said)
                self.assertEqual(source.requests, [])

    def test_the_name_of_the_host_is_checked(self):
        files = self.certificate("elsewhere", "DNS:elsewhere.example")
        source = self.camera(*files)
        with source as url:
            self.refuses(2, "another host", "doctor", url, "--ca", files[0])
        self.assertEqual(source.requests, [])

    def test_a_trusted_certificate_gets_it(self):
        files = self.certificate("camera")
        source = self.camera(*files)
        with source as url:
            found = json.loads(self.succeeds("doctor", url, "--json", "--ca", files[0]).out)
        self.assertTrue(found["live"] if "live" in found else found)
        self.assertNotIn(WITH_PASSWORD, source.requests[0], "asked for at first")
        self.assertIn(WITH_PASSWORD, source.requests[1])
        with self.camera(*files) as url:
            said = self.succeeds("index", url, "--models", program.models(), "--db", self.scratch / "live.db", "--ca", files[0])
        self.assertNotIn(PASSWORD, said.err)

    def test_jobs_of_the_page_verify_too(self):
        files = self.certificate("camera")
        db = self.scratch / "page.db"
        db.touch()
        for trust, state in (((), "failed"), (("--ca", files[0]), "done")):
            source = self.camera(*files)
            with source as url, program.Server(db, "--models", program.models(), *trust) as server:
                job = self.wait_for_job(server, self.post_job(server, kind="live", url=url), state)
                if not trust:
                    self.assertIn("not trusted", job["message"])
                    self.assertEqual(source.requests, [])
                self.assertNotIn(PASSWORD, json.dumps(job))

    def test_workers_verify_too(self):
        files = self.certificate("camera")
        with Postgres() as postgres:
            for trust in ((), ("--ca", files[0])):
                source = self.camera(*files)
                with source as url:
                    self.succeeds("submit", url, "--models", program.models(), "--db", postgres.url)
                    command = [program.PROGRAM, "work", "--db", postgres.url, "--threads", 1, *trust]
                    with subprocess.Popen(list(map(str, command)), stderr=subprocess.PIPE, text=True) as worker:
                        for line in worker.stderr:
                            if "waits again" in line:
                                break
                        worker.terminate()
                        worker.communicate(timeout=program.TIMEOUT_S)
                    self.assertEqual("not trusted" in line, not trust, line)
                    self.assertNotIn(PASSWORD, line)
                self.assertEqual(bool(source.requests), bool(trust))
                self.succeeds("cluster", "end", url, "--db", postgres.url)

    def test_web_addresses_are_verified(self):
        """Also what a playlist names, whose addresses FFmpeg opens without the options of the playlist."""
        certificate, key = self.certificate("web")
        video = (program.flight() / "flight.ts").read_bytes()
        asked = []
        test = self

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_GET(self):
                asked.append(self.path)
                https = test.https.server_address[1]
                playlist = f"#EXTM3U\n#EXT-X-TARGETDURATION:9\n#EXTINF:9,\nhttps://127.0.0.1:{https}/a.ts\n#EXT-X-ENDLIST\n"
                body = playlist.encode() if self.path.endswith(".m3u8") else video
                self.send_response(200)
                self.send_header("Content-Length", str(len(body)))
                self.end_headers()
                self.wfile.write(body)

            def log_message(self, *_):
                pass

        def serve():
            server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
            self.addCleanup(server.server_close)
            self.addCleanup(server.shutdown)
            return server

        plain, self.https = serve(), serve()
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(certificate, key)
        self.https.socket = context.wrap_socket(self.https.socket, server_side=True, do_handshake_on_connect=False)
        for server in (plain, self.https):
            threading.Thread(target=server.serve_forever).start()
        playlist = f"http://127.0.0.1:{plain.server_address[1]}/list.m3u8"
        file = f"https://127.0.0.1:{self.https.server_address[1]}/a.ts"
        for url in (file, playlist):
            asked.clear()
            self.refuses(2, url, "doctor", url)
            self.assertNotIn("/a.ts", asked)
            self.succeeds("doctor", url, "--ca", certificate)
            self.assertIn("/a.ts", asked)

    def test_refuses_files_without_certificates(self):
        _, key = self.certificate("x")
        for file, words in ((key, "no certificate"), (self.scratch / "none.pem", "none.pem")):
            self.refuses(2, words, "doctor", "rtsps://127.0.0.1:1/", "--ca", file)


if __name__ == "__main__":
    program.main()
