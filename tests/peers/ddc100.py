"""A Modbus master of pymodbus that reads the units of a simulated DDC-100 network.

usage: ddc100.py rtu|ascii PATH

Units 1 to 4 are an MX/DDC, a UEC-3-DDC, a clamshell and an I/O module. Prints one JSON object a
line: unit, what was asked, and registers, bits, exception or error.
"""
import json
import sys

from pymodbus import FramerType
from pymodbus.client import ModbusSerialClient
from pymodbus.exceptions import ModbusException

kind, place = sys.argv[1:3]
framer = FramerType.RTU if kind == "rtu" else FramerType.ASCII
client = ModbusSerialClient(place, framer=framer, baudrate=9600, timeout=2, retries=0)
assert client.connect(), "no connection"


def ask(unit, name, function, *args, **kwargs):
    answer = {"unit": unit, "ask": name}
    try:
        response = function(*args, device_id=unit, **kwargs)
        if response.isError():
            answer["exception"] = response.exception_code
        elif getattr(response, "registers", None):
            answer["registers"] = response.registers
        elif getattr(response, "bits", None):
            answer["bits"] = [bool(b) for b in response.bits]
        elif hasattr(response, "message"):
            message = response.message
            answer["message"] = list(message) if isinstance(message, (bytes, bytearray)) else message
        else:
            answer["done"] = True
    except ModbusException as error:
        answer["error"] = str(error)
    print(json.dumps(answer), flush=True)


c = client
# One relay of each: AS-1 of the MX, relay 3, relay 4, and relay K1 of the I/O module.
for unit, command in enumerate((2304, 2816, 3072, 2560), start=1):
    ask(unit, "engage", c.write_register, 0, command)
for unit in range(1, 5):
    ask(unit, "all", c.read_holding_registers, 0, count=56)
    ask(unit, "poll", c.read_holding_registers, 7, count=6)
    ask(unit, "input registers", c.read_input_registers, 7, count=2)
    ask(unit, "coils", c.read_coils, 0, count=9)
    ask(unit, "inputs", c.read_discrete_inputs, 128, count=80)
    ask(unit, "beyond", c.read_holding_registers, 300, count=1)
    ask(unit, "echo", c.diag_query_data, b"\xA5\xB6")
    ask(unit, "report", c.report_device_id)
ask(2, "open", c.write_register, 0, 256)
ask(2, "opening", c.read_holding_registers, 7, count=6)
ask(2, "opening coils", c.read_coils, 0, count=9)
ask(2, "stop", c.write_register, 0, 512)
ask(2, "stopped", c.read_holding_registers, 7, count=6)
ask(2, "stopped coils", c.read_coils, 0, count=9)
# Three requests to unit 2 and one to unit 1 after the counters were cleared.
ask(2, "clear", c.diag_clear_counters)
ask(2, "again", c.read_holding_registers, 8, count=1)
ask(1, "again", c.read_holding_registers, 8, count=1)
ask(2, "again report", c.report_device_id)
ask(2, "bus messages", c.diag_read_bus_message_count)
ask(2, "communication errors", c.diag_read_bus_comm_error_count)
ask(2, "exceptions", c.diag_read_bus_exception_error_count)
ask(2, "own messages", c.diag_read_device_message_count)
ask(9, "nobody", c.read_holding_registers, 7, count=6)
client.close()
