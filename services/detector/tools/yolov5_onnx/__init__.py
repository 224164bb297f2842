# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Converts YOLOv5 and YOLOv5-Lite checkpoints to ONNX with numpy and onnx only: no PyTorch, no code from the file.

    checkpoint.py   reads the .pt file (a zip with a pickle) into plain objects
    graph.py        an ONNX graph under construction that knows every tensor's shape
    layers.py       one function per layer type
    network.py      walks the layers of a model, writes the ONNX file, checks it
"""
