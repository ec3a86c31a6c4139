import multiprocessing
import os
import pathlib
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "vm"))
import state_cache  # noqa: E402


def make(folder):
    (folder / "made").write_text("once")


def use(cache, made):
    """A process of its own: what it makes, it counts."""
    def count(folder):
        with made.get_lock():
            made.value += 1
        make(folder)

    with state_cache.entry(cache, "same", 1) as folder:
        assert (state_cache.part(folder, "state", count) / "made").read_text() == "once"


class StateCache(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.cache = pathlib.Path(scratch.name, "cache")

    def names(self):
        return sorted(path.name for path in self.cache.iterdir())

    def fill(self, name, keep=9):
        """An entry that was used when it was made, each a second after the one before it."""
        with state_cache.entry(self.cache, name, keep) as folder:
            state_cache.part(folder, "state", make)
        self.clock = getattr(self, "clock", 0) + 1
        os.utime(self.cache / name, (self.clock, self.clock))


class Parts(StateCache):
    def test_a_part_is_made_once(self):
        calls = []
        with state_cache.entry(self.cache, "a", 1) as folder:
            for _ in range(2):
                part = state_cache.part(folder, "state", lambda new: (calls.append(1), make(new)))
                self.assertEqual((part / "made").read_text(), "once")
        self.assertEqual(len(calls), 1)

    def test_what_was_not_finished_is_made_anew_from_nothing(self):
        def fail(folder):
            (folder / "half").touch()
            raise OSError("no space")

        with state_cache.entry(self.cache, "a", 1) as folder:
            with self.assertRaisesRegex(OSError, "no space"):
                state_cache.part(folder, "state", fail)
            self.assertFalse((folder / "state").exists())
            part = state_cache.part(folder, "state", make)
            self.assertEqual([path.name for path in part.iterdir()], ["made"])

    def test_parts_of_an_entry_do_not_share(self):
        with state_cache.entry(self.cache, "a", 1) as folder:
            self.assertNotEqual(state_cache.part(folder, "x", make), state_cache.part(folder, "y", make))

    def test_of_several_processes_one_makes_it(self):
        made = multiprocessing.Value("i", 0)
        processes = [multiprocessing.Process(target=use, args=(self.cache, made)) for _ in range(8)]
        for process in processes:
            process.start()
        for process in processes:
            process.join()
        self.assertEqual([process.exitcode for process in processes], 8 * [0])
        self.assertEqual(made.value, 1)


class Pruning(StateCache):
    def test_those_used_last_stay(self):
        for name in ("old", "older than it looks", "new"):
            self.fill(name)
        with state_cache.entry(self.cache, "old", 9):
            pass  # used again
        with state_cache.entry(self.cache, "newest", 3):
            self.assertEqual(self.names(), ["new", "newest", "old"])

    def test_the_one_that_is_asked_for_stays(self):
        self.fill("a")
        with state_cache.entry(self.cache, "b", 1) as folder:
            self.assertTrue(folder.is_dir())
            self.assertEqual(self.names(), ["b"])

    def test_one_in_use_stays(self):
        self.fill("a")
        with state_cache.entry(self.cache, "a", 9) as used:
            os.utime(used, (0, 0))
            with state_cache.entry(self.cache, "b", 1):
                self.assertEqual(self.names(), ["a", "b"])
        with state_cache.entry(self.cache, "b", 1):
            self.assertEqual(self.names(), ["b"])

    def test_what_was_removed_is_made_anew(self):
        self.fill("a")
        self.fill("b", keep=1)
        self.assertIsNone(state_cache.try_lock(self.cache / "a", state_cache.fcntl.LOCK_SH))
        with state_cache.entry(self.cache, "a", 2) as anew:
            self.assertFalse((anew / "state").exists())


class Key(StateCache):
    def setUp(self):
        super().setUp()
        self.cache.mkdir()
        self.files = []
        for name in ("a", "b"):
            self.files.append(self.cache / name)
            self.files[-1].write_text(name)
        self.before = state_cache.key(("words",), self.files)

    def test_it_is_the_same_for_the_same_in_any_order(self):
        self.assertEqual(state_cache.key(("words",), self.files[::-1]), self.before)

    def test_whatever_changes_changes_it(self):
        keys = {self.before, state_cache.key(("other",), self.files), state_cache.key(("words",), self.files[:1])}
        self.files[0].write_text("c")
        keys.add(state_cache.key(("words",), self.files))
        self.files[0].write_text("a")
        keys.add(state_cache.key(("words",), [self.files[0].rename(self.cache / "c"), self.files[1]]))
        self.assertEqual(len(keys), 5)
