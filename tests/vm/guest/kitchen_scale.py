"""In the guest: `thimble calibrate-force` as a person runs it who has a kitchen scale under the grip; prints the line that comes out.

usage: kitchen_scale.py SIMDEV_SOCKET WORD…    (what follows calibrate-force)

The scale shows what the arm's motors truly press with, to the gram, and the weight of the arm.
"""

import subprocess
import sys
import time

import simdev

ASKED = b"in grams: "
ARM_GRAM = 250
GRAM_PER_NEWTON = 1000 / 9.80665
SETTLED_S = 0.2  # the motors follow their command within milliseconds


def shown_gram(verbs):
    time.sleep(SETTLED_S)
    up_newton = verbs.say("status")["force_newton"][1]
    return round(ARM_GRAM - GRAM_PER_NEWTON * up_newton)


def main(path, *words):
    with simdev.Verbs(path) as verbs, subprocess.Popen(["thimble", "calibrate-force", *words], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                                       stderr=subprocess.PIPE) as person:
        said = b""
        while letter := person.stderr.read(1):
            said += letter
            if said.endswith(ASKED):
                person.stdin.write(b"%d g\n" % shown_gram(verbs))
                person.stdin.flush()
        sys.stderr.write(said.decode())
        print(person.stdout.read().decode(), end="")
    sys.exit(person.returncode)


if __name__ == "__main__":
    main(*sys.argv[1:])
