# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Writes checkpoints as torch.save() does, without PyTorch: a zip with a pickle that names torch's and YOLOv5's classes."""

import collections
import io
import pickle
import sys
import types
import zipfile

import numpy as np


class Tensor:
    """Pickles as torch's tensors do: a call of _rebuild_tensor_v2 on a storage."""

    def __init__(self, values, size=None, stride=None, offset=0):
        self.values = np.ascontiguousarray(values)
        self.size = self.values.shape if size is None else size
        strides = tuple(s // self.values.itemsize for s in self.values.strides)
        self.stride = strides if stride is None else stride
        self.offset = offset

    def __reduce__(self):
        arguments = (Storage(self.values), self.offset, self.size, self.stride, False, collections.OrderedDict())
        return _named("torch._utils", "_rebuild_tensor_v2"), arguments


class Storage:
    def __init__(self, values):
        self.values = values


def layer(class_name, children=None, parameters=None, buffers=None, module="models.common", **attributes):
    """An object of class `module`.`class_name`, as torch.nn.Module pickles itself."""
    instance = _named(module, class_name).__new__(_named(module, class_name))
    instance.__dict__.update(attributes)
    instance.__dict__["_modules"] = collections.OrderedDict(children or {})
    instance.__dict__["_parameters"] = collections.OrderedDict((k, Tensor(v)) for k, v in (parameters or {}).items())
    instance.__dict__["_buffers"] = collections.OrderedDict((k, Tensor(v)) for k, v in (buffers or {}).items())
    return instance


def save(checkpoint, path, prefix="archive"):
    """Writes `checkpoint` (dicts, lists, layers, Tensors) to `path`."""
    stream = io.BytesIO()
    pickler = _Pickler(stream, protocol=2)
    pickler.dump(checkpoint)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as archive:
        archive.writestr(f"{prefix}/data.pkl", stream.getvalue())
        for key, values in enumerate(pickler.storages):
            archive.writestr(f"{prefix}/data/{key}", values.tobytes())
        archive.writestr(f"{prefix}/version", "3\n")


class _Pickler(pickle.Pickler):
    TYPES = {"float32": "FloatStorage", "float16": "HalfStorage", "float64": "DoubleStorage", "int64": "LongStorage"}

    def __init__(self, *arguments, **options):
        super().__init__(*arguments, **options)
        self.storages = []

    def persistent_id(self, thing):
        if not isinstance(thing, Storage):
            return None
        self.storages.append(thing.values)
        storage_type = _named("torch", self.TYPES[thing.values.dtype.name])
        return ("storage", storage_type, str(len(self.storages) - 1), "cpu", thing.values.size)


def _named(module, name):
    """A class that pickles as module.name. The module exists only while these tests run."""
    parts = module.split(".")
    for depth in range(1, len(parts) + 1):
        package = ".".join(parts[:depth])
        stand_in = sys.modules.setdefault(package, types.ModuleType(package))
    if not hasattr(stand_in, name):
        setattr(stand_in, name, type(name, (), {"__module__": module}))
    return getattr(stand_in, name)
