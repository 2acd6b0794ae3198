"""Disks that are full or read-only, and memory that is not there: an error in one line, and what was there stays."""

import contextlib
import os
import resource
import subprocess

from checkpoint_case import RENDER, SMALL, CheckpointCase, render
from command import main


def mounted(what, where, *options):
    """Whether it could be; only root may."""
    return subprocess.run(["mount", *options, what, where], stderr=subprocess.DEVNULL, check=False).returncode == 0


class OutputFaultsTest(CheckpointCase):
    def test_output_that_fails_costs_no_other(self):
        disk = self.folder / "disk"
        disk.mkdir()
        if not mounted("tmpfs", disk, "-t", "tmpfs", "-o", "size=4k"):
            self.skipTest("only root may mount a small disk")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        for lost in ("--checkpoint", "-o", "--stats", "--trace"):
            files = {"--checkpoint": "c.sums", "-o": "a.pfm", "--stats": "s.json", "--trace": "t.json"}
            result = self.run_command(*SMALL, *(text for option, file in files.items() for text in (
                option, f"disk/{file}" if option == lost else file)), "--every", 1000, "--engine", "recursive", "--grain",
                                      "line")
            if lost == "--stats":  # a small file
                self.assertEqual(result.returncode, 0)
                files[lost] = "disk/s.json"
            else:
                self.assert_one_line(result, 2, f"disk/{files.pop(lost)}", "No space left")
            for file in files.values():
                (self.folder / file).unlink()

    def test_full_disk_is_an_error_and_leaves_the_last_checkpoint(self):
        expected = self.whole()
        self.run_well(*RENDER, "--samples", "0:10", "--checkpoint", "c.sums")
        before = (self.folder / "c.sums").read_bytes()
        limit = (len(before) // 2, len(before) // 2)
        result = self.run_command(*RENDER, "--checkpoint", "c.sums", "--resume", "--every", 0,
                                  preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, limit))
        self.assert_one_line(result, 2, "c.sums", "cannot write")
        wrong = (self.folder / "c.sums").read_bytes() != before
        lost = self.hash_of(self.run_well(*RENDER, "--checkpoint", "c.sums", "--resume")) != expected
        self.note("no room for the file (RLIMIT_FSIZE)", 1, int(lost), int(wrong))
        self.assertEqual(set(self.listing()), {"c.sums", "scene.json"})

    def assert_disk_is_refused(self, fault, folder, finish, *cause):
        """Images, figures and checkpoints into the folder are refused; what was there stays, and the render can go on."""
        expected = self.hash_of(self.run_well(*SMALL))
        before = {path.name: path.read_bytes() for path in folder.iterdir()}
        new = [("-o", folder / f"new.{kind}") for kind in ("png", "exr", "pfm")]
        new += [("--stats", folder / "new.json"), ("--trace", folder / "trace.json"), ("--checkpoint", folder / "new.sums")]
        old = [("-o", folder / "old.png"), ("--checkpoint", folder / "c.sums", "--resume", "--every", 0)]
        tries = lost = wrong = 0
        for options in (*new, *old):
            result = self.run_command(*SMALL, *options)
            self.assert_one_line(result, 2, str(options[1]), *cause)
            tries += 1
            wrong += {path.name: path.read_bytes() for path in folder.iterdir()} != before
        finish()
        result = self.run_command(*SMALL, "--checkpoint", folder / "c.sums", "--resume")
        lost += result.returncode != 0 or self.hash_of(result) != expected
        self.note(fault, tries, lost, wrong)

    def keep_old_files(self, disk):
        self.run_well(*SMALL, "--samples", "0:10", "--checkpoint", disk / "c.sums")
        (disk / "old.png").write_bytes(b"old")

    def test_full_disk_of_its_own_is_an_error_and_leaves_what_was_there(self):
        disk = self.folder / "disk"
        disk.mkdir()
        if not mounted("tmpfs", disk, "-t", "tmpfs", "-o", "size=512k"):
            self.skipTest("only root may mount a small disk")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        self.keep_old_files(disk)
        with open(disk / "filler", "wb", buffering=0) as filler, contextlib.suppress(OSError):
            while filler.write(bytes(512)):
                pass
        self.assert_disk_is_refused("no room on the disk (a small tmpfs)", disk, (disk / "filler").unlink,
                                    "No space left")

    def test_read_only_folder_is_an_error_before_anything_is_rendered(self):
        """Rights do not bind root: a disk that is mounted for reading does."""
        disk = self.folder / "disk"
        disk.mkdir()
        self.keep_old_files(disk)
        if os.geteuid() != 0:
            files = (disk / "c.sums", disk / "old.png")
            for file in files:
                file.chmod(0o444)
            disk.chmod(0o555)
            finish = lambda: [path.chmod(0o755) for path in (disk, *files)]
            self.addCleanup(finish)
        elif mounted(disk, disk, "--bind") and mounted("none", disk, "-o", "remount,bind,ro"):
            finish = lambda: subprocess.run(["mount", "-o", "remount,bind,rw", disk], check=True)
            self.addCleanup(subprocess.run, ["umount", disk], check=True)
        else:
            self.skipTest("may not mount")
        self.assert_disk_is_refused("a folder that is read-only", disk, finish)

    def test_output_to_a_full_device_is_an_error(self):
        self.assert_one_line(self.run_command(*render(spp=1), "-o", "/dev/full"), 2, "/dev/full")
        self.assert_one_line(self.run_command(*render(spp=1), "--checkpoint", "/dev/full"), 2, "/dev/full")

    def test_memory_that_is_not_there_is_an_error(self):
        result = self.run_command("render", "paper", "--width", 20000, "--spp", 1, "--threads", 1,
                                  preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30)))
        self.assert_one_line(result, 2, "memory")


if __name__ == "__main__":
    main()
