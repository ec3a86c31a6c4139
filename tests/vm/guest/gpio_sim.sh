#!/bin/sh
# In a Debian of its own: gpio-sim as a module for the kernel that comes with it, of Debian's sources of that kernel (decision 0517). Its chip simulates interrupts with irq_sim, which Debian leaves
# out, too; the one function there that the kernel keeps from modules has one that asks the same.
set -e
cd "$(mktemp -d)"
tar --strip-components=1 -xf /usr/src/linux-source-*.tar.xz --wildcards '*/drivers/gpio/gpio-sim.c' '*/drivers/gpio/gpiolib.h' '*/kernel/irq/irq_sim.c'
cp drivers/gpio/* kernel/irq/* .
sed -i 's/handle_simple_irq(irq_to_desc(\(.*\)))/generic_handle_irq(\1)/' irq_sim.c
printf 'obj-m := gpio_sim.o\ngpio_sim-y := gpio-sim.o irq_sim.o\n' > Kbuild
make -s -C /lib/modules/*-amd64/build M="$PWD" modules 2> errors || { cat errors; exit 1; }
strip -g gpio_sim.ko
cp gpio_sim.ko /gpio_sim.ko
