# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Reads a PyTorch checkpoint (the zip format of torch >= 1.6) without PyTorch and without executing any code in it.

A pickle can call any function that it names. Here a name resolves to one of a few functions of this file, to an inert
Module that only keeps what it is given, or to an error: nothing of the file is ever imported or called.
"""

import collections
import io
import pickle
import re
import zipfile

import numpy as np

from .errors import ConversionError

MAX_ARCHIVE_BYTES = 2 << 30  # all entries, unpacked; a checkpoint of this family has 2 to 400 MB
STORAGE_TYPES = {
    "HalfStorage": np.float16,
    "FloatStorage": np.float32,
    "DoubleStorage": np.float64,
    "LongStorage": np.int64,
    "IntStorage": np.int32,
    "ShortStorage": np.int16,
    "CharStorage": np.int8,
    "ByteStorage": np.uint8,
    "BoolStorage": np.bool_,
}
# Packages whose classes may occur; they become inert Modules. Everything else is refused.
INERT_PACKAGES = re.compile(r"(torch|models|utils|yolov5|ultralytics|numpy|pathlib)(\.|$)")


class Module:
    """An object of the file: its class name and its saved state."""

    class_name = "Module"

    def __init__(self, *_arguments):
        self._state = {}

    def __setstate__(self, state):
        self._state = state if isinstance(state, dict) else {}

    def get(self, name, default=None):
        """A plain attribute, child module, parameter or buffer."""
        for group in ("_modules", "_parameters", "_buffers"):
            members = self._state.get(group)
            if isinstance(members, dict) and name in members:
                return members[name]
        return self._state.get(name, default)

    def require(self, name):
        """Like get(), but the attribute must exist."""
        value = self.get(name)
        if value is None:
            raise ConversionError(f"layer {self.class_name} has no '{name}': it is not the known layer of that name")
        return value

    def children(self):
        """Child modules in the order of the model."""
        members = self._state.get("_modules")
        return list(members.values()) if isinstance(members, dict) else []


class StorageType:
    """Stands for torch.FloatStorage and the like."""

    def __init__(self, name):
        self.name = name


def load_checkpoint(path):
    """The object that torch.save() wrote, with tensors as numpy arrays and all classes as Module."""
    try:
        with zipfile.ZipFile(path) as archive:
            return _load_archive(archive, path)
    except OSError as error:
        raise ConversionError(f"{path}: {error.strerror or error}") from error
    except zipfile.BadZipFile as error:
        raise ConversionError(f"{path}: not a checkpoint of torch 1.6 or later, or truncated ({error})") from error


def _load_archive(archive, path):
    entries = archive.infolist()
    if sum(entry.file_size for entry in entries) > MAX_ARCHIVE_BYTES:
        raise ConversionError(f"{path}: unpacks to more than {MAX_ARCHIVE_BYTES >> 30} GiB")
    names = [entry.filename for entry in entries if entry.filename.endswith("/data.pkl")]
    if len(names) != 1:
        raise ConversionError(f"{path}: a zip archive, but not a torch checkpoint (no data.pkl)")
    try:
        pickled = io.BytesIO(archive.read(names[0]))
        return _Unpickler(pickled, archive, names[0][: -len("data.pkl")]).load()
    except ConversionError as error:
        raise ConversionError(f"{path}: {error}") from error
    except Exception as error:  # a broken pickle can raise anything
        raise ConversionError(f"{path}: broken checkpoint ({type(error).__name__}: {error})") from error


class _Unpickler(pickle.Unpickler):
    """Resolves names to this file's own functions only."""

    def __init__(self, stream, archive, prefix):
        super().__init__(stream, encoding="latin1")
        self._archive = archive
        self._prefix = prefix
        self._classes = {}

    def find_class(self, module, name):
        known = _KNOWN_NAMES.get((module, name))
        if known is not None:
            return known
        if module == "torch" and name.endswith("Storage"):
            return StorageType(name)
        if not INERT_PACKAGES.match(module):
            raise ConversionError(f"refers to {module}.{name}, which no YOLOv5 checkpoint needs: refused")
        return self._classes.setdefault((module, name), type(name, (Module,), {"class_name": name}))

    def persistent_load(self, pid):
        """A storage: ("storage", type, key, device, element count)."""
        _, storage_type, key, _, count = pid
        if not isinstance(storage_type, StorageType) or storage_type.name not in STORAGE_TYPES:
            raise ConversionError(f"tensors of type {getattr(storage_type, 'name', storage_type)} are not supported")
        storage = np.frombuffer(self._archive.read(f"{self._prefix}data/{key}"), STORAGE_TYPES[storage_type.name])
        if storage.size < count:
            raise ConversionError(f"tensor data {key} is truncated: {storage.size} of {count} values")
        return storage


def _rebuild_tensor(storage, offset, size, stride, *_rest):
    """torch._utils._rebuild_tensor_v2, with the bounds checked: strides come from the file."""
    last = offset + sum((length - 1) * step for length, step in zip(size, stride))
    if len(size) != len(stride) or min((offset, *size, *stride)) < 0 or (0 not in size and last >= storage.size):
        raise ConversionError(f"tensor of shape {tuple(size)} lies outside its data")
    byte_strides = [step * storage.itemsize for step in stride]
    return np.lib.stride_tricks.as_strided(storage[offset:], size, byte_strides).copy()


def _rebuild_parameter(data, *_rest):
    return data


def _encode_latin1(text, encoding):
    """_codecs.encode, as pickle protocol 2 uses it for bytes."""
    return text.encode("latin1") if encoding == "latin1" else b""


_KNOWN_NAMES = {
    ("collections", "OrderedDict"): collections.OrderedDict,
    ("__builtin__", "set"): set,
    ("builtins", "set"): set,
    ("_codecs", "encode"): _encode_latin1,
    ("torch", "Size"): tuple,
    ("torch._utils", "_rebuild_tensor_v2"): _rebuild_tensor,
    ("torch._utils", "_rebuild_parameter"): _rebuild_parameter,
}
