"""A folder of things that take long to make and are the same for the same inputs: made by whoever needs them first, old ones removed.

An entry is a folder named by a key. It has parts, each a folder that is either whole or not there. Several processes may use it at once.
"""

import contextlib
import fcntl
import hashlib
import os
import shutil


def key(words, files):
    """Of everything in WORDS that repr() shows, and of the names and contents of FILES, in any order."""
    digest = hashlib.sha256(repr(words).encode())
    for path in sorted(files, key=lambda path: path.name):
        data = path.read_bytes()
        digest.update(f"{path.name} {len(data)}\n".encode())
        digest.update(data)
    return digest.hexdigest()[:16]


def try_lock(folder, how):
    """A descriptor that has the lock until it is closed; None when another has it, or the folder is gone."""
    try:
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    except FileNotFoundError:
        return None
    try:
        fcntl.flock(descriptor, how)
        if os.fstat(descriptor).st_ino == os.stat(folder).st_ino:
            return descriptor
    except (BlockingIOError, FileNotFoundError):
        pass
    os.close(descriptor)
    return None


@contextlib.contextmanager
def entry(cache, name, keep):
    """The folder of this entry, which nobody removes meanwhile. Beside it at most KEEP - 1 others stay: those used last."""
    folder = cache / name
    descriptor = None
    while descriptor is None:  # another process may remove it between the two
        folder.mkdir(parents=True, exist_ok=True)
        descriptor = try_lock(folder, fcntl.LOCK_SH)
    try:
        os.utime(folder)
        prune(cache, keep)
        yield folder
    finally:
        os.close(descriptor)


def used_at(folder):
    """When it was used last; a folder that another process has removed meanwhile, never."""
    try:
        return folder.stat().st_mtime_ns
    except FileNotFoundError:
        return 0


def prune(cache, keep):
    """Removes all entries but the KEEP that were used last; one in use stays."""
    for old in sorted(cache.iterdir(), key=used_at, reverse=True)[keep:]:
        descriptor = try_lock(old, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if descriptor is not None:
            shutil.rmtree(old)
            os.close(descriptor)


def part(folder, name, make):
    """The part of this name of an entry; when it is not there, MAKE is called with an empty folder to fill. What it raises is passed on."""
    done, new = folder / name, folder / f"{name}.new"
    with open(folder / f"{name}.lock", "wb") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not done.exists():
            shutil.rmtree(new, ignore_errors=True)  # of one that was ended
            new.mkdir()
            make(new)
            new.rename(done)
    return done
