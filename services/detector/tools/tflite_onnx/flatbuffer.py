# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Reads tables of a FlatBuffers file. Every offset and length is checked before it is used."""

import struct

from yolov5_onnx.errors import ConversionError

MAX_ITEMS = 4096  # of a list of tables or whole numbers


class Table:
    """A table at `position`: a signed offset back to its vtable, which says where each field lies."""

    def __init__(self, data, position):
        self._data, self._position = data, position
        self._vtable = position - number(data, "<i", position)
        self._vtable_bytes = number(data, "<H", self._vtable)

    def integer(self, field, layout, default=0):
        """A number; fields that have their default value are not in the file."""
        place = self._place(field)
        return default if place is None else number(self._data, layout, place)

    def table(self, field):
        """The table that a field points to; None without one."""
        place = self._place(field)
        return None if place is None else Table(self._data, self._target(place))

    def tables(self, field):
        return [Table(self._data, self._target(place)) for place in self._items(field, 4)]

    def integers(self, field):
        """A list of 32-bit whole numbers."""
        return [number(self._data, "<i", place) for place in self._items(field, 4)]

    def bytes(self, field):
        """A list of bytes, also a text; empty without one. Not copied."""
        start, count = self._vector(field, 1)
        return self._data[start : start + count]

    def text(self, field):
        return bytes(self.bytes(field)).decode("utf-8", "replace")

    def _place(self, field):
        entry = 4 + 2 * field
        if entry + 2 > self._vtable_bytes:
            return None  # written before the field was invented
        offset = number(self._data, "<H", self._vtable + entry)
        return self._position + offset if offset else None

    def _target(self, place):
        return place + number(self._data, "<I", place)

    def _vector(self, field, item_bytes):
        place = self._place(field)
        if place is None:
            return 0, 0
        start = self._target(place)
        count = number(self._data, "<I", start)
        if count * item_bytes > len(self._data) - start - 4:
            raise ConversionError(f"truncated or damaged: a list at byte {start} has {count} items")
        return start + 4, count

    def _items(self, field, item_bytes):
        start, count = self._vector(field, item_bytes)
        if count > MAX_ITEMS:
            raise ConversionError(f"a list has {count} items, which no network for masks has")
        return range(start, start + count * item_bytes, item_bytes)


def number(data, layout, position):
    if not 0 <= position <= len(data) - struct.calcsize(layout):
        raise ConversionError(f"truncated or damaged: points to byte {position} of {len(data)}")
    return struct.unpack_from(layout, data, position)[0]


def root_table(data):
    return Table(data, number(data, "<I", 0))
