# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Converts the graph model of NanoDet in TensorFlow.js's format to ONNX."""
