"""In the guest: waits until the daemon's status says one of some values, and prints the object that the value stands in.

usage: status_until.py PATH VALUE…    (PATH as safety.state or arms.0.state; true and false are values)

Ends with status 1 when that has not come in PATIENCE_S, and prints the last status: whoever asks may ask again.
"""

import functools
import json
import subprocess
import sys
import time

PATIENCE_S = 2
PAUSE_S = 0.05


def look(path):
    """What the status says there, the object that it stands in, and all that was said: none of both while the daemon does not answer."""
    done = subprocess.run(["thimble", "status", "--json"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    said = done.stdout.decode(errors="replace")
    *way, last = (int(word) if word.isdigit() else word for word in path.split("."))
    try:
        found = functools.reduce(lambda inside, word: inside[word], way, json.loads(said))
        value = found[last]
    except (ValueError, LookupError):
        return None, None, said
    return value if isinstance(value, str) else json.dumps(value), found, said


def main(path, *values):
    end = time.monotonic() + PATIENCE_S
    while True:
        value, found, said = look(path)
        if value in values:
            print(json.dumps(found))
            return
        if time.monotonic() > end:
            print(said)
            sys.exit(1)
        time.sleep(PAUSE_S)


if __name__ == "__main__":
    main(*sys.argv[1:])
