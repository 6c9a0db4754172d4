"""A Modbus master of pymodbus that reads what an ICON3000 offers beyond its registers.

usage: icon.py tcp PORT | rtu PATH

Reads files (FC 20), the report (FC 17) and counters (FC 08) of unit 1, by itself: the lengths of the
logs are computed here from the number of their entries. One JSON object a line.
"""
import json
import sys

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


def log(file, entry):
    """All entries of a log whose first record is their number."""
    [[count]] = files((file, 0, 1))
    entries = []
    for at in range(count):
        [words] = files((file, 1 + at * entry, entry))
        entries.append(words)
    return entries


say(ask="alarms", entries=log(2, 3))
say(ask="warnings", entries=log(3, 3))
say(ask="reports", groups=files(*[(5300 + card, 0, 16) for card in range(5)]))
say(ask="curve", groups=files((1000, 0, 108)))
say(ask="no such file", groups=files((4321, 0, 1)))

before = client.diag_read_bus_message_count(device_id=1).message
for _ in range(5):
    client.read_holding_registers(3004, count=1, device_id=1)
client.read_holding_registers(3988, count=2, device_id=1)
after = client.diag_read_bus_message_count(device_id=1).message
say(ask="messages", before=int(before), after=int(after))
if kind == "tcp":
    # On a serial line pymodbus trusts the byte count, which is two too small.
    report = client.report_device_id(device_id=1)
    say(ask="report", hex=report.identifier.hex())
client.close()
