# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Converts the network for person masks in TensorFlow Lite's format to ONNX."""
