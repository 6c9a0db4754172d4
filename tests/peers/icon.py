"""A Modbus master of pymodbus that reads what an ICON3000 offers beyond its registers.

usage: icon.py tcp PORT | rtu PATH

Reads every file (FC 20), the report (FC 17) and counters (FC 08) of unit 1, by itself: lengths, times,
codes and texts are computed here from the words by the tables of VCIOM-16345-EN, section 8.11. One JSON
object a line.
"""
import json
import sys
import time
from datetime import datetime, timedelta

from pymodbus.client import ModbusSerialClient, ModbusTcpClient
from pymodbus.pdu.file_message import FileRecord

kind, place = sys.argv[1:3]
if kind == "tcp":
    client = ModbusTcpClient("127.0.0.1", port=int(place), timeout=2, retries=0)
else:
    client = ModbusSerialClient(place, baudrate=38400, timeout=2, retries=0)
assert client.connect(), "no connection"


def say(**what):
    print(json.dumps(what), flush=True)


def files(*groups):
    """Words of each group (file, first record, records), or the code of an exception."""
    records = [
        FileRecord(file_number=f, record_number=r, record_length=2 * n) for f, r, n in groups
    ]
    response = client.read_file_record(records, device_id=1)
    if response.isError():
        return response.exception_code
    words = []
    for record in response.records:
        data = record.record_data
        words.append([int.from_bytes(data[i : i + 2], "big") for i in range(0, len(data), 2)])
    return words


def whole(file, count):
    """A stretch of a file from its first record, in parts of at most 100 records."""
    words = []
    while len(words) < count:
        part = files((file, len(words), min(100, count - len(words))))
        assert isinstance(part, list), f"file {file} gave exception {part}"
        words += part[0]
    return words


def date(words):
    return str(datetime(2000, 1, 1) + timedelta(seconds=words[0] << 16 | words[1]))


def signed(word):
    return word - 0x10000 if word & 0x8000 else word


def text(words):
    return b"".join(w.to_bytes(2, "big") for w in words).decode("ascii").strip()


class Reader:
    """Takes values off a list of words, by name."""

    def __init__(self, words):
        self.words, self.at, self.values = words, 0, {}

    def take(self, prefix, key, how, size=1, times=1):
        for index in range(times):
            part = self.words[self.at : self.at + size]
            assert len(part) == size, f"{key} ends too early"
            self.at += size
            if how is not None:
                self.values[f"{prefix}.{key}.{index}"] = how(part)


def number(words):
    return words[0]


def small(words):
    return signed(words[0])


def long(words):
    return words[0] << 16 | words[1]


TEMPERATURES = [("electronics_temperature", small), ("terminal_board_temperature", small),
                ("motor_temperature", small)]
# The layouts of section 8.11: head, then entry. Each value by name, how, words, and how many.
FST = ([("torque", small, 1, 101), ("time", date, 2)] + TEMPERATURES
       + [("voltage", number), ("stroke_time", number)], [])
PST = ([("t_pst_at", number, 1, 51), ("t_ret_at", number, 1, 50), ("time", date, 2)] + TEMPERATURES
       + [("efs_card_temperature", small), ("voltage", number), ("result", number),
          ("direction", number), ("t_pst", number), ("t_ret", number), ("ov_tr", number),
          ("travel_limit", number), ("mode", number), ("status", number),
          ("reset_conditions", long, 2)], [])
EFS = ([("t_efs_at", number, 1, 101), ("time", date, 2)] + TEMPERATURES
       + [("efs_card_temperature", small), ("voltage", number), ("reserved", None),
          ("direction", number)], [])
CARD = ([("card_code", text, 5), ("unused", None), ("week", text), ("year", text),
         ("serial_number", text, 3), ("revision", text, 5), ("free_text", text, 16)], [])
CODES = ([("count", number)], [("time", date, 2), ("code", number)])
SAMPLES = [("count", number), ("start", date, 2), ("memory_mode", number),
           ("sample_interval", number)]
