"""What a terminal sees of a render's progress: as wide as it is, and nothing that it does not know."""

import fcntl
import os
import pty
import re
import struct
import subprocess
import termios

from command import CommandTest, main


class Terminal(CommandTest):
    def shown(self, columns=None, resized_to=None, **variables):
        """What a render writes to a terminal of so many columns."""
        terminal, other_end = pty.openpty()

        def resize(to):
            fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, to, 0, 0))

        if columns is not None:
            resize(columns)
        environment = {key: value for key, value in os.environ.items() if key not in ("TERM", "NO_COLOR", "COLUMNS")}
        process = subprocess.Popen([self.command, "render", "paper", "--width", "120", "--spp", "1000000", "--threads", "1"],
                                   cwd=self.folder, stdout=subprocess.DEVNULL, stderr=other_end,
                                   env={**environment, **variables})
        os.close(other_end)
        shown = b""
        try:
            while shown.count(b"\r") < 3 and (block := os.read(terminal, 4096)):
                shown += block
            if resized_to is not None:
                resize(resized_to)
                before = len(shown)
                while shown.count(b"\r", before) < 3 and (block := os.read(terminal, 4096)):
                    shown += block
        finally:
            process.kill()
            process.wait()
            os.close(terminal)
        return shown.decode()

    def lines(self, shown):
        return [line for line in re.split(r"\r|\x1b\[K", shown)[1:-1] if line]

    def test_has_no_line_that_it_would_wrap(self):
        for columns in (1, 3, 5, 6, 10, 20, 30, 39, 40, 41, 60, 80, 300):
            with self.subTest(columns=columns):
                for line in self.lines(self.shown(columns, TERM="xterm")):
                    self.assertLess(len(line), columns)

    def test_has_a_bar_where_there_is_room(self):
        self.assertRegex(self.shown(80, TERM="xterm"), r"\r\[=* {10,}\] +\d+ %  \d+\.\d\d M paths/s  [-0-9:]+ left\x1b\[K")
        self.assertRegex(self.shown(24, TERM="xterm"), r"\r +\d+ %  [-0-9:]+ left\x1b\[K")
        self.assertRegex(self.shown(TERM="xterm"), r"\r\[=* {10,}\] +\d+ % ")  # one that does not know its size

    def test_may_change_its_size(self):
        shown = self.shown(100, resized_to=20, TERM="xterm")
        self.assertLess(len(self.lines(shown)[-1]), 20)

    def test_shows_no_colour(self):
        for variables in ({}, {"NO_COLOR": "1"}):
            self.assertEqual(set(re.findall(r"\x1b\[[0-9;]*[A-Za-z]", self.shown(80, TERM="xterm", **variables))), {"\x1b[K"})


class DumbTerminal(CommandTest):
    def test_sees_nothing(self):
        environment = {key: value for key, value in os.environ.items() if key != "TERM"}
        for variables in ({"TERM": "dumb"}, {"TERM": ""}, {}):
            terminal, other_end = pty.openpty()
            subprocess.run([self.command, "render", "paper", "--width", "100", "--spp", "40", "--threads", "1"],
                           cwd=self.folder, stdout=subprocess.DEVNULL, stderr=other_end, env={**environment, **variables},
                           check=True, timeout=60)
            os.close(other_end)
            try:
                shown = os.read(terminal, 4096)
            except OSError:  # how Linux tells that the other end is closed
                shown = b""
            os.close(terminal)
            self.assertEqual(shown, b"", variables)


if __name__ == "__main__":
    main()
