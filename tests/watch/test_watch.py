"""Tests the program that runs the tests: it passes on how a test ended, and ends one that makes no progress."""

import os
import signal
import subprocess
import tempfile
import unittest

WATCH = os.environ["LOSTBITS_WATCH"]
BUSY = "end=$((SECONDS + {})); while ((SECONDS < end)); do :; done"


class Watch(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = scratch.name

    def start(self, script, *options):
        return subprocess.Popen([WATCH, *options, "bash", "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                text=True, env={**os.environ, "TMPDIR": self.folder})

    def run_watched(self, script, *options):
        run = self.start(script, *options)
        out, err = run.communicate()
        self.assertEqual(os.listdir(self.folder), [], "a folder is left")
        return run.returncode, out, err

    def test_passes_on_how_a_test_ended(self):
        self.assertEqual(self.run_watched("echo said; echo also >&2; exit 77"), (77, "said\n", "also\n"))
        self.assertEqual(self.run_watched("exit 0"), (0, "", ""))
        self.assertEqual(self.run_watched("kill -SEGV $$")[0], -signal.SIGSEGV)
        self.assertEqual(subprocess.run([WATCH, "/no/such/program"], capture_output=True).returncode, 127)
        self.assertEqual(subprocess.run([WATCH, "--still", "x", "true"], capture_output=True).returncode, 2)

    def test_ends_what_waits_for_ever(self):
        code, _, err = self.run_watched("sleep 1000 | sleep 2000", "--still", "3")
        self.assertEqual(code, 1)
        self.assertIn("no progress at 3 looks", err)
        self.assertEqual(err.count("S sleep"), 2)

    def test_looking_again_and_again_is_no_progress(self):
        code, _, err = self.run_watched("while :; do sleep 0.2; done", "--still", "5")
        self.assertEqual(code, 1)
        self.assertIn("no progress", err)

    def test_work_goes_on_however_long_it_takes(self):
        # A process that waits starts one that works, for twice the allowed time.
        self.assertEqual(self.run_watched(f"bash -c '{BUSY.format(12)}; echo done' & wait", "--still", "6"),
                         (0, "done\n", ""))

    def test_ends_a_loop_without_an_end(self):
        code, _, err = self.run_watched("while :; do :; done", "--processor", "2")
        self.assertEqual(code, 1)
        self.assertIn("more than 2 s of processor", err)

    def test_names_what_a_test_leaves(self):
        code, out, err = self.run_watched('mkdir "$TMPDIR/half"; echo x >"$TMPDIR/half/file"; echo "$TMPDIR"')
        self.assertEqual(code, 1)
        self.assertTrue(out.startswith(self.folder + "/"))
        self.assertIn("left in its temporary folder: half\n", err)
        self.assertEqual(self.run_watched('echo x >"$TMPDIR/left"; exit 3')[0], 3)

    def test_ends_processes_that_a_test_leaves(self):
        code, out, err = self.run_watched("setsid sleep 1000 </dev/null >/dev/null 2>&1 & echo $!")
        self.assertEqual(code, 0)
        self.assertIn("S sleep", err)
        self.assertFalse(os.path.exists(f"/proc/{int(out)}"))

    def test_is_ended_with_all_of_it(self):
        run = self.start('touch "$TMPDIR/left"; echo $$; sleep 1000 & wait')
        pid = int(run.stdout.readline())
        run.send_signal(signal.SIGTERM)
        _, err = run.communicate()
        self.assertEqual(run.returncode, -signal.SIGTERM)
        self.assertFalse(os.path.exists(f"/proc/{pid}"))
        self.assertIn("left in its temporary folder: left", err)
        self.assertEqual(os.listdir(self.folder), [])


if __name__ == "__main__":
    unittest.main()
