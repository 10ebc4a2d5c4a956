"""Navigates while driving: samples and fixes from two connections, the fixes late, the solution once a second.

    undrift sample logs
    python navigator.py logs/drive/drive.toml [PACE]
"""

from __future__ import annotations

import asyncio
import sys
from collections.abc import AsyncIterator

import undrift
from undrift import Event, Fix, Sample

LATE = 0.7  # How late fixes come [s].
Queue = asyncio.Queue["Sample | Fix | None"]


async def imu(drive: undrift.Drive, pace: float, queue: Queue) -> None:
    """In place of a sensor's driver: what it would read, when it would."""
    log, begin = drive.imu, asyncio.get_running_loop().time()
    for time, gyro, accel in zip(log.time, log.gyro, log.accel, strict=True):
        late = begin + (time - log.time[0]) / pace - asyncio.get_running_loop().time()
        await asyncio.sleep(max(0.0, late))
        await queue.put(Sample(time, gyro, accel))
    await queue.put(None)


async def gnss(drive: undrift.Drive, pace: float, queue: Queue) -> None:
    """In place of a receiver."""
    log, begin = drive.gnss, asyncio.get_running_loop().time()
    for k, time in enumerate(log.time):
        late = begin + (time + LATE - drive.imu.time[0]) / pace - asyncio.get_running_loop().time()
        await asyncio.sleep(max(0.0, late))
        await queue.put(Fix(time, **log.fix(k)))


async def items(queue: Queue) -> AsyncIterator[Sample | Fix]:
    while (item := await queue.get()) is not None:
        yield item


async def main(file: str, pace: float) -> None:
    drive = undrift.Drive.load(file)  # Model, lever arm, vehicle: as `undrift inspect` and `tune` wrote them.
    navigator, queue, shown = undrift.Navigator.from_drive(drive, horizon=2.0), Queue(100), 0.0
    async with asyncio.TaskGroup() as tasks:
        sources = [tasks.create_task(source(drive, pace, queue)) for source in (imu, gnss)]
        async for given in navigator.arun(items(queue)):
            if isinstance(given, Event):
                print(f"{given.time:8.1f} s  {given.text}")
            elif given.time >= shown + 1.0:
                shown = given.time
                north, east, _ = given.position_std
                print(f"{given.time:8.1f} s  {given.lat:.8f} {given.lon:.8f} rad, σ {north:.2f}, {east:.2f} m")
        sources[1].cancel()


asyncio.run(main(sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else 1.0))
