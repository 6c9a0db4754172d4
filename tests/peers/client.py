"""A Modbus master of pymodbus: an independent asker.

usage: client.py tcp PORT | rtu PATH

Asks unit 1 and prints one JSON object a line: what was asked, and registers, bits, exception or
error.
"""
import json
import sys

from pymodbus.client import ModbusSerialClient, ModbusTcpClient
from pymodbus.exceptions import ModbusException

kind, place = sys.argv[1:3]
if kind == "tcp":
    client = ModbusTcpClient("127.0.0.1", port=int(place), timeout=2, retries=0)
else:
    client = ModbusSerialClient(place, baudrate=38400, timeout=2, retries=0)
assert client.connect(), "no connection"


def ask(name, function, *args, **kwargs):
    answer = {"ask": name}
    try:
        response = function(*args, device_id=1, **kwargs)
        if response.isError():
            answer["exception"] = response.exception_code
        elif getattr(response, "registers", None):
            answer["registers"] = response.registers
        elif getattr(response, "bits", None):
            answer["bits"] = [bool(b) for b in response.bits]
        elif hasattr(response, "identifier"):
            answer["identifier"] = response.identifier.hex()
        elif hasattr(response, "message"):
            message = response.message
            if isinstance(message, (bytes, bytearray)):
                message = list(message)
            answer["message"] = message
        else:
            answer["done"] = True
    except ModbusException as error:
        answer["error"] = str(error)
    print(json.dumps(answer), flush=True)


c = client
ask("actuator id", c.read_holding_registers, 44, count=2)
ask("identifier", c.read_holding_registers, 3000, count=1)
ask("position", c.read_holding_registers, 3004, count=1)
ask("clock", c.read_holding_registers, 3023, count=4)
ask("whole block", c.read_holding_registers, 3000, count=125)
ask("last register", c.read_holding_registers, 3988, count=1)
ask("beyond the last", c.read_holding_registers, 3988, count=2)
ask("password", c.read_holding_registers, 3483, count=4)
ask("input position", c.read_input_registers, 0, count=1)
ask("curve", c.read_input_registers, 113, count=64)
ask("beyond the last input", c.read_input_registers, 368, count=2)
ask("coils", c.read_coils, 0, count=11)
ask("too many coils", c.read_coils, 0, count=12)
ask("beyond the last coil", c.read_coils, 10, count=2)
ask("discrete", c.read_discrete_inputs, 0, count=32)
ask("too many discrete", c.read_discrete_inputs, 0, count=33)
ask("coil that is not there", c.write_coil, 11, True)
ask("register out of range", c.write_register, 1, 1001)
ask("mask write", c.mask_write_register, address=0, and_mask=0xFFFF, or_mask=0)
ask("echo", c.diag_query_data, b"\xA5\xB6")
ask("restart", c.diag_restart_communication, False)
ask("report", c.report_device_id)
client.close()
