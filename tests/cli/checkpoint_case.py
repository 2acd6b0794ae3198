"""Renders that tests interrupt, and the table of what faults came to, which is printed behind a case's last test."""

import subprocess
import time

from command import CommandTest


def render(**changes):
    """The arguments of the render that tests interrupt, some of them changed."""
    options = {"width": 120, "spp": 300, "threads": 2, **changes}
    return ("render", "paper", *(text for name, value in options.items() for text in ("--" + name, str(value))))


RENDER = render()


def small(**changes):
    return render(width=40, **changes)


SMALL = small()


class CheckpointCase(CommandTest):
    table = []

    def whole(self):
        return self.hash_of(self.run_well(*RENDER))

    def hash_of(self, result):
        return result.stdout.split("hash ")[1].split()[0]

    def start(self, *arguments, **keywords):
        process = subprocess.Popen([self.command, *arguments, "--every", "0"], cwd=self.folder, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True, **keywords)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def wait_for(self, name, process):
        """Until the file is there, which the process must outlive."""
        while not (self.folder / name).exists():
            self.assertIsNone(process.poll(), "ended before its first checkpoint")
            time.sleep(0.005)

    def note(self, fault, tries, lost, wrong):
        self.table.append((fault, tries, lost, wrong))
        self.assertEqual((lost, wrong), (0, 0), fault)

    @classmethod
    def tearDownClass(cls):
        for fault, tries, lost, wrong in cls.table:
            print(f"| {fault} | {tries} | {lost} | {wrong} |")
        super().tearDownClass()
