#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
"""Checks rtd-viewer with an independent WebSocket library and with raw sockets: check_server.py RTD

HTTP, subprotocols, Host, Origin and token; fragments, pings, close codes, broken frames; clients that are slow, idle,
many, or never finish their request. Exit code 77 = skipped: python3-websockets is not installed.
"""
import base64
import http.client
import importlib.metadata
import json
import os
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
import unittest

try:
    import asyncio

    import websockets
    import websockets.exceptions
except ImportError:
    print("SKIPPED: python3-websockets is not installed; deploy/setup.sh installs it")
    sys.exit(77)

RTD = sys.argv.pop(1)
DOMAIN = os.environ.get("RTD_TEST_DOMAIN", "91")
FOXGLOVE, PAGE = "foxglove.sdk.v1", "rtd.viewer.v1"
# Version 14 of websockets has other names.
RENAMED = int(importlib.metadata.version("websockets").split(".")[0]) >= 14
HEADERS = "additional_headers" if RENAMED else "extra_headers"
Refused = websockets.exceptions.InvalidStatus if RENAMED else websockets.exceptions.InvalidStatusCode


def status_of(refused):
    return refused.response.status_code if RENAMED else refused.status_code


class Process:
    """A command whose output is read until it says what is waited for."""

    def __init__(self, *arguments):
        self.process = subprocess.Popen([RTD, *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.lines = []
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def _read(self):
        self.lines.extend(self.process.stdout)  # line by line

    def wait_for(self, pattern, seconds=20):
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            found = next(filter(None, (re.search(pattern, line) for line in list(self.lines))), None)
            if found:
                return found
            time.sleep(0.02)
        raise AssertionError(f"'{pattern}' was not printed: {''.join(self.lines)}")

    def stop(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        code = self.process.wait(timeout=20)
        self.reader.join(5)
        return code


def memory_mb(pid):
    with open(f"/proc/{pid}/status") as status:
        return int(re.search(r"VmRSS:\s+(\d+)", status.read()).group(1)) / 1024


class Viewer(Process):
    def __init__(self, *more):
        super().__init__("viewer", "--port", "0", "--domain", DOMAIN, *more)
        self.port = int(self.wait_for(r"viewer: http://[^/ ]*:(\d+)/").group(1))

    def get(self, path="/", method="GET", **headers):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=5)
        connection.request(method, path, headers=headers)
        response = connection.getresponse()
        answer = response.status, response.read(), dict(response.getheaders())
        connection.close()
        return answer

    def connect(self, subprotocol, path="/", **more):
        return websockets.connect(f"ws://127.0.0.1:{self.port}{path}", subprotocols=[subprotocol], max_size=None, **more)

    def raw(self):
        return socket.create_connection(("127.0.0.1", self.port), timeout=5)

    def raw_websocket(self, subprotocol=FOXGLOVE):
        """A socket after the handshake, of which frames are written by hand."""
        connection = self.raw()
        key = base64.b64encode(os.urandom(16)).decode()
        connection.sendall((f"GET / HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                            f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n"
                            f"Sec-WebSocket-Protocol: {subprotocol}\r\n\r\n").encode())
        head = b""
        while b"\r\n\r\n" not in head:
            head += connection.recv(1)
        assert b"101" in head.split(b"\r\n")[0], head
        return connection


def frame(opcode, payload=b"", final=True, masked=True, reserved=0):
    first = (0x80 if final else 0) | reserved | opcode
    size = len(payload)
    head = struct.pack("!B", first)
    mask_bit = 0x80 if masked else 0
    if size < 126:
        head += struct.pack("!B", mask_bit | size)
    elif size < 65536:
        head += struct.pack("!BH", mask_bit | 126, size)
    else:
        head += struct.pack("!BQ", mask_bit | 127, size)
    if not masked:
        return head + payload
    mask = os.urandom(4)
    return head + mask + bytes(byte ^ mask[place % 4] for place, byte in enumerate(payload))


def read_frames(connection, seconds=5):
    """Yields (opcode, payload) of what the server sends until it closes."""
    connection.settimeout(seconds)
    buffer = b""

    def take(count):
        nonlocal buffer
        while len(buffer) < count:
            more = connection.recv(65536)
            if not more:
                raise EOFError
            buffer += more
        taken, buffer = buffer[:count], buffer[count:]
        return taken

    try:
        while True:
            first, second = take(2)
            size = second & 0x7F
            if size == 126:
                size = struct.unpack("!H", take(2))[0]
            elif size == 127:
                size = struct.unpack("!Q", take(8))[0]
            yield first & 0x0F, take(size)
    except (EOFError, ConnectionResetError):
        return


def close_code(connection):
    for opcode, payload in read_frames(connection):
        if opcode == 8:
            return struct.unpack("!H", payload[:2])[0] if len(payload) >= 2 else None
    return None


class ViewerTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.viewer = Viewer()
        cls.camera = Process("camera", "--source", "synthetic:office?frames=0", "--domain", DOMAIN, "--wait-for", "none")

    @classmethod
    def tearDownClass(cls):
        camera, code = cls.camera.stop(), cls.viewer.stop()
        assert camera in (0, 130), f"camera: exit code {camera}"
        assert code == 0, f"exit code {code}: {''.join(cls.viewer.lines)}"

    def test_pages(self):
        status, body, headers = self.viewer.get()
        self.assertEqual(status, 200)
        self.assertIn(b"<title>", body)
        self.assertIn("default-src 'self'", headers["Content-Security-Policy"])
        self.assertEqual(self.viewer.get("/three/build/three.module.js")[0], 200)
        self.assertEqual(self.viewer.get(method="HEAD")[:2], (200, b""))
        self.assertEqual(self.viewer.get("/../../etc/passwd")[0], 404)
        self.assertEqual(self.viewer.get("/three/../../../../etc/passwd.js")[0], 404)
        self.assertEqual(self.viewer.get(method="POST")[0], 405)
        self.assertEqual(self.viewer.get(Host="evil.example")[0], 403)
        self.assertEqual(self.viewer.get(Cookie="x" * 20000)[0], 431)
        self.assertEqual(self.viewer.get("/access")[0], 200)

    def test_metrics_and_health(self):
        until = time.monotonic() + 20
        while b'service="camera"' not in self.viewer.get("/metrics")[1]:
            self.assertLess(time.monotonic(), until, "no heartbeat of the camera in /metrics")
            time.sleep(0.1)
        status, text, headers = self.viewer.get("/metrics")
        self.assertEqual((status, headers["Content-Type"]), (200, "text/plain; version=0.0.4; charset=utf-8"))
        up = re.search(rb'rtd_service_up\{robot="",service="camera",host="([^"]+)"\} 1\n', text)
        self.assertEqual(up.group(1).decode(), socket.gethostname())
        self.assertEqual(text.count(b"# TYPE rtd_service_up "), 1)
        self.check_with_promtool(text)
        status, body, _ = self.viewer.get("/healthz")
        health = json.loads(body)
        self.assertEqual((status, health["status"]), (200, "ok"), health)
        self.assertIn("camera", [service["service"] for service in health["services"]])
        self.assertEqual(self.viewer.get("/metrics", Host="evil.example")[0], 403)

    def check_with_promtool(self, text):
        promtool = shutil.which("promtool")
        if promtool is None:
            print("promtool is not installed (Debian package prometheus): the format was not checked by it")
            return
        checked = subprocess.run([promtool, "check", "metrics"], input=text, capture_output=True, check=False)
        self.assertEqual(checked.returncode, 0, checked.stderr.decode() + text.decode())

    def test_two_requests_on_one_connection(self):
        connection = http.client.HTTPConnection("127.0.0.1", self.viewer.port, timeout=5)
        for _ in range(2):
            connection.request("GET", "/")
            self.assertEqual(connection.getresponse().read()[:1], b"<")
        connection.close()

    def test_subprotocols_and_origins(self):
        async def check():
            for name in ("foxglove.sdk.v1", "foxglove.websocket.v1", PAGE):
                async with self.viewer.connect(name) as client:
                    self.assertEqual(client.subprotocol, name)
            both = ["foxglove.websocket.v1", "foxglove.sdk.v1"]
            async with websockets.connect(f"ws://127.0.0.1:{self.viewer.port}", subprotocols=both) as client:
                self.assertEqual(client.subprotocol, both[0])
            for more, status in (({"subprotocols": ["other"]}, 400),
                                 ({"subprotocols": [FOXGLOVE], "origin": "https://evil.example"}, 403)):
                with self.assertRaises(Refused) as refused:
                    await websockets.connect(f"ws://127.0.0.1:{self.viewer.port}", **more)
                self.assertEqual(status_of(refused.exception), status)

        asyncio.run(check())

    def test_only_who_knows_the_token_calls_commands_on_loopback(self):
        token = self.viewer.wait_for(r"token=(\w+)").group(1)

        async def check():
            for path, control in (("/live", False), ("/live?token=wrong", False), (f"/live?token={token}", True)):
                async with self.viewer.connect(PAGE, path) as page:
                    hello = json.loads(await page.recv())
                    self.assertEqual((hello["type"], hello["control"]), ("hello", control), path)
                    call = {"op": "call", "id": 1, "robot": 99, "name": "/slam/save_map", "argument": "room"}
                    await page.send(json.dumps(call))
                    answer = ""
                    while '"answer"' not in answer:
                        answer = await asyncio.wait_for(page.recv(), 10)
                        answer = answer if isinstance(answer, str) else ""
                    self.assertIn("this robot is unknown" if control else "?token=", answer)
            for path, offered in (("/", False), (f"/?token={token}", True)):
                async with self.viewer.connect(FOXGLOVE, path) as client:
                    info = json.loads(await client.recv())
                    self.assertEqual("services" in info["capabilities"], offered, path)

        asyncio.run(check())

    def test_a_token_is_asked_for_on_other_interfaces(self):
        viewer = Viewer("--bind", "0.0.0.0", "--robot", "tokentest")
        token = viewer.wait_for(r"token=(\w+)").group(1)

        async def check():
            async with viewer.connect(PAGE, f"/live?token={token}") as page:
                look_token = json.loads(await page.recv())["look_token"]
            async with viewer.connect(PAGE, f"/live?token={look_token}") as page:
                self.assertFalse(json.loads(await page.recv())["control"])
            async with viewer.connect(FOXGLOVE, **{HEADERS: {"Authorization": f"Bearer {token}"}}):
                pass
            for path in ("/live", "/live?token=wrong"):
                with self.assertRaises(Refused) as refused:
                    await viewer.connect(PAGE, path)
                self.assertEqual(status_of(refused.exception), 401)

        asyncio.run(check())
        self.assertEqual(viewer.get("/access?token=wrong")[0], 401)
        self.assertEqual(viewer.get("/metrics")[0], 401)
        self.assertEqual(viewer.get("/metrics", Authorization=f"Bearer {token}")[0], 200)
        self.assertEqual(viewer.stop(), 0)

    def test_a_taken_port_is_named(self):
        other = Process("viewer", "--port", str(self.viewer.port), "--domain", DOMAIN, "--robot", "porttest")
        self.assertEqual(other.process.wait(timeout=20), 2)
        other.reader.join(5)
        self.assertIn(str(self.viewer.port), "".join(other.lines))
        self.assertIn("--port", "".join(other.lines))

    def test_a_foxglove_client_gets_messages(self):
        async def check():
            async with self.viewer.connect(FOXGLOVE) as client:
                info = json.loads(await client.recv())
                self.assertEqual(info["op"], "serverInfo")
                channels = {}
                while "/camera/color/image_raw/compressed" not in channels:
                    message = await asyncio.wait_for(client.recv(), 10)
                    if isinstance(message, str) and json.loads(message)["op"] == "advertise":
                        channels |= {channel["topic"]: channel for channel in json.loads(message)["channels"]}
                for channel in channels.values():
                    self.assertEqual((channel["encoding"], channel["schemaEncoding"]), ("cdr", "ros2msg"), channel)
                    self.assertTrue(channel["schema"], channel)
                wanted = channels["/camera/color/image_raw/compressed"]["id"]
                text = json.dumps({"op": "subscribe", "subscriptions": [{"id": 7, "channelId": wanted}]})
                await client.send([text[:10], text[10:20], text[20:]])  # three fragments
                while True:
                    message = await asyncio.wait_for(client.recv(), 10)
                    if isinstance(message, bytes) and message[0] == 1:
                        break
                subscription, stamp = struct.unpack("<IQ", message[1:13])
                self.assertEqual(subscription, 7)
                self.assertLess(abs(stamp * 1e-9 - time.time()), 5)
                self.assertIn(b"\xff\xd8\xff", message[13:200], "the JPEG of a CompressedImage")

        asyncio.run(check())

    def test_pings_and_closes(self):
        async def check():
            async with self.viewer.connect(FOXGLOVE) as client:
                await asyncio.wait_for(await client.ping(b"payload"), 5)
                await client.close(1000, "done")
                self.assertEqual(client.close_code, 1000)

        asyncio.run(check())

    def test_broken_frames_are_answered_with_their_close_code(self):
        for broken, code in ((frame(1, b"{}", masked=False), 1002), (frame(1, b"{}", reserved=0x40), 1002),
                             (frame(9, b"x", final=False), 1002), (frame(9, b"x" * 126), 1002),
                             (frame(3, b"x"), 1002), (frame(0, b"rest"), 1002), (frame(1, b"\xff\xfe"), 1007),
                             (frame(1, b"x" * 70_000), 1009)):
            connection = self.viewer.raw_websocket()
            connection.sendall(broken)
            self.assertEqual(close_code(connection), code, broken[:8])
            connection.close()

    def test_a_message_in_single_bytes_and_with_a_ping_between(self):
        connection = self.viewer.raw_websocket(PAGE)
        parts = frame(1, b'{"op":"ping",', final=False) + frame(9, b"hi") + frame(0, b'"sent_ms":42}')
        for byte in parts:
            connection.sendall(bytes([byte]))
        seen = set()
        for opcode, payload in read_frames(connection):
            if opcode == 10:
                seen.add(payload)
            if opcode == 1 and b'"pong"' in payload:
                self.assertIn(b"42", payload)
                seen.add("pong")
            if len(seen) == 2:
                break
        connection.close()

    def rate_of(self, seconds):
        """Messages per second that a well-behaved page gets."""

        async def count():
            async with self.viewer.connect(PAGE, "/live") as client:
                until, images = time.monotonic() + seconds, 0
                while time.monotonic() < until:
                    message = await asyncio.wait_for(client.recv(), 5)
                    images += isinstance(message, bytes) and message[0] == 8
                return images / seconds

        return asyncio.run(count())

    def test_slow_idle_and_unfinished_clients_cost_the_others_nothing(self):
        self.viewer.get()
        before = memory_mb(self.viewer.process.pid)
        slow = [self.viewer.raw_websocket() for _ in range(5)]
        for connection in slow:  # it asks for all, and reads nothing
            connection.sendall(frame(1, json.dumps({"op": "subscribe", "subscriptions": [
                {"id": channel, "channelId": channel} for channel in range(1, 20)]}).encode()))
        idle = [self.viewer.raw_websocket(PAGE) for _ in range(50)] + [self.viewer.raw() for _ in range(50)]
        unfinished = [self.viewer.raw() for _ in range(300)]
        for connection in unfinished:
            try:
                connection.sendall(b"GET / HTTP/1.1\r\nHost: ")
            except OSError:
                pass  # the oldest are closed when there are too many
        self.assertGreater(self.rate_of(3), 5)
        self.assertEqual(self.viewer.get()[0], 200)
        grown = memory_mb(self.viewer.process.pid) - before
        print(f"memory: {before:.0f} MB and {grown:.0f} MB more with 405 bad clients")
        self.assertLess(grown, 150)
        for connection in slow + idle + unfinished:
            connection.close()

    def test_a_thousand_connections_in_a_second(self):
        before, begin = memory_mb(self.viewer.process.pid), time.monotonic()
        for _ in range(1000):
            self.viewer.raw().close()
        took = time.monotonic() - begin
        self.assertEqual(self.viewer.get()[0], 200)
        grown = memory_mb(self.viewer.process.pid) - before
        print(f"1000 connections in {took:.2f} s, {grown:.1f} MB more")
        self.assertLess(grown, 20)


if __name__ == "__main__":
    unittest.main(verbosity=2)
