"""A master of pymodbus that performs the handshake of the diagnostic objects by itself.

usage: dop.py tcp PORT | rtu PATH

Asks unit 1 of the simulator, which stands still and was given the tag MX-PEER. Everything here is
written from AIIOM000698-01, sections 2.1 and 3 to 8: it knows neither our decoder nor our tables.
Checks what the objects mean, and prints one JSON object: the registers of each request whose
registers do not change with time, so that others can be compared with them.
"""
import json
import math
import sys
import time

from pymodbus.client import ModbusSerialClient, ModbusTcpClient

REQUEST, INDICATORS, STATUS, COUNT, RESPONSE = 4000, 4010, 4014, 4015, 4100
BUSY, READY, ERROR = 1, 2, 3
UNIT = 1

kind, place = sys.argv[1:3]
if kind == "tcp":
    client = ModbusTcpClient("127.0.0.1", port=int(place), timeout=2, retries=0)
else:
    client = ModbusSerialClient(place, baudrate=38400, timeout=2, retries=0)
assert client.connect(), "no connection"


def read(address, count):
    answer = client.read_holding_registers(address, count=count, device_id=UNIT)
    assert not answer.isError(), answer
    return answer.registers


def fetch(word):
    """The handshake of section 2.1: a status and the registers."""
    answer = client.write_register(REQUEST, word, device_id=UNIT)
    assert not answer.isError(), answer
    until = time.monotonic() + 5
    seen = []
    while True:
        status = read(STATUS, 1)[0]
        # Section 2.1.3: eleven bits of object, and the status; here it begins at bit 12.
        assert status & 0x07FF == word & 0x07FF, hex(status)
        seen.append(status >> 12)
        if status >> 12 != BUSY:
            break
        assert time.monotonic() < until, "busy for ever"
        time.sleep(0.02)
    assert seen[0] == BUSY, "it takes 120 ms"
    if seen[-1] == ERROR:
        return ERROR, read(RESPONSE, 1)
    assert seen[-1] == READY, seen
    count = read(COUNT, 1)[0]
    assert count <= 512
    words = []
    while len(words) < count:
        words += read(RESPONSE + len(words), min(125, count - len(words)))
    return READY, words


def ready(word, size):
    status, words = fetch(word)
    assert status == READY, (hex(word), words)
    assert len(words) == size, (hex(word), len(words), size)
    return words


# Section 2.1.6: low word first; the first character in the low byte.
def u32(words, at):
    return words[at] | words[at + 1] << 16


def s32(words, at):
    value = u32(words, at)
    return value - (1 << 32) if value >> 31 else value


def s16(words, at):
    return words[at] - 0x10000 if words[at] >> 15 else words[at]


def s64(words, at):
    value = sum(words[at + n] << (16 * n) for n in range(4))
    return value - (1 << 64) if value >> 63 else value


def text(words, at, registers):
    data = b"".join(w.to_bytes(2, "little") for w in words[at : at + registers])
    return data.split(b"\0")[0].decode("ascii")


now = time.time()
lasting = {}

# Section 7.5: identification.
identity = ready(1006, 128)
assert text(identity, 0, 9) == "MX-PEER"
assert text(identity, 20, 5) == "2025-03-18"
assert text(identity, 63, 10).count(":") == 5
assert text(identity, 107, 3) == ""
lasting["1006"] = identity

# Section 7.4: the clock says what time it is, the battery three volts.
clock = ready(1007, 6)
assert abs(s64(clock, 0) - now) < 30, (s64(clock, 0), now)
assert 2500 < clock[4] < 3700
assert clock[5] & 2

# Sections 7.2 and 4.1: the runtime is the sum of all on-times; each contactor pulled in for each
# stroke, and the on-times of the bins are alike, for every stroke passes all of them.
operation = ready(1004, 23)
on_time = ready(0x00C9, 120)
opens, closes, runtime = u32(operation, 3), u32(operation, 5), u32(operation, 7)
seconds = [u32(on_time, 2 * n) for n in range(20)]
assert sum(seconds) == runtime, (sum(seconds), runtime)
assert len(set(seconds)) == 1
assert u32(operation, 1) % (opens + closes) == 0
assert abs(runtime / (opens + closes) - 12.5) < 0.1
assert s64(operation, 15) < now

