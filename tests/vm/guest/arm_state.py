"""In the guest: waits until an arm of the daemon is in one of some states, and prints what the status says of it.

usage: arm_state.py ARM STATE…    (ARM: counted as in the configuration)

Ends with status 1 when that has not come in PATIENCE_S: whoever asks may ask again.
"""

import json
import subprocess
import sys
import time

PATIENCE_S = 2
PAUSE_S = 0.05


def state_of(arm):
    """What the status says of it, and its state: None while the daemon does not answer."""
    done = subprocess.run(["thimble", "status", "--json"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    try:
        found = json.loads(done.stdout)["arms"][arm]
        return json.dumps(found), found["state"]
    except (ValueError, LookupError):
        return done.stdout.decode(errors="replace"), None


def main(arm, *states):
    end = time.monotonic() + PATIENCE_S
    while True:
        said, state = state_of(int(arm))
        if state in states or time.monotonic() > end:
            print(said)
            sys.exit(state not in states)
        time.sleep(PAUSE_S)


if __name__ == "__main__":
    main(*sys.argv[1:])
