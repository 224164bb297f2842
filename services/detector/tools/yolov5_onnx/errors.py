# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""The one exception that the command line turns into a message."""


class ConversionError(Exception):
    """The checkpoint cannot be read or converted; the text names the cause and, where there is one, the fix."""