# Sections 5.1 and 5.2: the summary of a stroke follows from its curve.
curves = {}
for option, at in [(0, 0), (1, 22), (2, 44), (3, 66)]:
    curve = ready(option << 12 | 401, 410)
    curves[option] = curve
    summary = ready(402, 88)
    maximum, minimum, average = curve[0:100], curve[100:200], curve[200:300]
    assert all(a > b > c for a, b, c in zip(maximum, average, minimum))
    assert all(0 < value < 1500 for value in curve[300:400])
    assert summary[at + 14] == sum(average) // 100
    assert summary[at + 18] == max(maximum[10:90])
    where = summary[at + 19] // 10
    assert 10 <= where < 90 and maximum[where] == max(maximum[10:90])
    assert s64(summary, at) == s64(curve, 400)
    assert s64(summary, at + 6) == s64(curve, 404)
    assert s64(curve, 404) - s64(curve, 400) == 12
    assert curve[408:] == ([0, 1000] if option < 2 else [1000, 0])
    assert (summary[at + 4], summary[at + 10]) == tuple(curve[408:])
lasting["4497"] = curves[1]
lasting["12689"] = curves[3]
# It runs heavier at 60 % than it did as new.
assert curves[0][260] > curves[1][260] + 20

# Section 3.1.4: the vector value is the length of the three axes.
vibration = ready(5, 14)
vector = math.isqrt(sum(s16(vibration, n) ** 2 for n in range(3)))
assert s32(vibration, 3) == vector

# Sections 3.1.1 and 6.1: as many points as the time scale has, the newest first; of a unit that
# is fourteen months old there are two years.
for object_id, series, points in [(1, 2, (24, 30, 12, 10)), (601, 3, (24, 30, 12, 10))]:
    for option, size in enumerate(points):
        length = 1 + 2 * series * size + 8
        words = ready(option << 12 | object_id, length)
        valid = 2 if option == 3 else size
        assert words[0] == valid, (object_id, option, words[0])
        start, end = s64(words, length - 8), s64(words, length - 4)
        assert start < end <= now + 30
        for point in range(size):
            most = s32(words, 1 + 2 * point)
            last = s32(words, 1 + 2 * size * (series - 1) + 2 * point)
            if point < valid:
                assert most > last, (object_id, option, point)
                if series == 3:
                    assert last > s32(words, 1 + 2 * size + 2 * point)
            else:
                assert most == last == 0

# Section 4.9: partial strokes that passed and failed, and when.
pst = ready(209, 26)
assert u32(pst, 0) > u32(pst, 6) > 0
assert pst[12] == 20 and pst[25] == 0
assert s64(pst, 21) == 0, "closing never failed"

# Section 3.1.6: the deviation indicator never tripped.
assert ready(0x2007, 29) == [0] * 29

# Sections 8.1 and 8.2: both logs from the newest record to the oldest.
for object_id, stride, when, total in [(1202, 27, 3, 420), (1203, 28, 2, 260)]:
    words = ready(object_id, 1 + 18 * stride)
    lasting[str(object_id)] = words
    times, ids, option = [], [], 0
    while words[0]:
        for record in range(words[0]):
            at = record * stride
            times.append(s64(words, when + at))
            ids.append(u32(words, 1 + at) if stride == 27 else words[1 + at])
            label = text(words, (8 if stride == 27 else 13) + at, 20 if stride == 27 else 16)
            assert label.isprintable() and label
        status, words = fetch(2 << 12 | object_id)
        assert status == READY and len(words) == 1 + words[0] * stride
    assert len(times) == total
    assert times == sorted(times, reverse=True)
    if stride == 27:
        assert ids == list(range(ids[0], ids[0] - total, -1))
    else:
        assert all((a - b) % 0x10000 == 1 for a, b in zip(ids, ids[1:]))
        assert min(ids) == 0 and max(ids) == 0xFFFF, "the ids come round"

# Section 2.1.3: what it does not have is error 3 or 1.
assert fetch(0x10CD) == (ERROR, [3])
assert fetch(0x4001) == (ERROR, [3])
assert fetch(0x0008) == (ERROR, [1])

# Section 2.1.2: user indicators, low word first, and the legacy bit that stands for all of them.
assert read(INDICATORS, 4) == [1 << 1 | 1 << 13, 0, 1 << 8, 0]
assert read(9, 1) == [1 << 7]

print(json.dumps(lasting))
client.close()
