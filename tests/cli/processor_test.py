"""What the command says on a processor that lacks what it was compiled for: an old one, as qemu makes it."""
import re
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
        def on(processor):
            result = subprocess.run(["qemu-x86_64", "-cpu", processor, self.command, "scenes"], capture_output=True, text=True)
            result.stderr = re.sub("^qemu-x86_64: warning: .*\n", "", result.stderr, flags=re.MULTILINE)
            return result

        for processor, lacks in (("Nehalem", "avx"), ("Haswell,-avx2", "avx2"), ("Haswell,-fma", "fma")):
            result = on(processor)
            self.assert_one_line(result, 2, f"this processor lacks {lacks}: ", "AVX2 and FMA")
            self.assertEqual(result.stdout, "")
        info = self.run_well("info", "one_sphere").stdout
        if "avx512f" in info:  # what the command is compiled for
            self.assert_one_line(on("Haswell"), 2, "this processor lacks avx512f,", "--preset portable")


if __name__ == "__main__":
    main()
