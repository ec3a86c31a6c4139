#!/bin/sh
# In a Debian of its own: libgpiod 2, which for Debian 12 its backports have, into /libgpiod2: the header, and the library (decision 0518).
set -e
echo 'deb http://deb.debian.org/debian bookworm-backports main' > /etc/apt/sources.list.d/backports.list
apt-get -qq update
DEBIAN_FRONTEND=noninteractive apt-get -qq -y install --no-install-recommends libgpiod-dev/bookworm-backports libgpiod3/bookworm-backports > /dev/null
mkdir /libgpiod2
cp /usr/include/gpiod.h /usr/lib/*/libgpiod.so.3 /libgpiod2
