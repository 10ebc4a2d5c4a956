"""Workbooks by openpyxl, and one of the older kind by xlwt, with the cells of the other program as text beside them.

python3 -m venv venv && venv/bin/pip install openpyxl==3.1.5 xlwt==1.3.0 && venv/bin/python testdata/golden/formats/workbook/make.py
"""
import datetime
import pathlib

import openpyxl
import xlwt

HERE = pathlib.Path(__file__).parent
START = datetime.datetime(2025, 7, 8, 23, 59, 59)


def rows(sensor, step, count):
    return [[round(0.01 + k * step, 3), *(round(sensor + 0.125 * k + axis, 3) for axis in range(3))] for k in range(count)]


# A sheet of each sensor, as the app phyphox exports, behind one of words.
book = openpyxl.Workbook()
book.active.title = "Metadata"
book.active.append(["property", "value"])
book.active.append(["version", "1.2"])
for name, unit, sensor, step, count in [("Gyroscope", "rad/s", 0.5, 0.02, 12), ("Accelerometer", "m/s^2", 9, 0.04, 6)]:
    sheet = book.create_sheet(name)
    sheet.append(["Time (s)", *(f"{name} {axis} ({unit})" for axis in "xyz")])
    for row in rows(sensor, step, count):
        sheet.append(row)
location = book.create_sheet("Location")
location.append(["Time (s)", "Latitude (°)", "Longitude (°)", "Height (m)"])
location.append([0.05, 48.125, 11.5, 520.25])
location.append([0.21, 48.25, 11.625, 521])
book.save(HERE / "sheets.xlsx")

# Dates across midnight, durations, a text with a comma, a number as text, an empty cell, and days from 1904.
for name, epoch in [("dates.xlsx", openpyxl.utils.datetime.WINDOWS_EPOCH), ("later.xlsx", openpyxl.utils.datetime.MAC_EPOCH)]:
    book = openpyxl.Workbook()
    book.epoch = epoch
    sheet = book.active
    sheet.append(["recorded, by hand"])
    sheet.append([])
    sheet.append(["date", "time", "elapsed", "lat", "note", "on"])
    for k in range(4):
        now = START + datetime.timedelta(milliseconds=625 * k)
        duration = datetime.timedelta(seconds=90000 + k)
        sheet.append([now, now.time(), duration, 48.125 + k, "a, b" if k else None, k % 2 == 0])
        sheet.cell(sheet.max_row, 3).number_format = "[h]:mm:ss"
    sheet.cell(5, 4).value = "49,125"
    book.save(HERE / name)

old = xlwt.Workbook()
sheet = old.add_sheet("Data")
for k, row in enumerate([["t", "x", "y", "z"], *rows(1, 0.01, 5)]):
    for column, value in enumerate(row):
        sheet.write(k, column, value)
old.save(str(HERE / "old.xls"))
