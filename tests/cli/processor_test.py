"""What the command says on a processor that lacks what it was compiled for: an old one, as qemu makes it."""
import shutil
import subprocess
import unittest

from command import CommandTest, main


class OldProcessor(CommandTest):
    def test_is_told_what_it_lacks(self):
        if shutil.which("qemu-x86_64") is None:
            raise unittest.SkipTest("no qemu-x86_64 here")
        with open(self.command, "rb") as binary:
            if b"__asan_init" in (content := binary.read()) or b"__tsan_init" in content:
                raise unittest.SkipTest("a sanitizer does not start in qemu")
        result = subprocess.run(["qemu-x86_64", "-cpu", "Nehalem", self.command, "scenes"], capture_output=True, text=True)
        self.assert_one_line(result, 2, "this processor lacks avx,", "--preset portable")
        self.assertEqual(result.stdout, "")


if __name__ == "__main__":
    main()
