#!/bin/sh
# Two hosts on one machine: two network namespaces with a cable between them, a daemon in each, and
# one block that both arms push. Needs root (ip netns). Runs until Ctrl-C, or for SECONDS.
#   sudo examples/two_hosts.sh [SECONDS]
# In another terminal, as root:
#   thimble watch --socket /run/thimble-two-hosts/host.sock     the host that has the block
#   thimble watch --socket /run/thimble-two-hosts/guest.sock    the other one
set -eu
here=$(cd "$(dirname "$0")" && pwd)
daemon=${THIMBLED:-thimbled}
room=${ROOM:-/run/thimble-two-hosts}
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

# The datagrams of 1999 know no key: it is said to whom the host may speak, and that the guest may.
ip netns exec "$host" "$daemon" --config "$here/block-host.toml" \
  --set daemon.socket="$room/host.sock" --set world.listen=udp://10.68.0.1:5001 \
  --set world.allow_unauthenticated=true --set world.peer=10.68.0.2 &
host_pid=$!
ip netns exec "$guest" "$daemon" --config "$here/block-guest.toml" \
  --set daemon.socket="$room/guest.sock" --set arm.link=udp://10.68.0.1:5001 \
  --set arm.allow_unauthenticated=true &
guest_pid=$!
if [ $# -gt 0 ]; then
  sleep "$1" &
  wait $!
else
  wait
fi
