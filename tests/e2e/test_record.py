"""`record`: what a live source sent is in files that name their time, whoever is killed meanwhile."""

import datetime
import json
import signal
import subprocess
import time
import unittest

import program
import streams

FRAMES = 150  # 10 a second, a key frame each


class RecordTest(program.ProgramTest):
    def start_recorder(self, source, *flags):
        command = [program.PROGRAM, "record", source, "--to", self.scratch / "recordings", "--segment", 2, *flags]
        return subprocess.Popen(list(map(str, command)), stderr=subprocess.PIPE, text=True)

    def files(self, ending=".ts"):
        return sorted((self.scratch / "recordings").glob("*" + ending))

    def wait_until(self, is_so):
        for _ in range(1200):
            if is_so():
                return
            time.sleep(0.05)
        self.fail("did not come")

    @staticmethod
    def start_s(file) -> float:
        """Of the first frame, by the name."""
        moment = datetime.datetime.strptime(file.name, "%Y-%m-%dT%H-%M-%S.%fZ.ts")
        return moment.replace(tzinfo=datetime.UTC).timestamp()

    def length_s(self, file) -> float:
        """From the first frame to the end of the last one."""
        return json.loads(self.succeeds("doctor", file, "--json").out)["last_time_s"] + 0.1

    def test_times_without_the_recorder_are_missing_and_nothing_else(self):
        with streams.Broadcast(program.flight(FRAMES) / "flight.ts", seconds=FRAMES / 10) as source:
            recorder = self.start_recorder(source)
            self.wait_until(lambda: len(self.files()) >= 2 and self.files(".part"))
            recorder.kill()
            recorder.communicate()
            killed_s = time.time()
            complete = self.files()
            (part,) = self.files(".part")
            recorder = self.start_recorder(source)
            self.wait_until(lambda: len(self.files()) >= len(complete) + 3)
            recorder.send_signal(signal.SIGINT)
            err = recorder.communicate(timeout=program.TIMEOUT_S)[1]
            self.assertEqual(recorder.returncode, 0, err)
        files = self.files()
        self.assertEqual(self.files(".part"), [])
        self.assertEqual(files[: len(complete) + 1], [*complete, part.with_suffix("")])
        for i, (file, after) in enumerate(zip(files, files[1:])):
            end_s = self.start_s(file) + self.length_s(file)
            if i == len(complete):
                self.assertLess(abs(end_s - killed_s), 2, "until it was killed")
                self.assertGreater(self.start_s(after), end_s)
            else:
                # Times are those of arrival, which is late where the processor is busy.
                self.assertAlmostEqual(end_s, self.start_s(after), delta=0.5, msg=f"{file} {after}")

    def test_bad_input(self):
        to = ("--to", self.scratch / "recordings")
        self.refuses(2, "not the address of a live source", "record", program.flight() / "flight.ts", *to)
        self.refuses(2, "not a kind of address", "record", "gopher://h/", *to)
        self.refuses(2, "--to", "record", "udp://127.0.0.1:1")
        self.refuses(2, "--segment", "record", "udp://127.0.0.1:1", *to, "--segment", 0)
        self.refuses(2, "Connection refused", "record", "tcp://127.0.0.1:1", *to)


if __name__ == "__main__":
    program.main()