LOGS = {
    2: CODES,
    3: CODES,
    4: ([("count", number)],
        [("level", number), ("device_id", text, 12), ("operator_id", text, 12), ("spare", None, 4),
         ("device", number), ("time", date, 2)]),
    5000: ([("count", number), ("start", date, 2), ("memory_mode", number)],
           [("time", date, 2), ("code", number), ("source", number), ("unused", None)]),
    5100: (SAMPLES, [("time", date, 2), ("electronics_temperature", small),
                     ("motor_temperature", small), ("voltage", number), ("unused", None)]),
    5200: (SAMPLES, [("time", date, 2), ("torque", small), ("motor_temperature", small),
                     ("voltage", number), ("unused", None)]),
}


def size(fields):
    return sum((f[2] if len(f) > 2 else 1) * (f[3] if len(f) > 3 else 1) for f in fields)


def tell(file, layout, count=0):
    head, entry = layout
    words = whole(file, size(head) + count * size(entry))
    reader = Reader(words)
    for field in head:
        reader.take("head", *field)
    for at in range(count):
        for field in entry:
            reader.take(f"entry{at + 1}", *field)
    assert reader.at == len(words)
    say(ask="file", file=file, words=words, values=reader.values)


def frame(*pdu):
    """An RTU frame of unit 1, with a CRC of our own."""
    frame = bytes([1, *pdu])
    crc = 0xFFFF
    for byte in frame:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ 0xA001 if crc & 1 else crc >> 1
    return frame + crc.to_bytes(2, "little")


# No command has been given yet: this one stops the programme of the simulated valve for a minute.
client.write_register(3008, 0, device_id=1)
for file, layout in LOGS.items():
    [[count]] = files((file, 0, 1))
    tell(file, layout, count)
stored = client.read_holding_registers(3511, count=4, device_id=1).registers
for first, count, layout in zip((1000, 2000, 3000, 3500), stored, (FST, FST, PST, EFS)):
    for file in range(first, first + count + 1):
        tell(file, layout)
    say(ask=f"beyond {first}", code=files((first + count + 1, 0, 1)))
for file in range(5300, 5305):
    tell(file, CARD)
say(ask="file", file=5, words=whole(5, 64), values={})
say(ask="reports", groups=files(*[(5300 + card, 0, 16) for card in range(5)]))
say(ask="beyond 5", code=files((5, 0, 65)))
say(ask="no such file", code=files((4321, 0, 1)))

ASK = [client.diag_read_bus_message_count, client.diag_read_bus_comm_error_count,
       client.diag_read_bus_exception_error_count, client.diag_read_device_message_count]


def counts():
    return [int(ask(device_id=1).message) for ask in ASK]


before = counts()
for _ in range(5):
    client.read_holding_registers(3004, count=1, device_id=1)
client.read_holding_registers(3988, count=2, device_id=1)
if kind != "tcp":
    # Two frames with a wrong CRC, each with the silence that ends it.
    for _ in range(2):
        damaged = bytearray(frame(3, 0x0B, 0xB8, 0, 1))
        damaged[-1] ^= 1
        client.socket.write(bytes(damaged))
        client.socket.flush()
        time.sleep(0.2)
after = counts()
registers = client.read_holding_registers(3531, count=6, device_id=1).registers
say(ask="counters", before=before, after=after, registers=registers)
if kind == "tcp":
    report = client.report_device_id(device_id=1)
    say(ask="report", hex=report.identifier.hex())
else:
    # Here pymodbus trusts the byte count, which is two too small; so bytes of our own.
    client.socket.reset_input_buffer()
    client.socket.write(frame(17))
    answer = client.socket.read(89)
    assert len(answer) == 89 and answer == frame(*answer[1:-2]), answer.hex()
    say(ask="report", hex=answer[3:-2].hex())
client.close()
