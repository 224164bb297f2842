# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""The one exception that the command line turns into a message, and how all converters read a file."""


class ConversionError(Exception):
    """The checkpoint cannot be read or converted; the text names the cause and, where there is one, the fix."""


def read_bytes(path, limit):
    """The bytes of a file. Raises ConversionError when it cannot be read or has more than `limit` bytes."""
    try:
        with open(path, "rb") as file:
            data = file.read(limit + 1)
    except OSError as error:
        raise ConversionError(f"{path}: {error.strerror}") from error
    if len(data) > limit:
        raise ConversionError(f"{path}: more than {limit >> 20} MiB, which no such file has")
    return data
