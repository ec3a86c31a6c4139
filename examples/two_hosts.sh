#!/bin/sh
# Two hosts on one machine: two network namespaces with a cable between them, a daemon in each, and
# one block that both arms push; or two arms that are coupled to each other. Needs root (ip netns).
# Runs until Ctrl-C, or for SECONDS.
#   sudo examples/two_hosts.sh [block | teleoperation [COUPLING]] [SECONDS]
# COUPLING: wave or spring-damper at both, or ghost-point at the arm that moves, with spring-damper
# at the one that is drawn along. Not said: as the files say, wave.
# In another terminal, as root:
#   thimble watch --socket /run/thimble-two-hosts/host.sock     the host that has the block, or waits
#   thimble watch --socket /run/thimble-two-hosts/guest.sock    the other one
set -eu
here=$(cd "$(dirname "$0")" && pwd)
# sudo has a PATH of its own: in a clone the one that was built there is taken.
built=$here/../build/release/bin/thimbled
if [ -x "$built" ]; then daemon=${THIMBLED:-$built}; else daemon=${THIMBLED:-thimbled}; fi
if ! command -v "$daemon" >/dev/null; then
  echo "two_hosts.sh: there is no $daemon; build it (./run build), or name it: THIMBLED=FILE" >&2
  exit 1
fi
room=${ROOM:-/run/thimble-two-hosts}
scene=block
case ${1:-} in block | teleoperation) scene=$1 && shift ;; esac
guest_scheme=
case $scene:${1:-} in
  teleoperation:wave | teleoperation:spring-damper | teleoperation:ghost-point)
    guest_scheme=$1 && shift
    ;;
esac
host_scheme=$guest_scheme
if [ "$guest_scheme" = ghost-point ]; then host_scheme=spring-damper; fi
host=thimble-host-$$
guest=thimble-guest-$$
if [ "$(id -u)" -ne 0 ]; then
  echo "two_hosts.sh: needs root, to make network namespaces" >&2
  exit 1
fi

host_pid=
guest_pid=
clean_up() {
  for pid in $guest_pid $host_pid; do kill "$pid" 2>/dev/null || true; done
  for pid in $guest_pid $host_pid; do wait "$pid" 2>/dev/null || true; done
  ip netns del "$guest" 2>/dev/null || true
  ip netns del "$host" 2>/dev/null || true
}
trap clean_up EXIT
trap 'exit 0' INT TERM

mkdir -p "$room"
ip netns add "$host"
ip netns add "$guest"
ip link add cable0 netns "$host" type veth peer name cable0 netns "$guest"
ip -n "$host" address add 10.68.0.1/24 dev cable0
ip -n "$guest" address add 10.68.0.2/24 dev cable0
for side in "$host" "$guest"; do
  ip -n "$side" link set lo up
  ip -n "$side" link set cable0 up
done

seconds=${1:-}
place=udp://10.68.0.1:5001
key=$room/link.key
rm -f "$key" # of a run before, perhaps with other rights
(umask 077 && od -An -N32 -tx1 /dev/urandom | tr -d ' \n' >"$key")
listener=arm
if [ "$scene" = block ]; then listener=world; fi
ip netns exec "$host" "$daemon" --config "$here/$scene-host.toml" \
  --set daemon.socket="$room/host.sock" --set $listener.listen=$place \
  --set $listener.key_file="$key" ${host_scheme:+--set "arm.coupling.scheme=$host_scheme"} &
host_pid=$!
ip netns exec "$guest" "$daemon" --config "$here/$scene-guest.toml" \
  --set daemon.socket="$room/guest.sock" --set arm.link=$place \
  --set arm.key_file="$key" ${guest_scheme:+--set "arm.coupling.scheme=$guest_scheme"} &
guest_pid=$!
if [ -n "$seconds" ]; then
  sleep "$seconds" &
  wait $!
else
  wait
fi
