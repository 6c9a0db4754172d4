"""A cable: two pseudo terminals whose bytes go to each other. Prints both paths.

usage: ptys.py
"""
import os
import select
import time
import tty

ends = [os.openpty() for _ in range(2)]
for master, slave in ends:
    tty.setraw(slave)
    os.set_blocking(master, False)
print("ptys", os.ttyname(ends[0][1]), os.ttyname(ends[1][1]), flush=True)
masters = [ends[0][0], ends[1][0]]
until = time.monotonic() + 120
while time.monotonic() < until:
    ready, _, _ = select.select(masters, [], [], 1)
    for master in ready:
        other = masters[1 - masters.index(master)]
        os.write(other, os.read(master, 4096))
