"""`user`: accounts of an index. Passwords come from standard input or the terminal, and nothing stores them."""

import contextlib
import os
import pty
import shutil
import signal
import sqlite3
import subprocess
import termios

import program

PASSWORD = "correct horse battery"


class UserTest(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.db = self.scratch / "index.db"
        shutil.copy(program.index(), self.db)

    def add(self, name, role="analyst", password=PASSWORD):
        return self.succeeds("user", "add", name, "--role", role, "--db", self.db, input=password + "\n")

    def accounts(self):
        return self.succeeds("user", "list", "--db", self.db, "--json").rows()

    def test_accounts_are_added_changed_and_removed(self):
        self.add("ann", "admin")
        self.add("bob", "viewer")
        self.assertEqual([(one["name"], one["role"]) for one in self.accounts()], [("ann", "admin"), ("bob", "viewer")])
        self.succeeds("user", "change", "bob", "--role", "analyst", "--db", self.db)
        self.assertEqual(self.accounts()[1]["role"], "analyst")
        self.refuses(2, "ann", "user", "add", "Ann", "--role", "viewer", "--db", self.db, input="")
        self.succeeds("user", "remove", "ann", "--db", self.db)
        self.assertEqual([one["name"] for one in self.accounts()], ["bob"])
        self.assertIn("bob", self.succeeds("user", "list", "--db", self.db).out)
        log = self.succeeds("user", "log", "--db", self.db, "--json").rows()
        self.assertEqual(
            [(one["action"], one["subject"]) for one in log],
            [("remove_account", "account ann"), ("change_role", "account bob"), ("add_account", "account bob"),
             ("add_account", "account ann")],
        )  # fmt: skip
        self.assertEqual(self.succeeds("user", "log", "--db", self.db, "--limit", "1").out.count("\n"), 1)

    def test_each_command_has_json(self):
        def rows(*words, **options):
            return self.succeeds("user", *words, "--db", self.db, "--json", **options).rows()

        (added,) = rows("add", "ann", "--role", "viewer", input=PASSWORD + "\n")
        self.assertEqual((added["name"], added["role"], added["tokens"]), ("ann", "viewer", []))
        (changed,) = rows("change", "ann", "--role", "admin")
        self.assertEqual(changed, added | {"role": "admin"})
        (token,) = rows("token", "ann", "--label", "test")
        self.assertGreater(len(token["token"]), 20)
        self.assertEqual(self.accounts()[0]["tokens"], [{key: token[key] for key in ("id", "label", "expires")}])
        self.assertEqual(rows("revoke", "ann", "--token", token["id"]), [changed])
        self.assertEqual(rows("remove", "ann"), [{"removed": "ann"}])
        self.assertEqual(self.accounts(), [])

    def test_passwords_are_stored_nowhere(self):
        self.add("ann")
        with contextlib.closing(sqlite3.connect(self.db)) as db:
            (hashed,) = db.execute("SELECT password_hash FROM accounts").fetchone()
        self.assertTrue(hashed.startswith("$argon2id$"), hashed)
        self.assertNotIn(PASSWORD.encode(), b"".join(self.files().values()))
        self.succeeds("user", "change", "ann", "--password", "--db", self.db, input="another password\n")
        with contextlib.closing(sqlite3.connect(self.db)) as db:
            self.assertNotEqual(db.execute("SELECT password_hash FROM accounts").fetchone(), (hashed,))

    def test_passwords_are_asked_for_twice_on_a_terminal(self):
        for second, status in ((PASSWORD, 0), ("something else", 2)):
            main, terminal = pty.openpty()
            command = [program.PROGRAM, "user", "add", f"ann{status}", "--role", "viewer", "--db", self.db]
            with subprocess.Popen(list(map(str, command)), stdin=terminal, stdout=terminal, stderr=terminal) as process:
                os.close(terminal)
                shown = b""
                for prompt, answer in ((b"Password: ", PASSWORD), (b"more: ", second)):
                    while prompt not in shown:
                        shown += os.read(main, 4096)
                    os.write(main, answer.encode() + b"\n")
                with contextlib.suppress(OSError):  # the terminal is gone with the program
                    while chunk := os.read(main, 4096):
                        shown += chunk
            os.close(main)
            self.assertEqual(process.returncode, status, shown)
            self.assertNotIn(PASSWORD.encode(), shown)
        self.assertEqual([one["name"] for one in self.accounts()], ["ann0"])

    def test_terminal_shows_what_is_typed_after_an_interrupt(self):
        main, terminal = pty.openpty()
        command = [program.PROGRAM, "user", "add", "ann", "--role", "viewer", "--db", self.db]
        with subprocess.Popen(list(map(str, command)), stdin=terminal, stdout=terminal, stderr=terminal) as process:
            shown = b""
            while b"Password: " not in shown:
                shown += os.read(main, 4096)
            self.assertFalse(termios.tcgetattr(terminal)[3] & termios.ECHO)
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.wait(timeout=20), -signal.SIGINT)
        self.assertTrue(termios.tcgetattr(terminal)[3] & termios.ECHO)
        os.close(terminal)
        os.close(main)
        self.assertEqual(self.accounts(), [])

    def test_tokens_are_made_and_revoked(self):
        self.add("ann")
        token = self.succeeds("user", "token", "ann", "--label", "nightly", "--db", self.db).out.strip()
        self.assertEqual(len(token), 43)
        self.assertNotIn(token.encode(), b"".join(self.files().values()))
        (listed,) = self.accounts()[0]["tokens"]
        self.assertEqual(listed["label"], "nightly")
        self.refuses(2, "no token 99", "user", "revoke", "ann", "--token", "99", "--db", self.db)
        self.succeeds("user", "revoke", "ann", "--token", listed["id"], "--db", self.db)
        self.assertEqual(self.accounts()[0]["tokens"], [])

    def test_bad_usage(self):
        self.refuses(2, "12 to 1024", "user", "add", "ann", "--role", "viewer", "--db", self.db, input="short\n")
        self.refuses(2, "standard input", "user", "add", "ann", "--role", "viewer", "--db", self.db, input="")
        self.refuses(2, "letters", "user", "add", "a b", "--role", "viewer", "--db", self.db, input=PASSWORD)
        self.refuses(2, "--role", "user", "add", "ann", "--role", "king", "--db", self.db, input=PASSWORD)
        self.refuses(2, "--role, --password", "user", "change", "ann", "--db", self.db)
        self.refuses(2, "ann", "user", "remove", "ann", "--db", self.db)
        self.refuses(2, "none.db", "user", "list", "--db", self.scratch / "none.db")
        self.assertEqual(self.accounts(), [])


if __name__ == "__main__":
    program.main()
