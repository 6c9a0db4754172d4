"""hart-protocol of PyPI as a second reader and writer of HART frames.

usage: hart.py < LINES

`read HEX`   a frame with its preamble; prints what its unpacker makes of it, null if nothing
`build NAME` a request that the package builds for the device 012345 of type 6EDD, in hexadecimal

One JSON value a line. It knows neither our decoder nor our tables.
"""
import json
import math
import sys

from hart_protocol import Unpacker, tools, universal

# With the type masked to six bits, as the link layer wants it; and as the package computes it.
MASKED = bytes([0x2E, 0xDD, 0x01, 0x23, 0x45])
OWN = tools.calculate_long_address(0x6E, 0xDD, bytes([0x01, 0x23, 0x45]))


class Port:
    """Bytes as a serial port offers them."""

    def __init__(self, data):
        self.data = data

    @property
    def in_waiting(self):
        return len(self.data)

    def read(self, count):
        taken, self.data = self.data[:count], self.data[count:]
        return taken


def plain(value):
    if isinstance(value, bytes):
        return value.hex()
    if isinstance(value, float):
        return None if math.isnan(value) else value
    return value


def read(text):
    for message in Unpacker(Port(bytes.fromhex(text))):
        return {key: plain(value) for key, value in message._asdict().items()}
    return None


def build(name):
    requests = {
        "read_unique_identifier": lambda: universal.read_unique_identifier(MASKED),
        "read_primary_variable": lambda: universal.read_primary_variable(MASKED),
        "read_loop_current": lambda: universal.read_loop_current_and_percent(MASKED),
        "read_dynamic_variables": lambda: universal.read_dynamic_variables_and_loop_current(MASKED),
        "read_message": lambda: universal.read_message(MASKED),
        "read_tag": lambda: universal.read_tag_descriptor_date(MASKED),
        "read_final_assembly": lambda: universal.read_final_assembly_number(MASKED),
        "own_address": lambda: universal.read_primary_variable(OWN),
        "tag": lambda: tools.pack_command(MASKED, 11, tools.pack_ascii("VALVE-01")),
        "descriptor": lambda: tools.pack_command(
            MASKED, 18, tools.pack_ascii("VALVE-01") + tools.pack_ascii("HART ACTUATOR   ") + bytes([27, 10, 109])
        ),
    }
    return requests[name]().hex()


for line in sys.stdin:
    word, argument = line.split()
    print(json.dumps({"read": read, "build": build}[word](argument)))
