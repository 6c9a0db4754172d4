"""A Modbus device of pymodbus: an independent answerer.

usage: server.py tcp PORT | rtu PATH | ascii PATH

Unit 7. Values follow from their address: holding = a * 31 + 7, input = a * 17 + 3, coils on where
a % 3 == 0, discrete inputs on where a % 5 == 0.
"""
import asyncio
import sys

from pymodbus import FramerType
from pymodbus.server import ModbusSerialServer, ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice


def device():
    holding = [(a * 31 + 7) & 0xFFFF for a in range(3989)]
    inputs = [(a * 17 + 3) & 0xFFFF for a in range(369)]
    coils = [a % 3 == 0 for a in range(16)]
    discrete = [a % 5 == 0 for a in range(32)]
    blocks = (
        [SimData(0, values=coils, datatype=DataType.BITS)],
        [SimData(0, values=discrete, datatype=DataType.BITS)],
        [SimData(0, values=holding, datatype=DataType.REGISTERS)],
        [SimData(0, values=inputs, datatype=DataType.REGISTERS)],
    )
    return SimDevice(7, simdata=blocks)


async def main(kind, place):
    if kind == "tcp":
        server = ModbusTcpServer(device(), address=("127.0.0.1", int(place)))
    else:
        framer = FramerType.RTU if kind == "rtu" else FramerType.ASCII
        server = ModbusSerialServer(device(), framer=framer, port=place, baudrate=38400)
    await server.serve_forever(background=True)
    print("ready", flush=True)
    # Nobody needs it longer; the test that started it ends it.
    await asyncio.sleep(120)


asyncio.run(main(*sys.argv[1:3]))
