"""A render that is looked at while it runs: --preview, --status and --display-server."""
import json
import signal
import socket
import struct
import subprocess
import threading
import time
import unittest

from command import CommandTest, main


class Listener:
    """Takes what a render sends, as tev does, and puts the image together."""

    def __init__(self):
        self.server = socket.create_server(("localhost", 0))
        self.place = f"localhost:{self.server.getsockname()[1]}"
        self.created, self.planes, self.updates = None, {}, 0
        self.thread = threading.Thread(target=self.listen)
        self.thread.start()

    def listen(self):
        connection, _ = self.server.accept()
        with connection, connection.makefile("rb") as stream:
            while header := stream.read(4):
                self.take(stream.read(struct.unpack("<I", header)[0] - 4))

    def take(self, message):
        text = message[2:]

        def name():
            nonlocal text
            word, text = text.split(b"\0", 1)
            return word.decode()

        def numbers(count):
            nonlocal text
            found, text = struct.unpack_from(f"<{count}i", text), text[4 * count:]
            return found

        if message[0] == 4:
            image, (width, height, count) = name(), numbers(3)
            self.created = (image, width, height, [name() for _ in range(count)])
            self.planes = {channel: [None] * (width * height) for channel in self.created[3]}
        else:
            assert message[0] == 3, message[0]
            image, channel, (x, y, width, height) = name(), name(), numbers(4)
            assert (image, x, width) == (self.created[0], 0, self.created[1])
            self.planes[channel][y * width:(y + height) * width] = struct.unpack(f"<{width * height}f", text)
            self.updates += 1

    def finish(self):
        self.thread.join(30)
        self.server.close()


class WatchTest(CommandTest):
    def begin(self, *arguments):
        """A long render, which is ended with the test."""
        process = subprocess.Popen([self.command, "render", "scene.json", "--spp", "100000000", "--quiet", *map(str, arguments)],
                                   cwd=self.folder, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def await_file(self, name, is_good):
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline:
            try:
                content = (self.folder / name).read_bytes()
                if is_good(content):
                    return content
            except FileNotFoundError:
                pass
            time.sleep(0.05)
        return self.fail(f"{name} did not come to be as it should")

    def test_a_preview_is_there_while_the_render_goes_on_and_in_the_end_is_its_image(self):
        process = self.begin("--preview", "preview.pfm")
        first = self.await_file("preview.pfm", lambda content: len(content) > 8 * 6 * 12)
        self.await_file("preview.pfm", lambda content: content != first)
        self.assertIsNone(process.poll())
        self.run_well("render", "scene.json", "--spp", 40, "--preview", "end.pfm", "-o", "image.pfm", "--quiet")
        self.assertEqual((self.folder / "end.pfm").read_bytes(), (self.folder / "image.pfm").read_bytes())

    def test_looking_changes_no_bit(self):
        plain = self.stats("--spp", 20)["hash"]
        for engine in ("recursive", "wavefront"):
            self.assertEqual(self.stats("--spp", 20, "--engine", engine, "--preview", "p.png", "--status", "s.json")["hash"], plain)

    def test_a_status_says_what_is_left(self):
        process = self.begin("--status", "status.json", "--checkpoint", "sums")
        status = json.loads(self.await_file("status.json", lambda content: json.loads(content)["done"] > 0))
        self.assertEqual((status["what"], status["state"], status["total"]), ("render", "running", 48 * 100000000))
        self.assertAlmostEqual(status["seconds_left"] * status["per_s"], status["total"] - status["done"],
                               delta=1e-6 * status["total"])
        process.send_signal(signal.SIGTERM)
        process.wait(60)
        self.assertEqual(json.loads((self.folder / "status.json").read_text())["state"], "stopped")

        self.run_well("render", "scene.json", "--spp", 3, "--status", "done.json", "--quiet")
        status = json.loads((self.folder / "done.json").read_text())
        self.assertEqual((status["state"], status["done"], status["seconds_left"]), ("done", 144, 0))

    def test_a_server_gets_the_image(self):
        listener = Listener()
        self.run_well("render", "scene.json", "--spp", 30, "--display-server", listener.place, "-o", "image.pfm", "--quiet")
        listener.finish()
        self.assertEqual(listener.created, ("scene", 8, 6, ["R", "G", "B"]))
        width, height, values = self.pixels("image.pfm")  # bottom row first
        rows = [values[3 * width * y:3 * width * (y + 1)] for y in reversed(range(height))]
        for k, channel in enumerate("RGB"):
            self.assertEqual(listener.planes[channel], [value for row in rows for value in row[k::3]])
        self.assertEqual(listener.updates % 3, 0)

    def test_a_part_of_the_image_is_shown_as_that(self):
        listener = Listener()
        self.run_well("render", "scene.json", "--spp", 2, "--crop", "2,1,5,3", "--display-server", listener.place, "--quiet")
        listener.finish()
        self.assertEqual(listener.created[1:3], (3, 2))

    def test_a_server_that_goes_away_ends_no_render(self):
        server = socket.create_server(("localhost", 0))
        process = self.begin("--display-server", f"localhost:{server.getsockname()[1]}", "--preview", "preview.pfm")
        server.accept()[0].close()
        server.close()
        time.sleep(5)
        self.assertIsNone(process.poll())
        process.kill()
        self.assertRegex(process.stderr.read(), r"\Araypool: --display-server: [^\n]+; the render goes on without it\n\Z")

    def test_what_cannot_be_is_refused(self):
        with socket.create_server(("localhost", 0)) as server:
            closed = f"localhost:{server.getsockname()[1]}"
        for place in ("localhost", ":14158", "localhost:", closed, "no such host:1"):
            self.assert_refused("render", "scene.json", "--display-server", place, named=["--display-server", place])
        self.assert_refused("render", "scene.json", "--preview", "image.jpg", named="image.jpg")
        self.assert_refused("render", "scene.json", "--preview", "no/image.png", named="no/image.png")
        self.assert_refused("render", "scene.json", "--status", "no/status.json", named="no/status.json")
        self.assert_refused("render", "scene.json", "--preview", "a.png", "-o", "a.png", named=["--preview", "--output"])


if __name__ == "__main__":
    main()
